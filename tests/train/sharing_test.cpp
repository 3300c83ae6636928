// Templates from shared renderings against templates for which every sample was rendered by itself.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdio>
#include <string>

#include "binpick/geometry/angle.hpp"
#include "features/orientation.hpp"
#include "train/leaf_accumulator.hpp"
#include "train/template_builder.hpp"
#include "train/toy_part.hpp"

namespace binpick::train {
namespace {

constexpr int kBruteForceSamples = 300;

// Exact histograms, as shares of the samples.
struct BruteForce {
  HistogramGrid<float> gradient, normal;  // cells as in LeafHistograms
};

void vote(float* bins, const SoftBins& soft, float share) {
  for (int k = 0; k < soft.count; ++k) bins[soft.bin[k]] += share * soft.weight[k];
}

// Renders N poses around the template's own, spread as the paper says, and counts every pixel.
BruteForce render_each(Renderer& renderer, const TemplateCamera& camera,
                       const TrainOptions& options, const Mat3& R_template, std::uint64_t seed) {
  const int radius = camera.radius;
  BruteForce out{HistogramGrid<float>(2 * radius), HistogramGrid<float>(radius)};
  std::mt19937_64 engine(seed);
  RenderedView view;
  RenderedSample sample;
  const double tilt = options.tilt_jitter_deg * kDegree, roll = options.roll_jitter_deg * kDegree;
  for (int i = 0; i < kBruteForceSamples; ++i) {
    const double tilt_x = uniform(engine, -tilt, tilt), tilt_y = uniform(engine, -tilt, tilt);
    const double turn = uniform(engine, -roll, roll);
    const double jitter_mm = options.distance_jitter_mm;
    const double distance_mm =
        camera.reference_distance_mm + uniform(engine, -jitter_mm, jitter_mm);
    const Mat3 R = rotation_z(turn) * rotation_from_vector(Vec3(tilt_x, tilt_y, 0)) * R_template;
    renderer.render(camera.intrinsics, {R, Vec3(0, 0, distance_mm)}, view);
    extract_features(view, camera.intrinsics, sample);
    for (const ContourPoint& p : sample.contour) {
      const int x = static_cast<int>(p.x) + radius, y = static_cast<int>(p.y) + radius;
      if (x < 0 || y < 0 || x >= 2 * radius || y >= 2 * radius) continue;
      vote(out.gradient.cell(x, y), soft_gradient_bins(p.angle_rad), 1.0f / kBruteForceSamples);
    }
    for (const SurfacePoint& p : sample.surface) {
      // Cell i holds the pixels 2i - 1 and 2i, and a quarter of a vote of each of its four.
      const int x = (static_cast<int>(p.x) + radius + 1) / 2;
      const int y = (static_cast<int>(p.y) + radius + 1) / 2;
      if (x >= radius || y >= radius) continue;
      vote(out.normal.cell(x, y),
           soft_normal_bins(options.normal_codebook, p.tilt_sin, p.azimuth_rad),
           0.25f / kBruteForceSamples);
    }
  }
  return out;
}

struct Modality {
  long pixels = 0, equal_bits = 0;  // where either has a feature
  long set_in_both = 0, set_in_any = 0;
  double weight_difference = 0;
  double bit_agreement() const {
    return static_cast<double>(equal_bits) / static_cast<double>(kOrientationBins * pixels);
  }
  double overlap() const {
    return static_cast<double>(set_in_both) / static_cast<double>(set_in_any);
  }
  double weight_error() const { return weight_difference / static_cast<double>(pixels); }

  void add(const DominantOrientation& a, const DominantOrientation& b) {
    if (a.bits == 0 && b.bits == 0) return;
    ++pixels;
    equal_bits += kOrientationBins - std::popcount(static_cast<unsigned>(a.bits ^ b.bits));
    set_in_both += std::popcount(static_cast<unsigned>(a.bits & b.bits));
    set_in_any += std::popcount(static_cast<unsigned>(a.bits | b.bits));
    weight_difference += std::fabs(static_cast<double>(a.frequency - b.frequency));
  }
};

struct Agreement {
  Modality gradient, normal;
};

template <class T, class U>
void compare(const HistogramGrid<T>& gradient_a, const HistogramGrid<T>& normal_a, float scale_a,
             const HistogramGrid<U>& gradient_b, const HistogramGrid<U>& normal_b,
             const TrainOptions& options, Agreement& out) {
  const auto gradient_threshold = static_cast<float>(options.gradient_threshold);
  const auto normal_threshold = static_cast<float>(options.normal_threshold);
  for (int y = 0; y < normal_a.size; ++y) {
    for (int x = 0; x < normal_a.size; ++x) {
      const int gx = 2 * x, gy = 2 * y;
      out.gradient.add(dominant_orientation(gradient_a.cell(gx, gy), scale_a, gradient_threshold),
                       dominant_orientation(gradient_b.cell(gx, gy), 1.0f, gradient_threshold));
      out.normal.add(dominant_orientation(normal_a.cell(x, y), scale_a, normal_threshold),
                     dominant_orientation(normal_b.cell(x, y), 1.0f, normal_threshold));
    }
  }
}

void report(const char* name, const Modality& m) {
  std::printf(
      "%s: %.4f of the bits equal, %.4f of the set bits shared, weights %.4f apart "
      "(%ld pixels)\n",
      name, m.bit_agreement(), m.overlap(), m.weight_error(), m.pixels);
  testing::Test::RecordProperty(std::string(name) + " bits equal", m.bit_agreement());
  testing::Test::RecordProperty(std::string(name) + " set bits shared", m.overlap());
  testing::Test::RecordProperty(std::string(name) + " weights apart", m.weight_error());
}

TEST(SharedSamples, GiveTheTemplatesOfBruteForceRendering) {
  TrainOptions options = toy_options();
  options.tilt_max_deg = 24;
  Mesh mesh = asymmetric_part();
  // No face of the part is square to the axis around which the viewpoints lie.
  const Mat3 R_skew = rotation_from_vector({0.5, -0.35, 0.2});
  for (auto& v : mesh.vertices_mm) v = (R_skew * v.cast<double>()).cast<float>();
  const MeshBounds bounds = mesh_bounds(mesh);
  const Vec3 centre = (bounds.min_mm + bounds.max_mm) / 2;
  for (auto& v : mesh.vertices_mm) v -= centre.cast<float>();

  const TemplateCamera camera = make_template_camera(options, bounds);
  const PoseTree tree = make_pose_tree(options);
  SerialPool pool;
  const std::vector<RenderedSample> samples =
      make_sample_pool(mesh, options, tree, camera, sample_pool_size(options), pool, {});
  const int rolls = tree.leaves().roll_count;
  LeafAccumulator accumulator(samples, camera, options, make_roll_blocks(options, rolls));
  Renderer renderer(mesh, camera.intrinsics.width, camera.intrinsics.height);

  Agreement shared, floor;
  const int views = static_cast<int>(tree.leaves().viewpoints.size());
  const int cases[][2] = {
      {0, 0},         {views / 5, 7}, {2 * views / 5, 19}, {3 * views / 5, 33}, {4 * views / 5, 46},
      {views - 1, 58}};
  for (const auto& [v, roll] : cases) {
    const TreeViewpoint& view = tree.leaves().viewpoints[static_cast<std::size_t>(v)];
    const Mat3 R = rotation_z(roll_centre_rad(roll, rolls)) * view.R_view_obj;
    const auto seed = static_cast<std::uint64_t>(100 + v);
    const BruteForce brute = render_each(renderer, camera, options, R, seed);
    accumulator.run(v, view, rolls, [&](int r, const LeafHistograms& h) {
      if (r != roll) return;
      compare(h.gradient, h.normal, 1.0f / static_cast<float>(h.votes), brute.gradient,
              brute.normal, options, shared);
    });
    if (v != 0 && v != 3 * views / 5) continue;
    // How far two brute-force templates are apart that differ in nothing but their dice.
    const BruteForce again = render_each(renderer, camera, options, R, seed + 1000);
    compare(again.gradient, again.normal, 1.0f, brute.gradient, brute.normal, options, floor);
  }
  report("gradients, shared against brute force", shared.gradient);
  report("gradients, brute force twice", floor.gradient);
  report("normals, shared against brute force", shared.normal);
  report("normals, brute force twice", floor.normal);
  EXPECT_GE(shared.gradient.pixels, 300);
  EXPECT_GE(shared.normal.pixels, 2000);
  EXPECT_GE(shared.gradient.bit_agreement(), 0.9);
  EXPECT_GE(shared.normal.bit_agreement(), 0.95);
  // Most bits are zero and equal for nothing: the set ones count, beside how far two runs of brute
  // force share theirs. More renderings hardly help; turned points fall onto rounded pixels.
  EXPECT_GE(shared.gradient.overlap(), 0.75 * floor.gradient.overlap());
  EXPECT_GE(shared.normal.overlap(), 0.88 * floor.normal.overlap());
  EXPECT_LT(shared.gradient.weight_error(), 0.06);
  EXPECT_LT(shared.normal.weight_error(), 0.06);
}

}  // namespace
}  // namespace binpick::train
