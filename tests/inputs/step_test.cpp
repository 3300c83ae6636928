// STEP and IGES: files that OpenCASCADE writes from shapes whose size and volume are known exactly,
// read back through binpick-cad as training reads them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <IGESControl_Controller.hxx>
#include <IGESControl_Writer.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <STEPControl_Controller.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <cmath>
#include <fstream>
#include <gp_Ax1.hxx>
#include <gp_Trsf.hxx>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "../temporary_folder.hpp"
#include "binpick/geometry/angle.hpp"
#include "binpick/train/errors.hpp"
#include "binpick/train/mesh.hpp"

namespace binpick::train {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

// A product, and where the assembly puts it each time.
struct Product {
  std::string name;
  TopoDS_Shape shape;
  std::vector<gp_Trsf> places;
};

const TopoDS_Shape& box() {
  static const TopoDS_Shape shape = BRepPrimAPI_MakeBox(gp_Pnt(1, 2, 3), 30, 20, 10).Shape();
  return shape;
}

TopoDS_Shape cylinder(double radius_mm = 10, double height_mm = 30) {
  return BRepPrimAPI_MakeCylinder(radius_mm, height_mm).Shape();
}

TopoDS_Shape sphere(double radius_mm) {
  return BRepPrimAPI_MakeSphere(gp_Pnt(5, 6, 7), radius_mm).Shape();
}

// In OpenCASCADE shapes are in mm, whatever the unit of the file.
void write_document(const Handle(TDocStd_Document) & document, const std::string& path,
                    const std::string& unit) {
  Message::DefaultMessenger()->ChangePrinters().Clear();
  STEPControl_Controller::Init();
  Interface_Static::SetCVal("write.step.unit", unit.c_str());  // before there is a writer
  STEPCAFControl_Writer writer;
  ASSERT_TRUE(writer.Transfer(document));
  ASSERT_EQ(writer.Write(path.c_str()), IFSelect_RetDone);
}

void write_step(const std::string& path, const std::string& unit, const TopoDS_Shape& shape) {
  Handle(TDocStd_Document) document;
  XCAFApp_Application::GetApplication()->NewDocument("BinXCAF", document);
  XCAFDoc_DocumentTool::ShapeTool(document->Main())->AddShape(shape, false);
  write_document(document, path, unit);
}

void write_assembly(const std::string& path, const std::string& unit,
                    const std::vector<Product>& products) {
  Handle(TDocStd_Document) document;
  XCAFApp_Application::GetApplication()->NewDocument("BinXCAF", document);
  const Handle(XCAFDoc_ShapeTool) shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  const TDF_Label assembly = shapes->NewShape();
  TDataStd_Name::Set(assembly, "assembly");
  for (const Product& product : products) {
    const TDF_Label label = shapes->AddShape(product.shape, false);
    TDataStd_Name::Set(label, product.name.c_str());
    for (const gp_Trsf& place : product.places) {
      shapes->AddComponent(assembly, label, TopLoc_Location(place));
    }
  }
  shapes->UpdateAssemblies();
  write_document(document, path, unit);
}

// As solids (mode 1), or as the surfaces about them (mode 0), which most programs write.
void write_iges(const std::string& path, const char* unit, int mode, const TopoDS_Shape& shape) {
  IGESControl_Controller::Init();
  IGESControl_Writer writer(unit, mode);
  ASSERT_TRUE(writer.AddShape(shape));
  writer.ComputeModel();
  ASSERT_TRUE(writer.Write(path.c_str()));
}

double volume_mm3(const Mesh& mesh) {
  double volume = 0;
  for (const auto& t : mesh.triangles) {
    const auto corner = [&](std::size_t i) { return Vec3(mesh.vertices_mm[t[i]].cast<double>()); };
    volume += corner(0).cross(corner(1)).dot(corner(2)) / 6;
  }
  return volume;
}

class Step : public testing::Test {
 protected:
  Step() {
    const char* path = getenv("PATH");
    setenv("PATH", (BINPICK_CAD_FOLDER ":" + std::string(path != nullptr ? path : "")).c_str(), 1);
  }

  ImportedMesh imported(const std::string& name, const SolidChoice& choice = {}) {
    return import_mesh(folder_.file(name), LengthUnit::kOfFile, choice);
  }

  std::string fault(const std::string& name, const SolidChoice& choice = {}) {
    try {
      imported(name, choice);
    } catch (const ImportError& error) {
      EXPECT_THAT(error.what(), HasSubstr(folder_.file(name)));
      return error.what();
    }
    return "";
  }

  void expect_box(const ImportedMesh& part, const Vec3& min_mm, const Vec3& max_mm) {
    const MeshBounds bounds = mesh_bounds(part.mesh);
    EXPECT_LT((bounds.min_mm - min_mm).norm(), 1e-3) << bounds.min_mm.transpose();
    EXPECT_LT((bounds.max_mm - max_mm).norm(), 1e-3) << bounds.max_mm.transpose();
    EXPECT_THAT(part.notes, IsEmpty());  // closed, right side out, no guess
    EXPECT_EQ(part.unit, LengthUnit::kMillimetre);
  }

  TemporaryFolder folder_;
};

TEST_F(Step, ABoxIsExactInEveryUnitAndFormat) {
  write_step(folder_.file("mm.step"), "MM", box());
  write_step(folder_.file("inch.stp"), "INCH", box());
  write_step(folder_.file("metre.STP"), "M", box());
  write_iges(folder_.file("solid.igs"), "IN", 1, box());
  write_iges(folder_.file("surfaces.iges"), "MM", 0, box());
  for (const char* name : {"mm.step", "inch.stp", "metre.STP", "solid.igs", "surfaces.iges"}) {
    SCOPED_TRACE(name);
    const ImportedMesh part = imported(name);
    expect_box(part, {1, 2, 3}, {31, 22, 13});
    EXPECT_EQ(part.mesh.vertices_mm.size(), 8u);
    EXPECT_EQ(part.mesh.triangles.size(), 12u);
    EXPECT_NEAR(volume_mm3(part.mesh), 30 * 20 * 10, 0.1);
  }
}

TEST_F(Step, CurvedSurfacesAreCloserThanTheDeflection) {
  struct {
    const char* name;
    double radius_mm, asked_mm, deflection_mm;
  } cases[] = {{"small.step", 20, 0, 0.05},    // by default
               {"large.step", 200, 0, 0.2},    // 1/2000 of the diameter
               {"fine.step", 20, 0.01, 0.01},  // asked for
               {"coarse.step", 100, 1.5, 1.5}};
  std::size_t triangles_fine = 0, triangles_small = 0;
  for (const auto& c : cases) {
    SCOPED_TRACE(c.name);
    write_step(folder_.file(c.name), "MM", sphere(c.radius_mm));
    const ImportedMesh part = imported(c.name, {"", c.asked_mm});
    EXPECT_THAT(part.notes, IsEmpty());
    const Vec3 centre(5, 6, 7);
    double deepest_mm = 0;
    for (const auto& t : part.mesh.triangles) {
      Vec3 middle = Vec3::Zero();
      for (const auto i : t) {
        const Vec3 x = part.mesh.vertices_mm[i].cast<double>();
        EXPECT_NEAR((x - centre).norm(), c.radius_mm, 1e-3);
        middle += x / 3;
      }
      deepest_mm = std::max(deepest_mm, c.radius_mm - (middle - centre).norm());
    }
    EXPECT_LT(deepest_mm, c.deflection_mm);
    const double whole = 4.0 / 3 * kPi * std::pow(c.radius_mm, 3);
    EXPECT_LT(volume_mm3(part.mesh), whole);
    EXPECT_GT(volume_mm3(part.mesh), whole * (1 - 3 * c.deflection_mm / c.radius_mm));
    if (c.asked_mm == 0.01) triangles_fine = part.mesh.triangles.size();
    if (c.deflection_mm == 0.05) triangles_small = part.mesh.triangles.size();
  }
  EXPECT_GT(triangles_fine, 2 * triangles_small);
}

TEST_F(Step, ACylinderIsClosedAndHasItsVolume) {
  write_step(folder_.file("a.step"), "MM", cylinder());
  write_iges(folder_.file("a.igs"), "MM", 0, cylinder());
  for (const char* name : {"a.step", "a.igs"}) {
    SCOPED_TRACE(name);
    const ImportedMesh part = imported(name);
    EXPECT_THAT(part.notes, IsEmpty());
    EXPECT_NEAR(volume_mm3(part.mesh), kPi * 100 * 30, 0.01 * kPi * 100 * 30);
  }
}

class StepAssembly : public Step {
 protected:
  StepAssembly() {
    gp_Trsf aside, lying;
    aside.SetTranslation(gp_Vec(100, 0, 0));
    lying.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(1, 0, 0)), kPi / 2);
    write_assembly(folder_.file("a.step"), "INCH",
                   {{"plate", box(), {gp_Trsf()}}, {"pin", cylinder(2, 30), {aside, lying}}});
  }
};

TEST_F(StepAssembly, ListsItsBodiesWhenNoneIsChosen) {
  EXPECT_THAT(fault("a.step"), HasSubstr("it has 3 bodies; choose with --body"));
  EXPECT_THAT(fault("a.step"), HasSubstr("1 'plate' (30 x 20 x 10 mm)"));
  EXPECT_THAT(fault("a.step"), HasSubstr("2 'pin' (4 x 4 x 30 mm), 3 'pin' (4 x 30 x 4 mm)"));
  EXPECT_THAT(fault("a.step", {"nut", 0}), HasSubstr("none is 'nut'"));
  EXPECT_THAT(fault("a.step", {"4", 0}), HasSubstr("none is '4'"));
  EXPECT_THAT(fault("a.step", {"0", 0}), HasSubstr("none is '0'"));
}

TEST_F(StepAssembly, GivesABodyByNameOrNumberWhereTheAssemblyHasIt) {
  expect_box(imported("a.step", {"plate", 0}), {1, 2, 3}, {31, 22, 13});
  expect_box(imported("a.step", {"1", 0}), {1, 2, 3}, {31, 22, 13});
  // Of several that are the same the first.
  const MeshBounds pin = mesh_bounds(imported("a.step", {"pin", 0}).mesh);
  EXPECT_NEAR(pin.max_mm.x(), 102, 1e-3);
  EXPECT_NEAR(pin.max_mm.z(), 30, 1e-3);
  const MeshBounds lying = mesh_bounds(imported("a.step", {"3", 0}).mesh);
  EXPECT_NEAR(lying.min_mm.y(), -30, 1e-3);
  EXPECT_NEAR(lying.max_mm.y(), 0, 1e-3);
}

TEST_F(StepAssembly, GivesAllBodiesTogether) {
  const ImportedMesh all = imported("a.step", {"all", 0});
  const double pins = 2 * kPi * 4 * 30;
  EXPECT_NEAR(volume_mm3(all.mesh), 6000 + pins, 0.02 * pins);
  EXPECT_NEAR(mesh_bounds(all.mesh).max_mm.x(), 102, 1e-3);
}

TEST_F(Step, DifferentBodiesOfOneNameAreChosenByNumber) {
  write_assembly(folder_.file("a.step"), "MM",
                 {{"part", box(), {gp_Trsf()}}, {"part", cylinder(), {gp_Trsf()}}});
  EXPECT_THAT(fault("a.step", {"part", 0}), HasSubstr("several different bodies of it are called"));
  expect_box(imported("a.step", {"1", 0}), {1, 2, 3}, {31, 22, 13});
}

TEST_F(Step, DamagedFilesAreRefused) {
  write_step(folder_.file("whole.step"), "MM", cylinder());
  std::ifstream file(folder_.file("whole.step"), std::ios::binary);
  const std::string whole(std::istreambuf_iterator<char>(file), {});
  const std::pair<const char*, std::string> cases[] = {
      {"empty.step", ""},
      {"text.step", "hello"},
      {"text.igs", "hello"},
      {"head.stp", "ISO-10303-21;\n"},
      {"no_data.step", "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\nENDSEC;\nEND-ISO-10303-21;\n"},
      {"half.step", whole.substr(0, whole.size() / 2)},
      {"tail.step", whole.substr(0, whole.size() - 30)},
      {"bytes.step", std::string(5000, '\x80')},
  };
  for (const auto& [name, bytes] : cases) {
    SCOPED_TRACE(name);
    std::ofstream(folder_.file(name), std::ios::binary) << bytes;
    EXPECT_NE(fault(name), "");
  }
}

TEST_F(Step, WithoutBinpickCadThePackageIsNamed) {
  write_step(folder_.file("a.step"), "MM", box());
  setenv("PATH", "/nowhere", 1);
  EXPECT_THAT(fault("a.step"), HasSubstr("install the package binpick-cad"));
}

TEST_F(Step, OtherFormatsHaveNoBodiesToChoose) {
  std::ofstream(folder_.file("a.obj")) << "v 0 0 0\nv 9 0 0\nv 0 9 0\nf 1 2 3\n";
  EXPECT_THAT(fault("a.obj", {"1", 0}), HasSubstr("STEP and IGES files only"));
  EXPECT_THAT(fault("a.obj", {"", 0.1}), HasSubstr("STEP and IGES files only"));
}

}  // namespace
}  // namespace binpick::train
