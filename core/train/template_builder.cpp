#include "train/template_builder.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <mutex>

#include "train/leaf_accumulator.hpp"

namespace binpick::train {
namespace {

// Sums over all children of one parent template, at the parent's resolution.
struct ParentSums {
  HistogramGrid<std::uint32_t> gradient, normal;
  std::uint64_t weight =
      0;  // votes that a bin would hold if every sample and pixel had voted for it

  explicit ParentSums(int cells = 0) : gradient(cells), normal(cells) {}
};

// A pixel becomes a candidate where either modality has a dominant orientation.
struct CandidateTest {
  float scale;  // turns bin contents into frequencies
  float gradient_threshold, normal_threshold;

  CandidateTest(const TrainOptions& options, float scale_in)
      : scale(scale_in),
        gradient_threshold(static_cast<float>(options.gradient_threshold)),
        normal_threshold(static_cast<float>(options.normal_threshold)) {}

  template <class T>
  void append(int x, int y, const T* gradient, const T* normal,
              std::vector<FeatureCandidate>& out) const {
    const FeatureCandidate c{x, y, dominant_orientation(gradient, scale, gradient_threshold),
                             dominant_orientation(normal, scale, normal_threshold)};
    if (c.gradient.bits != 0 || c.normal.bits != 0) out.push_back(c);
  }
};

std::vector<FeatureCandidate> parent_candidates(const ParentSums& sums, const TrainOptions& options,
                                                int step) {
  std::vector<FeatureCandidate> out;
  const float scale = 1.0f / static_cast<float>(sums.weight);
  const CandidateTest test(options, scale);
  const int half = sums.gradient.size / 2;
  for (int y = half % step; y < sums.gradient.size; y += step) {
    for (int x = half % step; x < sums.gradient.size; x += step) {
      test.append(x - half, y - half, sums.gradient.cell(x, y), sums.normal.cell(x, y), out);
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

// One run over a tree. Tasks are the leaves' parents: each makes its own leaves, itself, and its
// share of the depths above.
class Builder {
 public:
  Builder(const PoseTree& tree, const std::vector<RenderedSample>& samples,
          const TemplateCamera& camera, const TrainOptions& options, int thread_count)
      : tree_(tree),
        samples_(samples),
        camera_(camera),
        options_(options),
        blocks_(make_roll_blocks(options, tree.leaves().roll_count)),
        budget_{options.contour_features, options.surface_features},
        leaf_(static_cast<int>(tree.depths.size()) - 1),
        accumulators_(static_cast<std::size_t>(thread_count)),
        sums_(tree.depths.size()) {
    for (int d = 0; d <= leaf_; ++d) {
      const TreeLayer& layer = tree.depths[d];
      set_.depths.emplace_back(layer.viewpoints.size() *
                               static_cast<std::size_t>(layer.roll_count));
      if (d + 2 <= leaf_) {
        sums_[d].assign(set_.depths[d].size(), ParentSums((2 * camera.radius) >> (leaf_ - d)));
      }
    }
  }

  // Templates of one parent of leaves and of all its leaves. Thread-safe.
  void build_family(int p, int thread) {
    auto& accumulator = accumulators_[thread];
    if (!accumulator) {
      accumulator = std::make_unique<LeafAccumulator>(samples_, camera_, options_, blocks_);
    }
    const int leaf_rolls = tree_.leaves().roll_count;
    const TreeLayer& parents = tree_.depths[leaf_ - 1];
    const TreeViewpoint& parent = parents.viewpoints[p];
    std::vector<ParentSums> own(static_cast<std::size_t>(parents.roll_count),
                                ParentSums(camera_.radius));
    for (int v = parent.child_first; v < parent.child_first + parent.child_count; ++v) {
      accumulator->run(v, tree_.leaves().viewpoints[v], leaf_rolls,
                       [&](int roll, const LeafHistograms& h) {
                         set_.depths[leaf_][static_cast<std::size_t>(v * leaf_rolls + roll)] =
                             select_features(leaf_candidates(h, options_), budget_);
                         add_leaf_to_parent(h, own[roll / 2]);
                       });
    }
    for (int roll = 0; roll < parents.roll_count; ++roll) finish(leaf_ - 1, p, roll, own[roll]);
  }

  // The depths above, once all families are built.
  TemplateSet build_ancestors() {
    for (int d = leaf_ - 2; d >= 0; --d) {
      const int rolls = tree_.depths[d].roll_count;
      for (int t = 0; t < static_cast<int>(sums_[d].size()); ++t) {
        finish(d, t / rolls, t % rolls, sums_[d][t]);
      }
    }
    return std::move(set_);
  }

 private:
  // Extracts a template of depth d from its sums and hands the sums up (Algorithm 1).
  void finish(int d, int viewpoint, int roll, const ParentSums& sums) {
    // The rearranged maps of the descent hold a block for every second pixel; the scan reads any.
    const int step = d <= camera_.scan_depth ? 1 : 2;
    const TreeLayer& layer = tree_.depths[d];
    set_.depths[d][static_cast<std::size_t>(viewpoint * layer.roll_count + roll)] =
        select_features(parent_candidates(sums, options_, step), budget_);
    if (d == 0) return;
    const PairSide side = (leaf_ - d) % 2 == 0 ? PairSide::kLower : PairSide::kUpper;
    const int above = layer.viewpoints[viewpoint].parent * (layer.roll_count / 2) + roll / 2;
    const std::lock_guard lock(mutex_);  // integer sums: the order of the tasks does not matter
    add_to_parent(sums, side, sums_[d - 1][above]);
  }

  const PoseTree& tree_;
  const std::vector<RenderedSample>& samples_;
  const TemplateCamera& camera_;
  const TrainOptions& options_;
  RollBlocks blocks_;
  FeatureBudget budget_;
  int leaf_;
  TemplateSet set_;
  std::vector<std::unique_ptr<LeafAccumulator>> accumulators_;  // one per thread
  std::vector<std::vector<ParentSums>> sums_;  // of the depths above the leaves' parents
  std::mutex mutex_;
};

}  // namespace

std::vector<FeatureCandidate> leaf_candidates(const LeafHistograms& h,
                                              const TrainOptions& options) {
  std::vector<FeatureCandidate> out;
  const float scale = 1.0f / static_cast<float>(h.votes);
  const CandidateTest test(options, scale);
  const int half = h.gradient.size / 2;
  for (int y = h.row_first; y < h.row_end; ++y) {
    for (int x = 0; x < h.normal.size; ++x) {
      test.append(2 * x - half, 2 * y - half, h.gradient.cell(2 * x, 2 * y), h.normal.cell(x, y),
                  out);
    }
  }
  return out;
}

TemplateSet build_templates(const PoseTree& tree, const std::vector<RenderedSample>& samples,
                            const TemplateCamera& camera, const TrainOptions& options,
                            WorkerPool& pool, const TrainProgress& progress) {
  Builder builder(tree, samples, camera, options, pool.thread_count());
  const int families = static_cast<int>(tree.depths[tree.depths.size() - 2].viewpoints.size());
  std::atomic<int> done{0};
  pool.parallel_for(families, [&](int p, int thread) {
    builder.build_family(p, thread);
    const int now = ++done;
    // Of the end tells who waits for all threads.
    if (progress && thread == 0 && now < families) progress(static_cast<double>(now) / families);
  });
  return builder.build_ancestors();
}

}  // namespace binpick::train
