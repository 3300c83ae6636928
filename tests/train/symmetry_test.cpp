// What the symmetry search says of parts whose symmetries are known.
#include "train/symmetry.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "binpick/drivers/bop_dataset.hpp"
#include "binpick/geometry/angle.hpp"
#include "train/screw.hpp"
#include "train/symmetry_parts.hpp"

namespace binpick::train {
namespace {

const Vec3 kAxes[] = {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};

struct Found {
  std::vector<Pose> exact, near;
  std::vector<SymmetryTurn> near_turns;
  std::vector<SymmetryAxis> exact_axes, near_axes;
  Vec3 centre_mm;  // of the coordinates in which all these are
  double diameter_mm = 0;
};

Found search(Mesh mesh) {
  const MeshBounds bounds = mesh_bounds(mesh);
  Found out;
  out.centre_mm = (bounds.min_mm + bounds.max_mm) / 2;
  out.diameter_mm = bounds.diameter_mm;
  for (auto& v : mesh.vertices_mm) v -= out.centre_mm.cast<float>();
  const FoundSymmetry found =
      find_symmetry(mesh, bounds.diameter_mm, symmetry_tolerance(bounds.diameter_mm, 1800, 700));
  for (const SymmetryTurn& t : found.turns) {
    if (t.kind == SymmetryKind::kExact) {
      out.exact.push_back(move_of(t));
    } else {
      out.near.push_back(move_of(t));
      out.near_turns.push_back(t);
    }
  }
  for (const SymmetryAxis& a : found.axes)
    (a.kind == SymmetryKind::kExact ? out.exact_axes : out.near_axes).push_back(a);
  return out;
}

Vec3 axis_of(const SymmetryAxis& a) {
  return {static_cast<double>(a.axis[0]), static_cast<double>(a.axis[1]),
          static_cast<double>(a.axis[2])};
}

bool has_turn(const std::vector<Pose>& moves, const Vec3& axis, double angle_deg) {
  const Mat3 R = rotation_from_vector(axis.normalized() * angle_deg * kDegree);
  return std::any_of(moves.begin(), moves.end(),
                     [&](const Pose& m) { return rotation_angle_between(m.R, R) < 1 * kDegree; });
}

Mesh moved(Mesh mesh, const Pose& T) {
  for (auto& v : mesh.vertices_mm) v = (T * v.cast<double>()).cast<float>();
  return mesh;
}

const Pose kAskew{rotation_from_vector(Vec3(0.4, -1.1, 0.7)), Vec3(120, -45, 300)};

TEST(Symmetry, OfABoxIsThreeHalfTurns) {
  const Found s = search(box_part({25, 15, 8}));
  EXPECT_EQ(3u, s.exact.size());
  for (const Vec3& axis : kAxes) EXPECT_TRUE(has_turn(s.exact, axis, 180)) << axis.transpose();
  EXPECT_TRUE(s.exact_axes.empty());
}

TEST(Symmetry, OfACubeIsTheWholeGroupHoweverItLies) {
  for (const Mesh& mesh : {box_part({20, 20, 20}), moved(box_part({20, 20, 20}), kAskew)}) {
    const Found s = search(mesh);
    EXPECT_EQ(23u, s.exact.size());
    EXPECT_TRUE(s.exact_axes.empty());
    EXPECT_TRUE(s.near.empty());
  }
}

TEST(Symmetry, OfACylinderIsAnAxisAndAHalfTurn) {
  const Found s = search(turned({{10, -20}, {10, 20}}, 24));
  ASSERT_EQ(1u, s.exact_axes.size());
  EXPECT_GT(std::abs(axis_of(s.exact_axes[0]).z()), std::cos(0.5 * kDegree));
  ASSERT_EQ(1u, s.exact.size());
  EXPECT_LT(std::abs(screw_of(s.exact[0]).axis.z()), 0.01);
}

TEST(Symmetry, OfAConeIsAnAxisAlone) {
  const Found s = search(moved(turned({{12, 0}, {4, 30}}, 32), kAskew));
  ASSERT_EQ(1u, s.exact_axes.size());
  EXPECT_GT(std::abs(axis_of(s.exact_axes[0]).dot(kAskew.R.col(2))), std::cos(0.5 * kDegree));
  EXPECT_TRUE(s.exact.empty());
}

TEST(Symmetry, OfABallIsAnyTurn) {
  std::vector<Vec2> profile;
  for (int i = 1; i < 32; ++i) {
    const double a = kPi * i / 32;
    profile.emplace_back(20 * std::sin(a), -20 * std::cos(a));
  }
  EXPECT_GE(search(turned(profile, 48)).exact_axes.size(), 2u);
}

TEST(Symmetry, OfAHexagonalPrismHasElevenTurns) {
  const Found s = search(turned({{10, -6}, {10, 6}}, 6));
  EXPECT_EQ(11u, s.exact.size());
  EXPECT_TRUE(has_turn(s.exact, Vec3::UnitZ(), 60));
  EXPECT_TRUE(has_turn(s.exact, Vec3::UnitX(), 180));
  EXPECT_TRUE(s.exact_axes.empty());
}

TEST(Symmetry, OfABoltIsItsHeads) {
  const Found s = search(ringed_bolt());
  EXPECT_EQ(5u, s.exact.size());
  EXPECT_TRUE(has_turn(s.exact, Vec3::UnitZ(), 60));
  EXPECT_TRUE(s.exact_axes.empty());
  // The shaft does not tell the roll at all, the head only little.
  ASSERT_EQ(1u, s.near_axes.size());
  EXPECT_GT(std::abs(axis_of(s.near_axes[0]).z()), 0.999);
}

TEST(Symmetry, OfABracketIsNoneButItsLegsAreTakenForEachOther) {
  const Found s = search(uneven_bracket());
  EXPECT_TRUE(s.exact.empty());
  EXPECT_TRUE(s.exact_axes.empty());
  EXPECT_TRUE(has_turn(s.near, Vec3(1, 0, 1), 180));
}

TEST(Symmetry, OfAPlateWithAnOffCentreHoleIsNear) {
  const Found s = search(holed_plate(9, 4));
  EXPECT_TRUE(s.exact.empty());
  for (const Vec3& axis : kAxes) EXPECT_TRUE(has_turn(s.near, axis, 180)) << axis.transpose();
  for (const SymmetryTurn& t : s.near_turns) EXPECT_GT(t.differing_share, 0.02f);

  const Found middle = search(holed_plate(9, 0));
  EXPECT_EQ(1u, middle.exact.size());
  EXPECT_TRUE(has_turn(middle.exact, Vec3::UnitX(), 180));
}

TEST(Symmetry, OfABoxDoesNotChangeWithWhatIsInsideIt) {
  Mesh mesh = box_part({25, 15, 8});
  add_block(mesh, {3, 2, -4}, {11, 9, 5});
  EXPECT_EQ(3u, search(mesh).exact.size());
}

TEST(Symmetry, OfAnIrregularPartIsNone) {
  const Found s = search(asymmetric_part());
  EXPECT_TRUE(s.exact.empty());
  EXPECT_TRUE(s.exact_axes.empty());
}

TEST(Symmetry, MovesOfATurnAndAnAxisKeepTheirPoint) {
  SymmetryTurn t{};
  t.axis[2] = 1;
  t.point_mm[0] = 3;
  t.angle_rad = static_cast<float>(kPi / 2);
  t.shift_mm = 5;
  EXPECT_TRUE((move_of(t) * Vec3(4, 0, 0)).isApprox(Vec3(3, 1, 5), 1e-6));
  SymmetryAxis a{};
  a.axis[0] = 1;
  a.point_mm[1] = 2;
  EXPECT_TRUE((move_about(a, kPi) * Vec3(7, 3, 0)).isApprox(Vec3(7, 1, 0), 1e-6));
}

// Every symmetry of one list is in the other, as far as the part's tolerance.
void expect_agreement(const drivers::BopModel& model, const Found& s, const std::string& name) {
  const double limit_mm = 0.01 * s.diameter_mm;
  ASSERT_EQ(model.symmetries_continuous.size(), s.exact_axes.size()) << name;
  for (std::size_t i = 0; i < s.exact_axes.size(); ++i) {
    EXPECT_GT(std::abs(axis_of(s.exact_axes[i]).dot(model.symmetries_continuous[i].axis)),
              std::cos(1 * kDegree))
        << name;
  }
  EXPECT_EQ(model.symmetries_discrete.size(), s.exact.size()) << name;
  for (const Pose& wanted : model.symmetries_discrete) {
    EXPECT_TRUE(std::any_of(
        s.exact.begin(), s.exact.end(),
        [&](const Pose& found) {
          const Vec3 shift = found * Vec3::Zero() + s.centre_mm - wanted * s.centre_mm;
          return rotation_angle_between(found.R, wanted.R) < 1 * kDegree && shift.norm() < limit_mm;
        }))
        << name << "\n"
        << wanted.R;
  }
}

TEST(Symmetry, AgreesWithTheDataSets) {
  const char* folder = std::getenv("BINPICK_DEV_DATA");
  if (folder == nullptr) GTEST_SKIP() << "BINPICK_DEV_DATA names no folder of data sets";
  int parts = 0;
  for (const char* name : {"pile-dev", "real-dev"}) {
    const std::filesystem::path root = std::filesystem::path(folder) / name;
    if (!std::filesystem::exists(root)) continue;
    for (const auto& [id, model] : drivers::BopDataset(root.string(), "test").models()) {
      const ImportedMesh part = import_mesh(model.mesh_path, LengthUnit::kMillimetre);
      expect_agreement(model, search(part.mesh), model.mesh_path);
      ++parts;
    }
  }
  if (parts == 0) GTEST_SKIP() << "no data set in " << folder;
}

}  // namespace
}  // namespace binpick::train
