#include "cli/symmetry_summary.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "binpick/geometry/angle.hpp"

namespace binpick::app {
namespace {

Vec3 point_in_cad(const ObjectModel& model, const float (&point_mm)[3]) {
  return vector_of(point_mm) + model.centre_mm();
}

std::string line_text(const Vec3& axis, const Vec3& point_mm) {
  char text[120];
  // Adding zero turns a negative zero into the other one.
  std::snprintf(
      text, sizeof text, "(%.3g %.3g %.3g) through (%.2f %.2f %.2f) mm",
      std::round(axis.x() * 1000) / 1000 + 0.0, std::round(axis.y() * 1000) / 1000 + 0.0,
      std::round(axis.z() * 1000) / 1000 + 0.0, std::round(point_mm.x() * 100) / 100 + 0.0,
      std::round(point_mm.y() * 100) / 100 + 0.0, std::round(point_mm.z() * 100) / 100 + 0.0);
  return text;
}

template <class Row>
std::string difference_text(const Row& near) {
  char text[120];
  std::snprintf(text, sizeof text, ": differs in %.1f %% of the surface, by up to %.1f mm%s",
                100 * static_cast<double>(near.differing_share),
                static_cast<double>(near.deviation_mm),
                near.kind == SymmetryKind::kIndistinguishable ? "; the sensor cannot tell" : "");
  return text;
}

nlohmann::ordered_json to_json(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

// Row-major 4x4, CAD to CAD, as in models_info.json.
nlohmann::ordered_json matrix_json(const ObjectModel& model, const SymmetryTurn& turn) {
  const Pose move = in_cad(move_of(turn), model.centre_mm());
  auto json = nlohmann::ordered_json::array();
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) json.push_back(move.R(r, c));
    json.push_back(move.t_mm[r]);
  }
  for (const double v : {0.0, 0.0, 0.0, 1.0}) json.push_back(v);
  return json;
}

nlohmann::ordered_json axis_json(const ObjectModel& model, const SymmetryAxis& a) {
  return {{"axis", to_json(vector_of(a.axis))},
          {"offset", to_json(point_in_cad(model, a.point_mm))}};
}

}  // namespace

std::vector<FoldAxis> fold_axes(const ObjectModel& model) {
  std::vector<FoldAxis> axes;
  for (const SymmetryTurn& t : model.symmetry().exact_turns) {
    const Vec3 axis = vector_of(t.axis);
    const int fold =
        static_cast<int>(std::lround(2 * kPi / std::abs(static_cast<double>(t.angle_rad))));
    const auto known = std::find_if(axes.begin(), axes.end(), [&](const FoldAxis& a) {
      return std::abs(a.axis.dot(axis)) > std::cos(1 * kDegree);
    });
    if (known == axes.end()) {
      axes.push_back({axis, point_in_cad(model, t.point_mm), fold});
    } else {
      known->fold = std::max(known->fold, fold);
    }
  }
  std::stable_sort(axes.begin(), axes.end(),
                   [](const FoldAxis& a, const FoldAxis& b) { return a.fold > b.fold; });
  return axes;
}

std::vector<std::string> symmetry_lines(const ObjectModel& model) {
  const PartSymmetry& symmetry = model.symmetry();
  std::vector<std::string> lines;
  const auto add_axis = [&](const std::string& what, const float(&axis)[3],
                            const float(&point_mm)[3], const std::string& difference) {
    lines.push_back(what + line_text(vector_of(axis), point_in_cad(model, point_mm)) + difference);
  };
  for (const SymmetryAxis& a : symmetry.exact_axes)
    add_axis("continuous about ", a.axis, a.point_mm, "");
  for (const FoldAxis& f : fold_axes(model))
    lines.push_back(std::to_string(f.fold) + "-fold about " + line_text(f.axis, f.point_mm));
  for (const SymmetryAxis& a : symmetry.near_axes) {
    add_axis("near-symmetric: turned by any angle about ", a.axis, a.point_mm, difference_text(a));
  }
  for (const SymmetryTurn& t : symmetry.near_turns) {
    char what[80], shift[60] = "";
    std::snprintf(what, sizeof what, "near-symmetric: turned by %.0f deg about ",
                  static_cast<double>(t.angle_rad) / kDegree);
    if (std::abs(t.shift_mm) >= 0.05f) {
      std::snprintf(shift, sizeof shift, ", shifted along it by %.1f mm",
                    static_cast<double>(t.shift_mm));
    }
    add_axis(what, t.axis, t.point_mm, shift + difference_text(t));
  }
  if (lines.empty()) lines.emplace_back("none");
  return lines;
}

nlohmann::ordered_json symmetry_json(const ObjectModel& model) {
  const PartSymmetry& symmetry = model.symmetry();
  nlohmann::ordered_json json = {{"symmetries_discrete", nlohmann::ordered_json::array()},
                                 {"symmetries_continuous", nlohmann::ordered_json::array()},
                                 {"folds", nlohmann::ordered_json::array()},
                                 {"near", nlohmann::ordered_json::array()}};
  for (const SymmetryTurn& t : symmetry.exact_turns)
    json["symmetries_discrete"].push_back(matrix_json(model, t));
  for (const SymmetryAxis& a : symmetry.exact_axes)
    json["symmetries_continuous"].push_back(axis_json(model, a));
  for (const FoldAxis& f : fold_axes(model)) {
    json["folds"].push_back(
        {{"axis", to_json(f.axis)}, {"offset", to_json(f.point_mm)}, {"fold", f.fold}});
  }
  const auto add_near = [&](nlohmann::ordered_json row, const auto& near) {
    row["differing_share"] = near.differing_share;
    row["deviation_mm"] = near.deviation_mm;
    row["indistinguishable"] = near.kind == SymmetryKind::kIndistinguishable;
    json["near"].push_back(std::move(row));
  };
  for (const SymmetryAxis& a : symmetry.near_axes) {
    nlohmann::ordered_json row = axis_json(model, a);
    row["angle_deg"] = nullptr;  // any
    add_near(std::move(row), a);
  }
  for (const SymmetryTurn& t : symmetry.near_turns) {
    add_near({{"axis", to_json(vector_of(t.axis))},
              {"offset", to_json(point_in_cad(model, t.point_mm))},
              {"angle_deg", static_cast<double>(t.angle_rad) / kDegree},
              {"shift_mm", t.shift_mm},
              {"matrix", matrix_json(model, t)}},
             t);
  }
  return json;
}

}  // namespace binpick::app
