// One part, a wedge without any symmetry, as CAD programs write it to each format: in the unit and
// with the axis up that a test asks for.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace binpick::train {

using Point = std::array<double, 3>;
using Points = std::vector<Point>;

// In mm, with z up, away from the origin.
inline const Points kPart = {{5, 1, 2}, {40, 1, 2}, {5, 21, 2}, {5, 1, 17}};

// What a program that writes with another axis up makes of z-up coordinates.
Point y_up(const Point& p);
Point x_up(const Point& p);
Point z_up(const Point& p);

Points exported(Point (*turn)(const Point& p), double mm_per_unit);

// COLLADA: <unit> and <up_axis> are in `asset`; a <translate> may stand before the geometry.
std::string dae(const std::string& asset, const Points& points, const std::string& transform = "");
std::string zae(const std::string& collada);

// `transform` is another property of the node, after a comma.
std::string glb(const Points& points, const std::string& transform = "");

struct FbxSettings {
  int up, up_sign, front, front_sign, coord, coord_sign;
  double centimetres;
};
constexpr FbxSettings kFbxYUp{1, 1, 2, 1, 0, 1, 1}, kFbxZUp{2, 1, 1, -1, 0, 1, 0.1};
std::string fbx(const FbxSettings& s, const Points& points, const std::string& transform = "");

// `unit` is the whole attribute, after a blank; so is `item`, of the build's item.
std::string amf(const std::string& unit, const Points& points);
std::string model_of_3mf(const std::string& unit, const Points& points,
                         const std::string& item = "");
std::string zipped_3mf(const std::string& model);

// Formats without a unit.
std::string obj(const Points& points);
std::string file_3ds(const Points& points);
std::string dxf(const Points& points);

}  // namespace binpick::train
