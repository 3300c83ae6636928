#include "cad/tessellation.hpp"

#include <BRepAdaptor_Surface.hxx>
#include <BRepBndLib.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <Poly_Triangulation.hxx>
#include <Precision.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "cad/cad_error.hpp"

namespace binpick::cad {
namespace {

constexpr double kDeflectionMin_mm = 0.05, kDeflectionShare = 1.0 / 2000;
// Small radii have corners enough for the directions of their normals: 32 in a full circle.
constexpr double kAngle_rad = 0.2;
constexpr double kCoarseShare = 1.0 / 200;
constexpr int kRefinementsMax = 5;
constexpr double kRefinement = 0.8;

// At a pole of a sphere or the tip of a cone corners coincide.
bool has_three_corners(const std::array<std::int32_t, 3>& t, const Triangles& mesh) {
  const auto corner = [&](int i) {
    const auto& x = mesh.vertices_mm[static_cast<std::size_t>(t[static_cast<std::size_t>(i)])];
    return gp_Pnt(x[0], x[1], x[2]);
  };
  const double same_mm = Precision::Confusion();
  return corner(0).Distance(corner(1)) > same_mm && corner(1).Distance(corner(2)) > same_mm &&
         corner(2).Distance(corner(0)) > same_mm;
}

void append(const TopoDS_Face& face, Triangles& out) {
  TopLoc_Location place;
  const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(face, place);
  if (mesh.IsNull()) {
    ++out.missing_faces;
    return;
  }
  const auto first = static_cast<std::int32_t>(out.vertices_mm.size()) - 1;  // nodes count from 1
  for (int i = 1; i <= mesh->NbNodes(); ++i) {
    const gp_Pnt x = mesh->Node(i).Transformed(place);
    out.vertices_mm.push_back({x.X(), x.Y(), x.Z()});
  }
  const bool reversed =
      (face.Orientation() == TopAbs_REVERSED) != place.Transformation().IsNegative();
  for (int i = 1; i <= mesh->NbTriangles(); ++i) {
    std::array<std::int32_t, 3> t{};
    mesh->Triangle(i).Get(t[0], t[1], t[2]);
    if (reversed) std::swap(t[1], t[2]);
    for (std::int32_t& corner : t) corner += first;
    if (has_three_corners(t, out)) out.corners.push_back(t);
  }
}

Triangles triangles_of(const TopoDS_Shape& shape, double deflection_mm) {
  BRepTools::Clean(shape);
  const BRepMesh_IncrementalMesh mesh(shape, deflection_mm, false, kAngle_rad);
  Triangles out;
  for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next()) {
    append(TopoDS::Face(face.Current()), out);
  }
  return out;
}

// How far the surface is from the planes of a face's triangles, in the middles of them and of their
// sides: OpenCASCADE takes the deflection that it is given for a hint.
double deviation_mm(const TopoDS_Face& face) {
  TopLoc_Location place;
  const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(face, place);
  if (mesh.IsNull() || !mesh->HasUVNodes()) return 0;
  const BRepAdaptor_Surface surface(face, false);
  if (surface.GetType() == GeomAbs_Plane) return 0;
  double largest_mm = 0;
  for (int i = 1; i <= mesh->NbTriangles(); ++i) {
    int a = 0, b = 0, c = 0;
    mesh->Triangle(i).Get(a, b, c);
    const gp_XYZ corner = mesh->Node(a).Transformed(place).XYZ();
    gp_XYZ normal = (mesh->Node(b).Transformed(place).XYZ() - corner) ^
                    (mesh->Node(c).Transformed(place).XYZ() - corner);
    if (normal.Modulus() < gp::Resolution()) continue;
    normal.Normalize();
    const gp_XY ua = mesh->UVNode(a).XY(), ub = mesh->UVNode(b).XY(), uc = mesh->UVNode(c).XY();
    for (const gp_XY& uv : {(ua + ub + uc) / 3, (ua + ub) / 2, (ub + uc) / 2, (uc + ua) / 2}) {
      const gp_XYZ x = surface.Value(uv.X(), uv.Y()).XYZ();
      largest_mm = std::max(largest_mm, std::abs((x - corner) * normal));
    }
  }
  return largest_mm;
}

double largest_deviation_mm(const TopoDS_Shape& shape) {
  double largest_mm = 0;
  for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next()) {
    largest_mm = std::max(largest_mm, deviation_mm(TopoDS::Face(face.Current())));
  }
  return largest_mm;
}

// The largest extent along directions that cover a half sphere; within 1 % of the diameter.
double diameter_mm(const Triangles& mesh) {
  constexpr int kDirections = 300;
  double diameter = 0;
  for (int i = 0; i < kDirections; ++i) {
    const double z = (i + 0.5) / kDirections, r = std::sqrt(1 - z * z);
    const double around = 2.399963229728653 * i;  // the golden angle
    const gp_XYZ direction(r * std::cos(around), r * std::sin(around), z);
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const auto& x : mesh.vertices_mm) {
      const double along = direction * gp_XYZ(x[0], x[1], x[2]);
      low = std::min(low, along);
      high = std::max(high, along);
    }
    diameter = std::max(diameter, high - low);
  }
  return diameter;
}

}  // namespace

double default_deflection_mm(const TopoDS_Shape& shape) {
  Bnd_Box box;
  BRepBndLib::Add(shape, box);
  if (box.IsVoid()) return kDeflectionMin_mm;
  const Triangles coarse = triangles_of(shape, std::sqrt(box.SquareExtent()) * kCoarseShare);
  return std::max(kDeflectionMin_mm, kDeflectionShare * diameter_mm(coarse));
}

Triangles tessellate(const TopoDS_Shape& shape, double deflection_mm) {
  Triangles out = triangles_of(shape, deflection_mm);
  if (out.corners.empty()) throw CadError("none of its faces can be tessellated");
  out.deviation_mm = largest_deviation_mm(shape);
  double asked_mm = deflection_mm;
  for (int i = 0; i < kRefinementsMax && out.deviation_mm > deflection_mm; ++i) {
    asked_mm *= kRefinement * deflection_mm / out.deviation_mm;
    out = triangles_of(shape, asked_mm);
    out.deviation_mm = largest_deviation_mm(shape);
  }
  return out;
}

}  // namespace binpick::cad
