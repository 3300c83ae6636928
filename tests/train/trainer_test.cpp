// Training as a whole: bytes that depend on nothing but the input, and errors that name what is
// wrong.
#include "binpick/train/trainer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>

#include "binpick/model/object_model.hpp"
#include "binpick/train/errors.hpp"
#include "thread_pool.hpp"
#include "train/pose_tree.hpp"
#include "train/sample_pool.hpp"
#include "train/template_builder.hpp"
#include "train/toy_part.hpp"

namespace binpick::train {
namespace {

const Vec3 kBoxHalf_mm{30, 18, 10};
const Vec3 kBoxCentre_mm{12, -7, 4};

std::vector<std::uint8_t> train(const Mesh& mesh, const TrainOptions& options, int threads = 1) {
  app::ThreadPool pool(threads);
  return train_model(imported(mesh), options, pool, {});
}

std::string fault_of(const TrainOptions& options, const Mesh& mesh = box_part(kBoxHalf_mm)) {
  try {
    train(mesh, options);
  } catch (const TrainError& e) {
    return e.what();
  }
  return "no error";
}

TEST(Trainer, GivesTheSameBytesOnAnyNumberOfThreads) {
  const std::vector<std::uint8_t> one = train(asymmetric_part(), small_options(), 1);
  EXPECT_GT(one.size(), 10000u);
  EXPECT_TRUE(one == train(asymmetric_part(), small_options(), 2));
  EXPECT_TRUE(one == train(asymmetric_part(), small_options(), 3));
}

TEST(Trainer, GivesOtherTemplatesForAnotherSeed) {
  TrainOptions options = small_options();
  const auto first = train(asymmetric_part(), options);
  options.seed = 2;
  const auto second = train(asymmetric_part(), options);
  const auto a = ObjectModel::parse(first), b = ObjectModel::parse(second);
  ASSERT_TRUE(a.ok() && b.ok());
  // The seed itself is in the file: look at what was trained.
  int different = 0;
  const auto& ta = a.value().depth(1).templates;
  const auto& tb = b.value().depth(1).templates;
  ASSERT_EQ(ta.size(), tb.size());
  for (std::size_t t = 0; t < ta.size(); ++t) {
    different += ta[t].gradient_weight_sum != tb[t].gradient_weight_sum;
  }
  EXPECT_GT(different, 0);
}

TEST(Trainer, ReportsItsProgressFromNothingToAll) {
  SerialPool pool;
  std::vector<double> shares;
  train_model(imported(asymmetric_part()), small_options(), pool,
              [&](double share) { shares.push_back(share); });
  ASSERT_FALSE(shares.empty());
  EXPECT_TRUE(std::ranges::is_sorted(shares));
  EXPECT_GE(shares.front(), 0);
  EXPECT_DOUBLE_EQ(shares.back(), 1);
}

struct BadOption {
  const char* names;
  std::function<void(TrainOptions&)> spoil;
};

TEST(Trainer, NamesTheOptionThatIsOutOfRange) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  using O = TrainOptions;
  const BadOption cases[] = {
      {"focal length", [](O& o) { o.camera.fx = 0; }},
      {"focal length", [=](O& o) { o.camera.fy = nan; }},
      {"distance range", [](O& o) { o.distance_min_mm = 0; }},
      {"distance range", [](O& o) { o.distance_max_mm = o.distance_min_mm - 1; }},
      {"distance range", [=](O& o) { o.distance_max_mm = inf; }},
      {"tilt limit", [](O& o) { o.tilt_max_deg = 0; }},
      {"tilt limit", [](O& o) { o.tilt_max_deg = 181; }},
      {"tilt limit", [=](O& o) { o.tilt_max_deg = nan; }},
      {"number of samples", [](O& o) { o.samples = 9; }},
      {"number of samples", [](O& o) { o.samples = 2501; }},
      {"no usable features", [](O& o) { o.gradient_threshold = o.normal_threshold = 0.999; }},
      {"gradient threshold", [](O& o) { o.gradient_threshold = -1; }},
      {"gradient threshold", [](O& o) { o.gradient_threshold = 1; }},
      {"normal threshold", [](O& o) { o.normal_threshold = -1; }},
      {"normal threshold", [](O& o) { o.normal_threshold = 1; }},
      {"tilt jitter", [](O& o) { o.tilt_jitter_deg = 0; }},
      {"tilt jitter", [](O& o) { o.tilt_jitter_deg = 46; }},
      {"roll jitter", [](O& o) { o.roll_jitter_deg = 0; }},
      {"roll jitter", [=](O& o) { o.roll_jitter_deg = nan; }},
      {"distance jitter", [](O& o) { o.distance_jitter_mm = -1; }},
      {"distance jitter", [=](O& o) { o.distance_jitter_mm = inf; }},
      {"roll interval", [](O& o) { o.roll_interval_deg = 0.5; }},
      {"roll interval", [](O& o) { o.roll_interval_deg = 91; }},
      {"distance interval", [](O& o) { o.distance_interval_mm = 0; }},
      {"distance interval", [](O& o) { o.distance_interval_mm = 0.1; }},
      {"distance interval", [=](O& o) { o.distance_interval_mm = nan; }},
      {"pose tree", [](O& o) { o.tree_depths = 1; }},
      {"pose tree", [](O& o) { o.tree_depths = 5; }},
      {"features", [](O& o) { o.contour_features = -1; }},
      {"features", [](O& o) { o.surface_features = 250; }},
      {"features", [](O& o) { o.contour_features = o.surface_features = 3; }},
  };
  for (const BadOption& c : cases) {
    TrainOptions options = small_options();
    c.spoil(options);
    EXPECT_THAT(fault_of(options), testing::HasSubstr(c.names));
  }
}

TEST(Trainer, RefusesAPartThatDoesNotFitTheCamera) {
  EXPECT_THAT(fault_of(small_options(), box_part({300, 300, 300})),
              testing::HasSubstr("too large"));
  EXPECT_THAT(fault_of(small_options(), box_part({1, 1, 1})), testing::HasSubstr("px"));
  EXPECT_THAT(fault_of(small_options(), Mesh{}), testing::HasSubstr("no triangles"));
}

TEST(Trainer, WritesWhatItWasTrainedFor) {
  const TrainOptions options = small_options();
  const auto bytes = train(box_part(kBoxHalf_mm, kBoxCentre_mm), options);
  const auto parsed = ObjectModel::parse(bytes);
  ASSERT_TRUE(parsed.ok()) << error_message(parsed.error().code) << ": " << parsed.error().where;
  const ObjectModel& model = parsed.value();
  const ModelInfo& info = model.info();
  EXPECT_EQ(info.source_hash, 42u);
  EXPECT_EQ(info.samples, 30);
  EXPECT_EQ(info.triangle_count, 12);
  EXPECT_EQ(info.camera.fx, 1200);
  EXPECT_NEAR(info.reference_distance_mm, std::sqrt(info.distance_min_mm * info.distance_max_mm),
              1e-9);
  EXPECT_NEAR(info.diameter_mm, 2 * kBoxHalf_mm.norm(), 0.08);
  EXPECT_NEAR(info.bounds_max_mm[0], 42, 1e-4);
  ASSERT_EQ(model.depth_count(), 2);
  for (int d = 0; d < 2; ++d) {
    for (const TemplateRange& t : model.depth(d).templates) {
      EXPECT_GE(t.count, 20) << "depth " << d;
      EXPECT_GT(t.gradient_weight_sum, 0);
      EXPECT_GT(t.normal_weight_sum, 0);
      for (const Feature& f : model.features(t)) {
        EXPECT_NE(f.gradient_bits | f.normal_bits, 0);
        EXPECT_TRUE(d <= info.scan_depth || (f.x % 2 == 0 && f.y % 2 == 0));
      }
    }
  }
  // Any distance of the range has a leaf within half its interval.
  const int leaves = model.depth(1).distance_count;
  for (double mm = 500; mm <= 700; mm += 0.5) {
    double nearest = 1e9;
    for (int k = 0; k < leaves; ++k) {
      const double off_mm = std::abs(model.distance_mm(1, k) - mm);
      nearest = std::min(nearest, off_mm / model.distance_interval_mm(1, k));
    }
    EXPECT_LE(nearest, 0.55);
  }
}

TEST(Trainer, StaysFarBelow64MegabytesWithTheDefaults) {
  const auto bytes = train(asymmetric_part(), small_options());
  const auto model = ObjectModel::parse(bytes);
  ASSERT_TRUE(model.ok());
  std::size_t features_max = 0, samples_max = 0;
  for (int d = 0; d < 2; ++d) {
    for (const TemplateRange& t : model.value().depth(d).templates) {
      features_max = std::max<std::size_t>(features_max, t.count);
    }
    for (const Viewpoint& v : model.value().depth(d).viewpoints) {
      samples_max = std::max<std::size_t>(
          samples_max,
          6 * sizeof(float) * (padded_samples(v.surface_count) + padded_samples(v.contour_count)));
    }
  }
  const PoseTree tree = make_pose_tree(toy_options());
  std::size_t templates = 0;
  for (const TreeLayer& layer : tree.depths) {
    templates += layer.viewpoints.size() * static_cast<std::size_t>(layer.roll_count);
  }
  EXPECT_EQ(templates, 47040u);
  const std::size_t estimate =
      templates * (sizeof(TemplateRange) + features_max * sizeof(Feature)) +
      tree.leaves().viewpoints.size() * (sizeof(Viewpoint) + samples_max);
  std::printf("with the defaults at most %.1f MB\n", static_cast<double>(estimate) / 1e6);
  EXPECT_LT(estimate, 64u << 20);
}

TEST(TemplateCamera, HoldsThePartAtEveryDistanceOfItsJitter) {
  for (const double distance_mm : {200.0, 350.0, 600.0, 2000.0}) {
    TrainOptions options = toy_options();
    options.distance_min_mm = distance_mm - 50;
    options.distance_max_mm = distance_mm + 50;
    const MeshBounds bounds = mesh_bounds(box_part(kBoxHalf_mm));
    const TemplateCamera camera = make_template_camera(options, bounds);
    EXPECT_EQ(camera.radius % 8, 0);
    // Offsets of features are stored in a byte.
    EXPECT_LE(camera.radius, 128) << "at " << distance_mm << " mm";
    const double nearest_mm = distance_mm - options.distance_jitter_mm;
    const double half_mm = bounds.diameter_mm / 2;
    const double reach_px =
        camera.intrinsics.fx * half_mm / std::sqrt(nearest_mm * nearest_mm - half_mm * half_mm);
    EXPECT_GE(camera.radius, reach_px) << "at " << distance_mm << " mm";
  }
}

TEST(SamplePool, SurroundsEveryLeafViewpointWithItsWholeTiltJitter) {
  for (const int depths : {2, 3, 4}) {
    for (const double tilt_max_deg : {20.0, 60.0}) {
      TrainOptions options = toy_options();
      options.tree_depths = depths;
      options.tilt_max_deg = tilt_max_deg;
      const Mesh mesh = box_part(kBoxHalf_mm);
      TemplateCamera camera = make_template_camera(options, mesh_bounds(mesh));
      camera.intrinsics.width = camera.intrinsics.height = 8;  // what is seen does not matter here
      SerialPool pool;
      const PoseTree tree = make_pose_tree(options);
      const auto samples =
          make_sample_pool(mesh, options, tree, camera, sample_pool_size(options), pool, {});
      std::size_t fewest = samples.size();
      double off_most = 0;
      for (const TreeViewpoint& view : tree.leaves().viewpoints) {
        const auto near = samples_near(view, samples, options.tilt_jitter_deg);
        fewest = std::min(fewest, near.size());
        // The middle of the renderings is the viewpoint's own direction.
        Vec3 mean = Vec3::Zero();
        for (const AlignedSample& s : near) mean += samples[s.index].direction_obj;
        off_most = std::max(off_most, mean.cross(view.direction_obj).norm() / mean.norm());
      }
      EXPECT_GT(fewest, 60u) << depths << " depths, tilt limit " << tilt_max_deg;
      EXPECT_LT(off_most, 0.02) << depths << " depths, tilt limit " << tilt_max_deg;
    }
  }
}

}  // namespace
}  // namespace binpick::train
