// One part as CAD programs export it, to each format in its units and with its axis up: every file
// comes back to the same coordinates, in mm, with z up.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "../temporary_folder.hpp"
#include "binpick/train/errors.hpp"
#include "binpick/train/mesh.hpp"
#include "cad_files.hpp"

namespace binpick::train {
namespace {

using testing::HasSubstr;
ImportedMesh import_bytes(const std::string& name, const std::string& bytes,
                          LengthUnit unit = LengthUnit::kOfFile) {
  const TemporaryFolder folder;
  std::ofstream(folder.file(name), std::ios::binary) << bytes;
  return import_mesh(folder.file(name), unit);
}

void expect_part(const ImportedMesh& part, double scale = 1, const Point& shift = {0, 0, 0}) {
  ASSERT_EQ(part.mesh.vertices_mm.size(), 4u);
  ASSERT_EQ(part.mesh.triangles.size(), 4u);
  for (const Point& p : kPart) {
    const Vec3 expected = scale * Vec3(p[0], p[1], p[2]) + Vec3(shift[0], shift[1], shift[2]);
    EXPECT_TRUE(std::ranges::any_of(part.mesh.vertices_mm, [&](const Eigen::Vector3f& x) {
      return (x.cast<double>() - expected).norm() < 1e-4 * scale;
    })) << expected.transpose();
  }
  // Outside is outside: inside out, the import would have turned it and said so.
  for (const std::string& note : part.notes) {
    EXPECT_THAT(note, testing::Not(HasSubstr("inside out")));
  }
}

std::string all_notes(const ImportedMesh& part) {
  std::string text;
  for (const std::string& note : part.notes) text += note + "\n";
  return text;
}

struct Case {
  const char* what;
  const char* name;
  std::string bytes;
  LengthUnit unit;
  bool turned = false;  // which is told
};

std::string asset(const char* metres, const char* up) {
  std::string text;
  if (metres != nullptr) text += std::string("<unit name=\"u\" meter=\"") + metres + "\"/>";
  if (up != nullptr) text += std::string("<up_axis>") + up + "</up_axis>";
  return text;
}

TEST(CadUnits, EveryFormatComesBackToTheSameCoordinates) {
  using U = LengthUnit;
  const Case cases[] = {
      {"COLLADA, mm, z up", "a.dae", dae(asset("0.001", "Z_UP"), exported(z_up, 1)),
       U::kMillimetre},
      {"COLLADA, inch, z up", "a.dae", dae(asset("0.0254", "Z_UP"), exported(z_up, 25.4)),
       U::kInch},
      {"COLLADA, cm, y up", "a.dae", dae(asset("0.01", "Y_UP"), exported(y_up, 10)), U::kCentimetre,
       true},
      {"COLLADA, mm, x up", "a.dae", dae(asset("0.001", "X_UP"), exported(x_up, 1)), U::kMillimetre,
       true},
      {"COLLADA, blanks about the axis", "a.dae",
       dae(asset("1", "\n  Z_UP\n  "), exported(z_up, 1000)), U::kMetre},
      {"COLLADA, nothing said: metres, y up", "a.dae", dae("", exported(y_up, 1000)), U::kMetre,
       true},
      {"COLLADA, a unit of its own", "A.DAE", dae(asset("0.0005", "Z_UP"), exported(z_up, 0.5)),
       U::kOther},
      {"COLLADA, packed, inch, z up", "a.zae",
       zae(dae(asset("0.0254", "Z_UP"), exported(z_up, 25.4))), U::kMetre},
      {"glTF: always metres, y up", "a.glb", glb(exported(y_up, 1000)), U::kMetre, true},
      {"FBX, cm, y up", "a.fbx", fbx(kFbxYUp, exported(y_up, 10)), U::kCentimetre, true},
      {"FBX, mm, z up", "a.fbx", fbx(kFbxZUp, exported(z_up, 1)), U::kMillimetre},
      {"3MF, nothing said: mm", "a.3mf", zipped_3mf(model_of_3mf("", exported(z_up, 1))),
       U::kMillimetre},
      {"3MF, inch", "a.3mf", zipped_3mf(model_of_3mf(" unit=\"inch\"", exported(z_up, 25.4))),
       U::kInch},
      {"3MF, cm", "a.3mf", zipped_3mf(model_of_3mf(" unit=\"centimeter\"", exported(z_up, 10))),
       U::kCentimetre},
      {"3MF, micron", "a.3mf", zipped_3mf(model_of_3mf(" unit=\"micron\"", exported(z_up, 0.001))),
       U::kMicrometre},
      {"3MF, foot", "a.3mf", zipped_3mf(model_of_3mf(" unit=\"foot\"", exported(z_up, 304.8))),
       U::kFoot},
      {"AMF, nothing said: mm", "a.amf", amf("", exported(z_up, 1)), U::kMillimetre},
      {"AMF, inch", "a.amf", amf(" unit=\"Inch\"", exported(z_up, 25.4)), U::kInch},
      {"AMF, metres", "a.amf", amf(" unit=\"meter\"", exported(z_up, 1000)), U::kMetre},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.what);
    const ImportedMesh part = import_bytes(c.name, c.bytes);
    expect_part(part);
    EXPECT_EQ(part.unit, c.unit);
    EXPECT_THAT(all_notes(part), testing::Not(HasSubstr("guessed")));
    EXPECT_EQ(all_notes(part).find("turned so that z is") != std::string::npos, c.turned);
  }
}

TEST(CadUnits, OnlyFormatsWithoutAUnitAreGuessed) {
  const struct {
    const char* name;
    std::string (*write)(const Points& points);
  } formats[] = {{"a.obj", obj}, {"a.3ds", file_3ds}, {"a.dxf", dxf}};
  for (const auto& format : formats) {
    SCOPED_TRACE(format.name);
    const ImportedMesh large = import_bytes(format.name, format.write(exported(z_up, 1)));
    expect_part(large);
    EXPECT_EQ(large.unit, LengthUnit::kMillimetre);
    EXPECT_THAT(all_notes(large), HasSubstr("guessed millimetres"));
    const ImportedMesh small = import_bytes(format.name, format.write(exported(z_up, 1000)));
    expect_part(small);
    EXPECT_EQ(small.unit, LengthUnit::kMetre);
    EXPECT_THAT(all_notes(small), HasSubstr("guessed metres"));
  }
}

TEST(CadUnits, TransformsOfNodesAreLengthsOfTheFile) {
  const Point shift = {100, 20, -30};  // in mm, z up
  expect_part(
      import_bytes("a.dae", dae(asset("0.0254", "Z_UP"), exported(z_up, 25.4),
                                "<translate>3.93700787 0.787401575 -1.18110236</translate>")),
      1, shift);
  expect_part(import_bytes("a.dae", dae(asset("0.01", "Y_UP"), exported(y_up, 10),
                                        "<translate>10 -3 -2</translate>")),
              1, shift);
  expect_part(
      import_bytes("a.glb", glb(exported(y_up, 1000), ",\"translation\":[0.1,-0.03,-0.02]")), 1,
      shift);
  expect_part(
      import_bytes("a.fbx",
                   fbx(kFbxZUp, exported(z_up, 1),
                       "P: \"Lcl Translation\", \"Lcl Translation\", \"\", \"A\",100,20,-30\n")),
      1, shift);
  expect_part(
      import_bytes("a.3mf", zipped_3mf(model_of_3mf(" unit=\"centimeter\"", exported(z_up, 10),
                                                    " transform=\"1 0 0 0 1 0 0 0 1 10 2 -3\""))),
      1, shift);
}

TEST(CadUnits, WhoeverGivesAUnitIsObeyedAndTold) {
  const ImportedMesh part = import_bytes("a.dae", dae(asset("0.0254", "Z_UP"), exported(z_up, 1)),
                                         LengthUnit::kMillimetre);
  expect_part(part);
  EXPECT_EQ(part.unit, LengthUnit::kMillimetre);
  EXPECT_THAT(all_notes(part), HasSubstr("its unit is inch (25.4 mm); it is taken as mm"));
  EXPECT_THAT(
      import_bytes("a.dae", dae(asset("0.0254", "Z_UP"), exported(z_up, 25.4)), LengthUnit::kInch)
          .notes,
      testing::IsEmpty());
}

TEST(CadUnits, UnitsAndAxesThatThereAreNot) {
  const struct {
    const char *what, *name;
    std::string bytes;
    const char* fault;
  } cases[] = {
      {"COLLADA, no length", "a.dae", dae(asset("0", "Z_UP"), exported(z_up, 1)), "no length"},
      {"COLLADA, an unknown axis", "a.dae", dae(asset("1", "W_UP"), exported(z_up, 1)), "'W_UP'"},
      {"3MF, an unknown unit", "a.3mf", zipped_3mf(model_of_3mf(" unit=\"ell\"", kPart)), "'ell'"},
      {"FBX, one axis twice", "a.fbx", fbx({0, 1, 2, 1, 0, 1, 1}, kPart), "are the same"},
      {"FBX, no axis", "a.fbx", fbx({7, 1, 2, 1, 0, 1, 1}, kPart), "UpAxis"},
      {"3MF that is no archive", "a.3mf", model_of_3mf("", kPart), "a.3mf"},
  };
  for (const auto& c : cases) {
    SCOPED_TRACE(c.what);
    try {
      import_bytes(c.name, c.bytes);
      ADD_FAILURE() << "was read";
    } catch (const ImportError& error) {
      EXPECT_THAT(error.what(), testing::AllOf(HasSubstr(c.name), HasSubstr(c.fault)));
    }
  }
}

}  // namespace
}  // namespace binpick::train
