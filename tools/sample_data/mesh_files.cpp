#include "mesh_files.hpp"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <Eigen/Geometry>
#include <assimp/Importer.hpp>
#include <bit>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <stdexcept>

static_assert(std::endian::native == std::endian::little, "mesh files are written as they lie");

namespace binpick::simulation {
namespace {

std::ofstream open_for_writing(const std::string& path) {
  std::ofstream out(path, std::ios::binary);
  if (!out) throw std::runtime_error("cannot write " + path);
  return out;
}

template <typename T>
void put(std::ofstream& out, const T& value) {
  std::array<char, sizeof(T)> bytes{};
  std::memcpy(bytes.data(), &value, sizeof(T));
  out.write(bytes.data(), bytes.size());
}

void put_point(std::ofstream& out, const Eigen::Vector3d& p) {
  for (int k = 0; k < 3; ++k) put(out, static_cast<float>(p[k]));
}

}  // namespace

TriangleMesh read_mesh(const std::string& path) {
  Assimp::Importer importer;
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE,
                              aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const aiScene* scene = importer.ReadFile(
      path, aiProcess_Triangulate | aiProcess_SortByPType | aiProcess_PreTransformVertices);
  if (scene == nullptr) {
    throw std::runtime_error("cannot read " + path + ": " + importer.GetErrorString());
  }
  TriangleMesh mesh;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    const aiMesh& part = *scene->mMeshes[m];
    const int first = static_cast<int>(mesh.vertices.size());
    for (unsigned v = 0; v < part.mNumVertices; ++v) {
      mesh.vertices.emplace_back(part.mVertices[v].x, part.mVertices[v].y, part.mVertices[v].z);
    }
    for (unsigned f = 0; f < part.mNumFaces; ++f) {
      if (part.mFaces[f].mNumIndices != 3) continue;
      const unsigned* i = part.mFaces[f].mIndices;
      mesh.add_triangle(first + static_cast<int>(i[0]), first + static_cast<int>(i[1]),
                        first + static_cast<int>(i[2]));
    }
  }
  if (mesh.triangles.empty()) throw std::runtime_error(path + " holds no triangles");
  return welded(mesh);
}

void write_ply(const TriangleMesh& mesh, const std::string& path) {
  std::ofstream out = open_for_writing(path);
  out << "ply\nformat binary_little_endian 1.0\ncomment millimetres\nelement vertex "
      << mesh.vertices.size() << "\nproperty float x\nproperty float y\nproperty float z\n"
      << "element face " << mesh.triangles.size()
      << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const auto& v : mesh.vertices) put_point(out, v);
  for (const auto& t : mesh.triangles) {
    put(out, std::uint8_t{3});
    for (int index : t) put(out, static_cast<std::int32_t>(index));
  }
}

void write_stl(const TriangleMesh& mesh, const std::string& path) {
  std::ofstream out = open_for_writing(path);
  std::array<char, 80> header{};
  std::strncpy(header.data(), "binary STL, millimetres", header.size() - 1);
  out.write(header.data(), header.size());
  put(out, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d& a = mesh.vertices[t[0]];
    put_point(out, (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a).normalized());
    for (int index : t) put_point(out, mesh.vertices[index]);
    put(out, std::uint16_t{0});
  }
}

}  // namespace binpick::simulation
