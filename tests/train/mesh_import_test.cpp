// Files are written here, good and bad, and imported.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "binpick/train/errors.hpp"
#include "binpick/train/mesh.hpp"
#include "train/out_of_memory.hpp"
#include "train/tetrahedron.hpp"

namespace binpick::train {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class MeshImport : public testing::Test {
 protected:
  MeshImport() {
    std::string name = (std::filesystem::temp_directory_path() / "mesh_import_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary directory");
    folder_ = name;
  }
  ~MeshImport() override { std::filesystem::remove_all(folder_); }

  std::string file(const std::string& name, const std::string& content) {
    const std::string path = (folder_ / name).string();
    std::ofstream(path, std::ios::binary) << content;
    return path;
  }

  // The error of an import, which names the file; empty when there was none.
  std::string fault(const std::string& path, LengthUnit unit = LengthUnit::kMillimetre) {
    try {
      import_mesh(path, unit);
    } catch (const ImportError& error) {
      EXPECT_THAT(error.what(), HasSubstr(path));
      EXPECT_THAT(error.what(), testing::Not(HasSubstr("\n")));
      return error.what();
    }
    return "";
  }

  std::filesystem::path folder_;
};

std::string ply(const std::string& vertices, int vertices_count, const std::string& faces,
                int faces_count) {
  return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(vertices_count) +
         "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
         std::to_string(faces_count) + "\nproperty list uchar int vertex_indices\nend_header\n" +
         vertices + faces;
}

const std::string kPlyCorners = "0 0 0\n30 0 0\n0 40 0\n0 0 10\n";
const std::string kPlyFaces = "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

std::string tetrahedron_ply(double scale = 1) {
  std::string vertices;
  for (const Eigen::Vector3f& x : kCorners) {
    for (int i = 0; i < 3; ++i) vertices += std::to_string(scale * x[i]) + " ";
    vertices += "\n";
  }
  return ply(vertices, 4, kPlyFaces, 4);
}

std::string ascii_stl() {
  std::string text = "solid part\n";
  for (const auto& face : kFaces) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const auto i : face) {
      const Eigen::Vector3f& x = kCorners[i];
      text += "vertex " + std::to_string(x.x()) + " " + std::to_string(x.y()) + " " +
              std::to_string(x.z()) + "\n";
    }
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid part\n";
}

std::string binary_stl() {
  std::string bytes(80, ' ');
  const auto put = [&](const auto& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  put(std::uint32_t{4});
  for (const auto& face : kFaces) {
    put(Eigen::Vector3f(0, 0, 0));
    for (const auto i : face) put(kCorners[i]);
    put(std::uint16_t{0});
  }
  return bytes;
}

// A binary file may begin like a text.
std::string binary_stl_of_a_solid() {
  std::string bytes = binary_stl();
  return bytes.replace(0, 6, "solid ");
}

// Nested nodes, deeper than the stack of the reader: assimp crashes on it.
std::string bottomless_gltf() {
  const int depth = 200'000;
  std::string text = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[)";
  for (int i = 1; i <= depth; ++i) text += "{\"children\":[" + std::to_string(i) + "]},";
  return text + "{}]}";
}

void expect_tetrahedron(const Mesh& mesh, double scale = 1) {
  ASSERT_EQ(mesh.vertices_mm.size(), 4u);
  ASSERT_EQ(mesh.triangles.size(), 4u);
  for (const Eigen::Vector3f& corner : kCorners) {
    int found_count = 0;
    for (const Eigen::Vector3f& x : mesh.vertices_mm) {
      found_count += (x.cast<double>() - scale * corner.cast<double>()).norm() < 1e-4 * scale;
    }
    EXPECT_EQ(found_count, 1);
  }
}

TEST_F(MeshImport, ReadsTheUsualFormats) {
  const std::string obj =
      "v 0 0 0\nv 30 0 0\nv 0 40 0\nv 0 0 10\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  const std::string paths[] = {file("a.stl", ascii_stl()),
                               file("b.stl", binary_stl()),
                               file("b2.stl", binary_stl_of_a_solid()),
                               file("c.ply", tetrahedron_ply()),
                               file("d.obj", obj),
                               file("E.OFF", "OFF\n4 4 0\n" + kPlyCorners + kPlyFaces)};
  for (const std::string& path : paths) {
    SCOPED_TRACE(path);
    const ImportedMesh imported = import_mesh(path, LengthUnit::kMillimetre);
    expect_tetrahedron(imported.mesh);
    EXPECT_EQ(imported.unit, LengthUnit::kMillimetre);
    EXPECT_THAT(imported.notes, IsEmpty());
  }
}

TEST_F(MeshImport, SplitsPolygonsIntoTriangles) {
  const std::string path =
      file("a.ply", ply("0 0 0\n10 0 0\n10 8 0\n0 8 0\n", 4, "4 0 1 2 3\n", 1));
  const ImportedMesh imported = import_mesh(path, LengthUnit::kMillimetre);
  EXPECT_EQ(imported.mesh.vertices_mm.size(), 4u);
  EXPECT_EQ(imported.mesh.triangles.size(), 2u);
}

TEST_F(MeshImport, PlacesAndMergesTheNodesOfAScene) {
  // One triangle in two nodes; the second one below a node that shifts, itself mirrored and
  // doubled.
  const float corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  std::string bytes(sizeof corners, ' ');
  std::memcpy(bytes.data(), corners, sizeof corners);
  file("a.bin", bytes);
  const std::string path = file("a.gltf", R"({"asset":{"version":"2.0"},"scene":0,
    "scenes":[{"nodes":[0,1]}],
    "nodes":[{"mesh":0},{"children":[2],"translation":[0,0,3]},{"mesh":0,"scale":[-2,2,2]}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3",
                  "min":[0,0,0],"max":[1,1,0]}],
    "bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"uri":"a.bin","byteLength":36}]})");
  const ImportedMesh imported = import_mesh(path, LengthUnit::kMillimetre);
  ASSERT_EQ(imported.mesh.triangles.size(), 2u);
  const MeshBounds bounds = mesh_bounds(imported.mesh);
  EXPECT_LT((bounds.min_mm - Vec3(-2, -3, 0)).norm(), 1e-5);  // the file's y is up, so z here
  EXPECT_LT((bounds.max_mm - Vec3(1, 0, 2)).norm(), 1e-5);
  for (const auto& t : imported.mesh.triangles) {  // mirrored, yet still counter-clockwise from -y
    const auto& v = imported.mesh.vertices_mm;
    EXPECT_LT((v[t[1]] - v[t[0]]).cross(v[t[2]] - v[t[0]]).y(), 0);
  }
}

TEST_F(MeshImport, ConvertsUnits) {
  const std::string path = file("a.ply", tetrahedron_ply());
  expect_tetrahedron(import_mesh(path, LengthUnit::kInch).mesh, 25.4);
  EXPECT_EQ(import_mesh(path, LengthUnit::kInch).unit, LengthUnit::kInch);
  const std::string small = file("b.ply", tetrahedron_ply(0.001));
  const ImportedMesh metres = import_mesh(small, LengthUnit::kMetre);
  expect_tetrahedron(metres.mesh);
  EXPECT_EQ(metres.unit, LengthUnit::kMetre);
}

TEST_F(MeshImport, GuessesTheUnitFromTheExtentAndSaysSo) {
  const ImportedMesh large = import_mesh(file("a.ply", tetrahedron_ply()), LengthUnit::kOfFile);
  EXPECT_EQ(large.unit, LengthUnit::kMillimetre);
  EXPECT_THAT(large.notes, ElementsAre(HasSubstr("Unit not given; guessed millimetres")));
  expect_tetrahedron(large.mesh);
  const ImportedMesh small =
      import_mesh(file("b.ply", tetrahedron_ply(0.001)), LengthUnit::kOfFile);
  EXPECT_EQ(small.unit, LengthUnit::kMetre);
  EXPECT_THAT(small.notes, ElementsAre(HasSubstr("Unit not given; guessed metres")));
  expect_tetrahedron(small.mesh);
}

TEST_F(MeshImport, HashesTheBytesOfTheFile) {
  // FNV-1a 64 of these bytes, computed elsewhere.
  const std::string path = file("a.obj", "v 0 0 0\nv 10 0 0\nv 0 10 0\nf 1 2 3\n");
  EXPECT_EQ(import_mesh(path, LengthUnit::kMillimetre).source_hash, 0x5cf6f0b6f29e9d07u);
}

TEST_F(MeshImport, RefusesWhatIsNoReadableFile) {
  EXPECT_THAT(fault((folder_ / "absent.stl").string()), HasSubstr("No such file"));
  EXPECT_THAT(fault(folder_.string()), HasSubstr("not a file"));
  EXPECT_THAT(fault(file("a.stl", "")), HasSubstr("empty"));
  EXPECT_NE(fault(file("a.txt", "hello")), "");
  EXPECT_NE(fault(file("b.stl", "hello")), "");
  EXPECT_NE(fault(file("c.ply", "ply\n")), "");
  EXPECT_NE(fault(file("d.gltf", "{}")), "");
  EXPECT_THAT(fault(file("e.SLDPRT", "a part")), HasSubstr("export the part as STEP"));
  const std::string huge = file("f.stl", "x");
  std::filesystem::resize_file(huge, (std::uintmax_t{512} << 20) + 1);
  EXPECT_THAT(fault(huge), HasSubstr("larger than 512 MiB"));
}

TEST_F(MeshImport, RefusesFilesCutShort) {
  const std::string stl = binary_stl(), text = ascii_stl(), points = tetrahedron_ply();
  EXPECT_NE(fault(file("a.stl", stl.substr(0, stl.size() - 60))), "");
  EXPECT_THAT(fault(file("b.stl", text.substr(0, text.size() / 2))), HasSubstr("endsolid"));
  EXPECT_NE(fault(file("c.ply", points.substr(0, points.size() - kPlyFaces.size() - 20))), "");
}

TEST_F(MeshImport, RefusesFilesWithoutTriangles) {
  EXPECT_THAT(fault(file("a.stl", "solid a\nendsolid a\n")), HasSubstr("no triangles"));
  EXPECT_THAT(fault(file("b.ply", ply("0 0 0\n5 0 0\n9 0 0\n", 3, "3 0 1 2\n", 1))),
              HasSubstr("zero extent"));
}

TEST_F(MeshImport, RefusesVerticesThatAreNotNumbers) {
  for (const char* bad : {"nan", "inf", "-inf"}) {
    const std::string corners = "0 0 0\n30 0 0\n0 40 0\n0 0 " + std::string(bad) + "\n";
    EXPECT_THAT(fault(file("a.ply", ply(corners, 4, kPlyFaces, 4))),
                HasSubstr("vertex 3 is not a finite number"));
  }
}

TEST_F(MeshImport, RefusesIndicesOutOfRange) {
  const std::string faces = "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 9\n";
  EXPECT_THAT(fault(file("a.ply", ply(kPlyCorners, 4, faces, 4))), HasSubstr("vertex 9 of 4"));
  EXPECT_THAT(fault(file("b.off", "OFF\n4 4 0\n" + kPlyCorners + faces)),
              HasSubstr("out of range"));
  EXPECT_THAT(fault(file("c.obj", "v 0 0 0\nv 9 0 0\nv 0 9 0\nf 1 2 9\n")),
              HasSubstr("out of range"));
  EXPECT_NE(fault(file("d.ply", ply(kPlyCorners, 4, "3 0 1 -1\n", 1))), "");
  EXPECT_NE(fault(file("e.ply", ply(kPlyCorners, 4, "5 0 1 2 3 100000000\n", 1))), "");
}

TEST_F(MeshImport, RefusesExtentsThatNoPartHas) {
  EXPECT_THAT(fault(file("a.ply", tetrahedron_ply(0.01))), HasSubstr("is the unit right?"));
  EXPECT_THAT(fault(file("b.ply", tetrahedron_ply(200))), HasSubstr("is the unit right?"));
  const std::string path = file("c.ply", tetrahedron_ply());
  EXPECT_THAT(fault(path, LengthUnit::kMetre), HasSubstr("4e+04 mm"));
  EXPECT_EQ(fault(path, LengthUnit::kInch), "");
}

TEST_F(MeshImport, SurvivesFilesThatClaimMoreThanThereIs) {
  for (const char* claim : {"4000000000", "400000000"}) {
    std::string bytes = tetrahedron_ply();
    bytes.replace(bytes.find("vertex 4"), 8, std::string("vertex ") + claim);
    EXPECT_THAT(fault(file("a.ply", bytes)), HasSubstr("cut short"));
  }
  EXPECT_THAT(fault(file("b.off", "OFF\n400000000 4 0\n" + kPlyCorners + kPlyFaces)),
              HasSubstr(kOutOfMemory));
}

TEST_F(MeshImport, TurnsACrashOfAssimpIntoAnError) {
  EXPECT_THAT(fault(file("a.gltf", bottomless_gltf())), HasSubstr("crashed"));
}

}  // namespace
}  // namespace binpick::train
