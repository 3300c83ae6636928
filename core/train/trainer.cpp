#include "binpick/train/trainer.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "binpick/train/errors.hpp"
#include "model/model_format.hpp"
#include "train/model_writer.hpp"

namespace binpick::train {
namespace {

void require(bool ok, const std::string& sentence) {
  if (!ok) throw TrainError(sentence);
}

constexpr int kFeaturesMin = 8;  // of a leaf's template, below which it matches anything

void check_options(const TrainOptions& o) {
  require(o.camera.valid(), "the camera's focal lengths must be positive and finite");
  require(std::isfinite(o.distance_min_mm) && std::isfinite(o.distance_max_mm) &&
              o.distance_min_mm > 0 && o.distance_max_mm >= o.distance_min_mm,
          "the distance range must be positive, with its minimum not above its maximum");
  require(o.tilt_max_deg > 0 && o.tilt_max_deg <= 180,
          "the tilt limit must lie in (0, 180] degrees");
  require(o.samples >= 10 && o.samples <= 2500, "the number of samples must lie in [10, 2500]");
  require(o.gradient_threshold >= 0 && o.gradient_threshold < 1,
          "the gradient threshold is a share of the samples and must lie in [0, 1)");
  require(o.normal_threshold >= 0 && o.normal_threshold < 1,
          "the normal threshold is a share of the samples and must lie in [0, 1)");
  require(o.tilt_jitter_deg > 0.5 && o.tilt_jitter_deg <= 45,
          "the tilt jitter must lie in (0.5, 45] degrees");
  require(o.roll_jitter_deg > 0 && o.roll_jitter_deg <= 90,
          "the roll jitter must lie in (0, 90] degrees");
  require(o.distance_jitter_mm >= 0 && std::isfinite(o.distance_jitter_mm),
          "the distance jitter must not be negative");
  require(o.roll_interval_deg >= 1 && o.roll_interval_deg <= 90,
          "the roll interval must lie in [1, 90] degrees");
  require(o.distance_interval_mm > 0 &&
              (o.distance_max_mm - o.distance_min_mm) / o.distance_interval_mm <= 1000,
          "the distance interval must be positive and cut the range into at most 1000 steps");
  require(o.tree_depths >= 2 && o.tree_depths <= kModelDepthsMax,
          "the pose tree must have 2 to 4 depths");
  require(o.contour_features >= 0 && o.surface_features >= 0 &&
              o.contour_features + o.surface_features >= kFeaturesMin &&
              o.contour_features + o.surface_features <= 255,
          "a template must have 8 to 255 features");
}

// A template without features matches nothing, and nobody would see why.
void check_features(const TemplateSet& templates, int scan_depth) {
  const int leaf = static_cast<int>(templates.depths.size()) - 1;
  for (int d = scan_depth; d <= leaf; ++d) {
    const auto& depth = templates.depths[static_cast<std::size_t>(d)];
    const std::size_t needed = d == leaf ? kFeaturesMin : 1;
    const auto poor = static_cast<std::size_t>(std::count_if(
        depth.begin(), depth.end(), [&](const auto& t) { return t.size() < needed; }));
    require(2 * poor <= depth.size(),
            "the model has no usable features: " + std::to_string(poor) + " of " +
                std::to_string(depth.size()) + " templates at depth " + std::to_string(d) +
                " have fewer than " + std::to_string(needed) +
                "; lower the vote thresholds, or train for distances at which the part is larger "
                "in the image");
  }
}

Mesh centred(const Mesh& mesh, const Vec3& centre_mm) {
  Mesh out = mesh;
  for (auto& v : out.vertices_mm) v -= centre_mm.cast<float>();
  return out;
}

std::int32_t votes_of(double share, int samples) {
  return static_cast<std::int32_t>(std::lround(share * samples));
}

ModelInfo make_info(const ImportedMesh& part, const MeshBounds& bounds, const TrainOptions& o,
                    const TemplateCamera& camera) {
  ModelInfo info;
  std::memset(static_cast<void*>(&info), 0, sizeof(info));
  info.source_hash = part.source_hash;
  info.seed = o.seed;
  info.camera = o.camera;
  info.distance_min_mm = o.distance_min_mm;
  info.distance_max_mm = o.distance_max_mm;
  info.reference_distance_mm = camera.reference_distance_mm;
  info.tilt_max_deg = o.tilt_max_deg;
  info.diameter_mm = bounds.diameter_mm;
  for (int i = 0; i < 3; ++i) {
    info.bounds_min_mm[i] = bounds.min_mm[i];
    info.bounds_max_mm[i] = bounds.max_mm[i];
  }
  info.tilt_jitter_deg = o.tilt_jitter_deg;
  info.roll_jitter_deg = o.roll_jitter_deg;
  info.distance_jitter_mm = o.distance_jitter_mm;
  info.samples = o.samples;
  info.gradient_threshold = votes_of(o.gradient_threshold, o.samples);
  info.normal_threshold = votes_of(o.normal_threshold, o.samples);
  info.base_level = camera.base_level;
  info.scan_depth = camera.scan_depth;
  info.depth_count = o.tree_depths;
  info.triangle_count = static_cast<std::int32_t>(part.mesh.triangles.size());
  info.source_unit = static_cast<std::int32_t>(part.unit);
  info.normal_codebook = o.normal_codebook;
  return info;
}

// A stage's own progress as its share of the whole.
TrainProgress share_of(const TrainProgress& progress, double from, double to) {
  if (!progress) return {};
  return [=](double done) { progress(from + (to - from) * done); };
}

}  // namespace

std::vector<std::uint8_t> train_model(const ImportedMesh& part, const TrainOptions& options,
                                      WorkerPool& pool, const TrainProgress& progress) {
  check_options(options);
  require(!part.mesh.triangles.empty(), "the mesh has no triangles");
  const MeshBounds bounds = mesh_bounds(part.mesh);
  const Mesh mesh = centred(part.mesh, (bounds.min_mm + bounds.max_mm) / 2);
  const TemplateCamera camera = make_template_camera(options, bounds);
  const FoundSymmetry symmetry = find_symmetry(
      mesh, bounds.diameter_mm,
      symmetry_tolerance(bounds.diameter_mm, std::sqrt(options.camera.fx * options.camera.fy),
                         camera.reference_distance_mm));
  const PoseTree tree = make_pose_tree(options, symmetry);
  const std::vector<RenderedSample> samples = make_sample_pool(
      mesh, options, tree, camera, sample_pool_size(options), pool, share_of(progress, 0, 0.25));
  const std::vector<ViewSamples> views = make_view_samples(mesh, tree, camera, pool);
  const TemplateSet templates =
      build_templates(tree, samples, camera, options, pool, share_of(progress, 0.3, 1));
  check_features(templates, camera.scan_depth);
  if (progress) progress(1);
  return write_model(make_info(part, bounds, options, camera), tree, templates, views, symmetry);
}

}  // namespace binpick::train
