// Triangles in place of curved surfaces.
#pragma once

#include <TopoDS_Shape.hxx>
#include <array>
#include <cstdint>
#include <vector>

namespace binpick::cad {

struct Triangles {
  std::vector<std::array<double, 3>> vertices_mm;
  std::vector<std::array<std::int32_t, 3>> corners;  // counter-clockwise, seen from outside
  int missing_faces = 0;                             // that OpenCASCADE could not tessellate
  double deviation_mm = 0;                           // from the surface, as measured
};

// How far the triangles may be from the surface when nobody says: 0.05 mm, or 1/2000 of the
// diameter where that is more.
double default_deflection_mm(const TopoDS_Shape& shape);

// Refines until the deflection is kept, as far as OpenCASCADE can. Throws CadError: nothing could
// be tessellated.
Triangles tessellate(const TopoDS_Shape& shape, double deflection_mm);

}  // namespace binpick::cad
