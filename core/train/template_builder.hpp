// Templates of all depths of the pose tree: the leaves from the shared samples, the depths above
// bottom-up by Algorithm 1.
#pragma once

#include <vector>

#include "train/sample_pool.hpp"
#include "train/template_features.hpp"

namespace binpick::train {

// templates[d][viewpoint * roll_count + roll]
struct TemplateSet {
  std::vector<std::vector<std::vector<Feature>>> depths;
};

// How the roll jitter is sampled: the full turn is cut into blocks of half a leaf's roll interval.
// Each block's histograms are made once, from renderings turned by random angles within it; a
// template adds up the blocks inside its own jitter range, the outermost ones in part.
struct RollBlocks {
  int count = 0;              // in a full turn: two per leaf roll
  int full_per_side = 0;      // blocks on either side of a leaf's roll that count fully
  int full_weight = 0;        // of a block that counts fully
  int outer_weight = 0;       // of the next block on either side, below full_weight; 0: none
  int samples_per_block = 0;  // so that a template holds about options.samples of them
};
RollBlocks make_roll_blocks(const TrainOptions& options, int leaf_roll_count);

// Size of the sample pool for which every viewpoint finds enough different renderings within its
// tilt jitter.
int sample_pool_size(const TrainOptions& options);

TemplateSet build_templates(const PoseTree& tree, const std::vector<RenderedSample>& samples,
                            const TemplateCamera& camera, const TrainOptions& options,
                            WorkerPool& pool, const TrainProgress& progress);

// Histograms of one leaf template.
struct LeafHistograms {
  HistogramGrid<std::uint16_t> gradient;  // one cell per pixel
  HistogramGrid<std::uint16_t> normal;    // one cell per 2x2 pixels
  int row_first = 0, row_end = 0;  // rows of `normal` that hold anything; twice that for `gradient`
  int votes = 0;                   // what a bin would hold if every sample had voted for it
};
std::vector<FeatureCandidate> leaf_candidates(const LeafHistograms& histograms,
                                              const TrainOptions& options);

}  // namespace binpick::train
