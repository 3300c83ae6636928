#include "train/template_builder.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <numbers>

#include "train/leaf_accumulator.hpp"

namespace binpick::train {
namespace {

// Sums over all children of one parent template, at the parent's resolution.
struct ParentSums {
  HistogramGrid<std::uint32_t> gradient, normal;
  std::uint64_t weight = 0;  // votes that a bin would hold if every sample and pixel had voted for it

  explicit ParentSums(int cells = 0) : gradient(cells), normal(cells) {}
};

std::vector<FeatureCandidate> parent_candidates(const ParentSums& sums, const TrainOptions& options, int step) {
  std::vector<FeatureCandidate> out;
  const float scale = 1.0f / static_cast<float>(sums.weight);
  const float gradient_threshold = static_cast<float>(options.gradient_threshold) / static_cast<float>(options.samples);
  const float normal_threshold = static_cast<float>(options.normal_threshold) / static_cast<float>(options.samples);
  const int half = sums.gradient.size / 2;
  for (int y = half % step; y < sums.gradient.size; y += step) {
    for (int x = half % step; x < sums.gradient.size; x += step) {
      const FeatureCandidate c{x - half, y - half,
                               dominant_orientation(sums.gradient.cell(x, y), scale, gradient_threshold),
                               dominant_orientation(sums.normal.cell(x, y), scale, normal_threshold)};
      if (c.gradient.bits != 0 || c.normal.bits != 0) out.push_back(c);
    }
  }
  return out;
}

// Algorithm 1, the step from the sums of depth d to those of depth d - 1.
void add_to_parent(const ParentSums& child, PairSide side, ParentSums& parent) {
  add_reduced_2x2(child.gradient, side, parent.gradient);
  add_reduced_2x2(child.normal, side, parent.normal);
  parent.weight += 4 * child.weight;
}

// Each leaf pixel votes at full resolution for gradients; normals are held per 2x2 pixels already.
void add_leaf_to_parent(const LeafHistograms& leaf, ParentSums& parent) {
  const int end = std::min(parent.gradient.size, leaf.row_end + 1);
  add_reduced_2x2(leaf.gradient, PairSide::kLower, parent.gradient, leaf.row_first, end);
  add_scaled(leaf.normal, 4, parent.normal, leaf.row_first, leaf.row_end);
  parent.weight += 4 * static_cast<std::uint64_t>(leaf.votes);
}

}  // namespace

std::vector<FeatureCandidate> leaf_candidates(const LeafHistograms& h, const TrainOptions& options) {
  std::vector<FeatureCandidate> out;
  const float scale = 1.0f / static_cast<float>(h.votes);
  const float gradient_threshold = static_cast<float>(options.gradient_threshold) / static_cast<float>(options.samples);
  const float normal_threshold = static_cast<float>(options.normal_threshold) / static_cast<float>(options.samples);
  const int half = h.gradient.size / 2;
  for (int y = h.row_first; y < h.row_end; ++y) {
    for (int x = 0; x < h.normal.size; ++x) {
      const FeatureCandidate c{2 * x - half, 2 * y - half,
                               dominant_orientation(h.gradient.cell(2 * x, 2 * y), scale, gradient_threshold),
                               dominant_orientation(h.normal.cell(x, y), scale, normal_threshold)};
      if (c.gradient.bits != 0 || c.normal.bits != 0) out.push_back(c);
    }
  }
  return out;
}

TemplateSet build_templates(const PoseTree& tree, const std::vector<RenderedSample>& samples,
                            const TemplateCamera& camera, const TrainOptions& options, WorkerPool& pool,
                            const TrainProgress& progress) {
  const int depths = static_cast<int>(tree.depths.size());
  const int leaf = depths - 1;
  const RollBlocks blocks = make_roll_blocks(options, tree.leaves().roll_count);
  const FeatureBudget budget{options.contour_features, options.surface_features};
  TemplateSet set;
  for (const TreeLayer& layer : tree.depths) {
    set.depths.emplace_back(layer.viewpoints.size() * static_cast<std::size_t>(layer.roll_count));
  }
  // sums[d]: of the depths above the leaves' parents; many tasks add to them. Integer sums: no order matters.
  std::vector<std::vector<ParentSums>> sums(static_cast<std::size_t>(depths));
  for (int d = 0; d + 2 < depths; ++d) {
    sums[d].assign(set.depths[d].size(), ParentSums((2 * camera.radius) >> (leaf - d)));
  }
  std::mutex sums_mutex;

  const TreeLayer& parents = tree.depths[leaf - 1];
  const int leaf_rolls = tree.leaves().roll_count, parent_rolls = parents.roll_count;
  std::vector<std::unique_ptr<LeafAccumulator>> accumulators(static_cast<std::size_t>(pool.thread_count()));
  auto side_above = [&](int d) { return (leaf - d) % 2 == 0 ? PairSide::kLower : PairSide::kUpper; };
  // The rearranged maps of the descent hold a block for every second pixel; the scan reads any pixel.
  auto step_at = [&](int d) { return d <= camera.scan_depth ? 1 : 2; };
  int parents_done = 0;
  pool.parallel_for(static_cast<int>(parents.viewpoints.size()), [&](int p, int thread) {
    auto& accumulator = accumulators[thread];
    if (!accumulator) accumulator = std::make_unique<LeafAccumulator>(samples, camera, options, blocks);
    std::vector<ParentSums> own(static_cast<std::size_t>(parent_rolls), ParentSums(camera.radius));
    const TreeViewpoint& parent = parents.viewpoints[p];
    for (int v = parent.child_first; v < parent.child_first + parent.child_count; ++v) {
      accumulator->run(v, tree.leaves().viewpoints[v], leaf_rolls, [&](int roll, const LeafHistograms& h) {
        set.depths[leaf][static_cast<std::size_t>(v) * leaf_rolls + roll] =
            select_features(leaf_candidates(h, options), budget);
        add_leaf_to_parent(h, own[roll / 2]);
      });
    }
    for (int roll = 0; roll < parent_rolls; ++roll) {
      set.depths[leaf - 1][static_cast<std::size_t>(p) * parent_rolls + roll] =
          select_features(parent_candidates(own[roll], options, step_at(leaf - 1)), budget);
    }
    const std::lock_guard lock(sums_mutex);
    if (leaf >= 2) {
      for (int roll = 0; roll < parent_rolls; ++roll) {
        const std::size_t above = static_cast<std::size_t>(parent.parent) * (parent_rolls / 2) + roll / 2;
        add_to_parent(own[roll], side_above(leaf - 1), sums[leaf - 2][above]);
      }
    }
    ++parents_done;
    if (progress) progress(static_cast<double>(parents_done) / static_cast<double>(parents.viewpoints.size()));
  });

  for (int d = leaf - 2; d >= 0; --d) {
    const TreeLayer& layer = tree.depths[d];
    for (std::size_t t = 0; t < sums[d].size(); ++t) {
      set.depths[d][t] = select_features(parent_candidates(sums[d][t], options, step_at(d)), budget);
      if (d == 0) continue;
      const std::size_t v = t / static_cast<std::size_t>(layer.roll_count), roll = t % static_cast<std::size_t>(layer.roll_count);
      const std::size_t above = static_cast<std::size_t>(layer.viewpoints[v].parent) * (layer.roll_count / 2) + roll / 2;
      add_to_parent(sums[d][t], side_above(d), sums[d - 1][above]);
    }
  }
  return set;
}

}  // namespace binpick::train
