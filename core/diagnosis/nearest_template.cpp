#include "diagnosis/nearest_template.hpp"

#include <algorithm>
#include <cmath>

#include "search/scan.hpp"

namespace binpick {
namespace {

constexpr int kBlock = 4;

struct Node {
  int viewpoint = -1, roll = -1;
};

Node nearest_node(const ObjectModel& model, int depth, const Mat3& R_template) {
  const TreeDepth& d = model.depth(depth);
  Node best;
  double best_trace = -4;
  for (int v = 0; v < static_cast<int>(d.viewpoints.size()); ++v) {
    for (int r = 0; r < d.roll_count; ++r) {
      const double trace = (model.rotation(depth, v, r).transpose() * R_template).trace();
      if (trace <= best_trace) continue;
      best_trace = trace;
      best = {v, r};
    }
  }
  return best;
}

// Among the distances that are searched in this frame; -1: the pose's own is not.
int nearest_distance(const TemplateContext& context, int depth, double distance_mm) {
  const int count = context.model.depth(depth).distance_count;
  int best = -1;
  double best_mm = 1e9;
  for (int k = 0; k < count; ++k) {
    const double away = std::abs(context.model.distance_mm(depth, k) - distance_mm);
    if (away >= best_mm) continue;
    best_mm = away;
    best = context.plan.level[depth][k] < 0 ? -1 : k;
  }
  return best;
}

}  // namespace

std::optional<Candidate> nearest_template(const TemplateContext& context, int depth,
                                          const Pose& T) {
  const Mat3 R_template = rotation_between(Vec3::UnitZ(), T.t_mm.normalized()).transpose() * T.R;
  const int k = nearest_distance(context, depth, T.t_mm.norm());
  if (k < 0) return std::nullopt;
  const Node node = nearest_node(context.model, depth, R_template);
  Candidate c;
  c.model = static_cast<std::uint8_t>(context.model_index);
  c.viewpoint = static_cast<std::int16_t>(node.viewpoint);
  c.roll = static_cast<std::int16_t>(node.roll);
  c.distance = static_cast<std::int16_t>(k);
  c.level = static_cast<std::uint8_t>(context.plan.level[depth][k]);
  const PyramidLevel& level = context.pyramid.level(c.level);
  const Vec2 uv = level.camera.project(T.t_mm);
  // The block of 4x4 pixels around the centre, its first pixel even as the search's blocks.
  const int x = (static_cast<int>(std::lround(uv.x())) - 1) / 2 * 2;
  const int y = (static_cast<int>(std::lround(uv.y())) - 1) / 2 * 2;
  if (x < 0 || y < 0 || x + kBlock > level.width || y + kBlock > level.height) return std::nullopt;

  const TreeDepth& d = context.model.depth(depth);
  const TemplateRange& t =
      d.templates[static_cast<std::size_t>(node.viewpoint * d.roll_count + node.roll)];
  const int scale_q8 = context.plan.scale_q8[depth][k];
  simd::PlacedFeature features[simd::kTemplateFeaturesMax];
  const std::span<const Feature> unplaced = context.model.features(t);
  if (depth == context.model.info().scan_depth) {
    place_scanned(unplaced, scale_q8, level.plain.stride, features);
  } else {
    context.kernels.search.place_features(unplaced.data(), t.count, scale_q8, level.plain.steps(),
                                          features);
  }
  const ScoreScale scale(t.gradient_weight_sum, t.normal_weight_sum);
  const simd::PlacedTemplate placed{features, t.count, t.count, scale};
  const std::ptrdiff_t place = y * level.plain.stride + x;
  simd::BlockScores scores;
  context.kernels.search.match_blocks_plain(level.plain, &place, 1, placed, &scores);
  for (int i = 0; i < kBlock * kBlock; ++i) {
    const std::uint16_t score = scores.pixels[i];
    if (i > 0 && score <= c.score) continue;
    c.score = score;
    c.x = static_cast<std::int16_t>(x + i % kBlock / 2 * 2);
    c.y = static_cast<std::int16_t>(y + i / kBlock / 2 * 2);
    c.best_pixel = static_cast<std::uint8_t>(i / kBlock % 2 * 2 + i % 2);
  }
  return c;
}

}  // namespace binpick
