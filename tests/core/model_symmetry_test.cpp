// The symmetry tables of a model file: good and hostile ones.
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "binpick/model/object_model.hpp"
#include "symmetry_rows.hpp"

namespace binpick {
namespace {

using Bytes = std::vector<std::uint8_t>;

struct Rows {
  std::vector<SymmetryTurn> turns;
  std::vector<SymmetryAxis> axes;
};

Rows good_rows() {
  SymmetryTurn near = turn_row(Vec3::UnitZ(), 180, 4, SymmetryKind::kNear);
  near.shift_mm = 2;
  near.differing_share = 0.25f;
  near.deviation_mm = 3;
  SymmetryAxis near_axis = axis_row(Vec3::UnitX(), 0, SymmetryKind::kNear);
  near_axis.differing_share = 1;
  return {{turn_row(Vec3::UnitZ(), 180, 4), near}, {axis_row(Vec3::UnitX()), near_axis}};
}

// A whole model file with these rows.
Bytes file_with(const Rows& rows) {
  static const Bytes tiny = tiny_model_bytes();
  return with_symmetry(tiny, rows.turns, rows.axes);
}

ErrorCode parsed_after(const std::function<void(Rows&)>& change) {
  Rows rows = good_rows();
  change(rows);
  const Bytes bytes = file_with(rows);
  const Result<ObjectModel> model = ObjectModel::parse(bytes);
  return model.ok() ? ErrorCode::kNone : model.error().code;
}

TEST(ModelSymmetry, IsReadAsItWasWritten) {
  const Bytes bytes = file_with(good_rows());
  const Result<ObjectModel> model = ObjectModel::parse(bytes);
  ASSERT_TRUE(model.ok()) << model.error().where;
  const PartSymmetry& symmetry = model.value().symmetry();
  ASSERT_EQ(1u, symmetry.exact_turns.size());
  ASSERT_EQ(1u, symmetry.near_turns.size());
  ASSERT_EQ(1u, symmetry.exact_axes.size());
  ASSERT_EQ(1u, symmetry.near_axes.size());
  EXPECT_TRUE((move_of(symmetry.near_turns[0]) * Vec3(5, 0, 0)).isApprox(Vec3(3, 0, 2), 1e-5));
  EXPECT_EQ(1.0f, symmetry.near_axes[0].differing_share);
}

TEST(ModelSymmetry, OfAPartWithoutAnyIsEmpty) {
  const Bytes bytes = file_with({});
  const Result<ObjectModel> model = ObjectModel::parse(bytes);
  ASSERT_TRUE(model.ok()) << model.error().where;
  EXPECT_TRUE(model.value().symmetry().exact_turns.empty());
  EXPECT_TRUE(model.value().symmetry().near_axes.empty());
}

TEST(ModelSymmetry, HostileRowsAreRefused) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const std::function<void(Rows&)> changes[] = {
      [](Rows& r) { r.turns[0].kind = static_cast<SymmetryKind>(3); },
      [](Rows& r) { r.turns[1].kind = static_cast<SymmetryKind>(-1); },
      [](Rows& r) { std::swap(r.turns[0], r.turns[1]); },
      [](Rows& r) { r.turns[0].axis[0] = 1; },
      [](Rows& r) { r.turns[0].axis[2] = 0; },
      [](Rows& r) { r.turns[0].axis[2] = kNan; },
      [](Rows& r) { r.turns[0].point_mm[1] = kInfinity; },
      [](Rows& r) { r.turns[0].angle_rad = 0; },
      [](Rows& r) { r.turns[0].angle_rad = 4; },
      [](Rows& r) { r.turns[0].angle_rad = kNan; },
      [](Rows& r) { r.turns[0].shift_mm = 1; },
      [](Rows& r) { r.turns[0].differing_share = 0.5f; },
      [](Rows& r) { r.turns[1].shift_mm = kNan; },
      [](Rows& r) { r.turns[1].differing_share = 1.5f; },
      [](Rows& r) { r.turns[1].differing_share = kNan; },
      [](Rows& r) { r.turns[1].deviation_mm = -1; },
      [](Rows& r) { r.turns[1].deviation_mm = kInfinity; },
      [](Rows& r) { r.turns.insert(r.turns.begin(), kExactTurnsMax, r.turns[0]); },
      [](Rows& r) { r.turns.insert(r.turns.end(), kNearTurnsMax, r.turns[1]); },
      [](Rows& r) { std::swap(r.axes[0], r.axes[1]); },
      [](Rows& r) { r.axes[0].axis[0] = 0.9f; },
      [](Rows& r) { r.axes[0].differing_share = 0.1f; },
      [](Rows& r) { r.axes[1].point_mm[2] = kNan; },
      [](Rows& r) { r.axes.insert(r.axes.end(), kSymmetryAxesMax, r.axes[1]); }};
  int index = 0;
  for (const auto& change : changes) {
    EXPECT_EQ(ErrorCode::kModelInconsistent, parsed_after(change)) << "change " << index;
    ++index;
  }
  EXPECT_EQ(ErrorCode::kNone, parsed_after([](Rows&) {}));
  EXPECT_EQ(ErrorCode::kNone, parsed_after([](Rows& r) {
              r.turns[1].kind = r.axes[1].kind = SymmetryKind::kIndistinguishable;
            }));
}

}  // namespace
}  // namespace binpick
