// The samples of trained viewpoints: they lie where a rendering shows the part, in an order that
// serves.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "binpick/model/object_model.hpp"
#include "binpick/train/renderer.hpp"
#include "binpick/train/trainer.hpp"
#include "train/toy_part.hpp"

namespace binpick::train {
namespace {

const Vec3 kBoxHalf_mm{30, 18, 10};
const Vec3 kBoxCentre_mm{12, -7, 4};

std::vector<std::uint8_t> train(const Mesh& mesh) {
  SerialPool pool;
  return train_model(imported(mesh), small_options(), pool, {});
}

Vec3 position(const SampleArrays& s, int i) {
  return {s.x[i], s.y[i], s.z[i]};
}
Vec3 direction(const SampleArrays& s, int i) {
  return {s.dx[i], s.dy[i], s.dz[i]};
}

// Distance of a point from the surface of a box around the origin.
double distance_to_box(const Vec3& p, const Vec3& half) {
  const Vec3 q = p.cwiseAbs() - half;
  const double outside = q.cwiseMax(0).norm();
  return outside > 0 ? outside : -q.maxCoeff();
}

TEST(ViewSamples, LieOnTheVisibleSurfaceWithUnitNormals) {
  const auto bytes = train(box_part(kBoxHalf_mm, kBoxCentre_mm));
  const auto model = ObjectModel::parse(bytes);
  ASSERT_TRUE(model.ok());
  const TreeDepth& leaves = model.value().depth(1);
  double worst_mm = 0;
  for (const Viewpoint& v : leaves.viewpoints) {
    const Vec3 towards(-v.R_view_obj[6], -v.R_view_obj[7], -v.R_view_obj[8]);
    const SampleArrays samples = model.value().surface(v);
    EXPECT_GT(samples.count, 100);
    EXPECT_LE(samples.count, 320);
    for (int i = 0; i < samples.count; ++i) {
      const Vec3 p = position(samples, i), n = direction(samples, i);
      worst_mm = std::max(worst_mm, distance_to_box(p, kBoxHalf_mm));
      EXPECT_NEAR(n.norm(), 1, 1e-5);
      EXPECT_GT(n.dot(600 * towards - p), 0) << "turned away from the camera";
      // Beyond the patch that is averaged, even on a face seen at 18 degrees, it is the face's own.
      const Vec3 from_edge = (kBoxHalf_mm - p.cwiseAbs()).cwiseAbs();
      int axis;
      from_edge.minCoeff(&axis);
      Vec3 others = from_edge;
      others[axis] = 1e9;
      if (others.minCoeff() > 7) {
        EXPECT_GT(n[axis] * (p[axis] > 0 ? 1 : -1), 0.999);
      }
    }
  }
  std::printf("surface samples at most %.3f mm off the part\n", worst_mm);
  EXPECT_LT(worst_mm, 0.3);
}

struct Spread {
  Vec3 middle = Vec3::Zero();
  Eigen::AlignedBox3d bounds;
  explicit Spread(const SampleArrays& samples) {
    for (int i = 0; i < samples.count; ++i) {
      middle += position(samples, i) / samples.count;
      bounds.extend(position(samples, i));
    }
  }
};

// An alignment may look at the first samples only.
TEST(ViewSamples, AnyPrefixIsSpreadOverTheWholeSurface) {
  const auto bytes = train(asymmetric_part());
  const auto model = ObjectModel::parse(bytes);
  ASSERT_TRUE(model.ok());
  for (const Viewpoint& v : model.value().depth(1).viewpoints) {
    const SampleArrays samples = model.value().surface(v);
    const Spread all(samples);
    const double size_mm = all.bounds.diagonal().norm();
    for (const int share : {2, 4, 8}) {
      const Spread some(samples.first(samples.count / share));
      EXPECT_LT((some.middle - all.middle).norm(), 0.05 * size_mm) << "1/" << share;
      EXPECT_GT(some.bounds.diagonal().norm(), 0.85 * size_mm) << "1/" << share;
    }
  }
}

// Where the outline runs: midway between each pixel of the part and the background beside it.
std::vector<Vec2> silhouette_of(const RenderedView& view) {
  std::vector<Vec2> out;
  const auto depth = view.depth_view();
  for (int y = 1; y + 1 < view.height; ++y) {
    for (int x = 1; x + 1 < view.width; ++x) {
      if (!(depth.at(x, y) > 0)) continue;
      for (const auto& [i, j] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        if (!(depth.at(x + i, y + j) > 0)) out.emplace_back(x + 0.5 * i, y + 0.5 * j);
      }
    }
  }
  return out;
}

// How far across, in the image, a point of the box's surface lies from the nearest of its edges.
double px_to_edge(const CameraIntrinsics& camera, const Pose& T, const Vec3& p, const Vec3& half) {
  double nearest = 1e9;
  for (int along = 0; along < 3; ++along) {
    Vec3 edge = p;
    for (int axis = 0; axis < 3; ++axis) {
      if (axis != along) edge[axis] = std::copysign(half[axis], p[axis]);
    }
    const Vec2 at = camera.project(T * edge);
    const Vec2 run = (camera.project(T * (edge + 0.1 * Vec3::Unit(along))) - at).normalized();
    const Vec2 away = camera.project(T * p) - at;
    nearest = std::min(nearest, std::abs(run.x() * away.y() - run.y() * away.x()));
  }
  return nearest;
}

TEST(ViewSamples, HaveTheOutlineAndTheCreasesOfARendering) {
  const auto bytes = train(box_part(kBoxHalf_mm, kBoxCentre_mm));
  const auto model = ObjectModel::parse(bytes);
  ASSERT_TRUE(model.ok());
  Renderer renderer(box_part(kBoxHalf_mm), 300, 300);
  const CameraIntrinsics camera{300, 300, 1400, 1400, 150, 150};  // as large as it was sampled
  RenderedView view;
  double worst_px = 0, worst_crease_px = 0;
  std::size_t creases = 0, steep = 0, all = 0;
  for (const Viewpoint& v : model.value().depth(1).viewpoints) {
    Pose T{Mat3::Identity(), Vec3(0, 0, model.value().info().reference_distance_mm)};
    for (int i = 0; i < 9; ++i) T.R(i / 3, i % 3) = static_cast<double>(v.R_view_obj[i]);
    renderer.render(camera, T, view);
    const std::vector<Vec2> outline = silhouette_of(view);
    std::size_t silhouettes = 0, bent = 0;
    const SampleArrays contour = model.value().contour(v);
    for (int i = 0; i < contour.count; ++i) {
      EXPECT_NEAR(direction(contour, i).norm(), 1, 1e-5);
      const Vec2 at = camera.project(T * position(contour, i));
      const double edge_px = px_to_edge(camera, T, position(contour, i), kBoxHalf_mm);
      if (i >= static_cast<int>(v.outline_count)) {
        ++creases;
        worst_crease_px = std::max(worst_crease_px, edge_px);
        continue;
      }
      ++silhouettes;
      double nearest = 1e9;
      for (const Vec2& o : outline) nearest = std::min(nearest, (o - at).norm());
      if (nearest > 1.5 && edge_px < 1.5) {
        ++steep;  // a crease to a face so steep that the detector takes it for a step in depth
        continue;
      }
      worst_px = std::max(worst_px, nearest);
      // The edges of a box run along its axes; only at its corners does the outline bend.
      const double along = direction(contour, i).cwiseAbs().maxCoeff();
      EXPECT_GT(along, 0.8);
      bent += along < 0.98;
    }
    EXPECT_GT(silhouettes, 40u);
    EXPECT_LE(silhouettes, 128u);
    EXPECT_LT(bent, 0.15 * static_cast<double>(silhouettes));
    all += silhouettes;
  }
  std::printf(
      "outline samples at most %.2f px off the outline, %zu creases at most %.2f px off; "
      "%zu of %zu outline samples at steep creases\n",
      worst_px, creases, worst_crease_px, steep, all);
  EXPECT_LT(worst_px, 1.5);
  EXPECT_GT(creases, 50u);
  EXPECT_LT(worst_crease_px, 1.5);  // a crease sample is the pixel on either side of the edge
  EXPECT_LT(static_cast<double>(steep), 0.1 * static_cast<double>(all));
}

}  // namespace
}  // namespace binpick::train
