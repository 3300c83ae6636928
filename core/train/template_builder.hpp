// Templates of all depths of the pose tree: the leaves from the shared samples, the depths above bottom-up by
// Algorithm 1.
#pragma once

#include <vector>

#include "train/sample_pool.hpp"
#include "train/template_features.hpp"

namespace binpick::train {

// templates[d][viewpoint * roll_count + roll]
struct TemplateSet {
  std::vector<std::vector<std::vector<Feature>>> depths;
};

// How the roll jitter is sampled: the full turn is cut into blocks much finer than the leaves' roll interval; each rendered
// sample is turned once into every block, and a template adds up the blocks inside its own jitter range.
struct RollBlocks {
  int count = 0;             // in a full turn
  int per_roll = 0;          // in one leaf interval; even
  int per_window = 0;        // in a template's jitter range; even, centred on the leaf's roll
  int samples_per_block = 0; // so that a window holds options.samples of them
};
RollBlocks make_roll_blocks(const TrainOptions& options, int leaf_roll_count);

// Size of the sample pool for which every viewpoint finds enough samples within its tilt jitter.
int sample_pool_size(const TrainOptions& options, const RollBlocks& blocks);

TemplateSet build_templates(const PoseTree& tree, const std::vector<RenderedSample>& samples,
                            const TemplateCamera& camera, const TrainOptions& options, WorkerPool& pool,
                            const TrainProgress& progress);

// Histograms of one leaf template, as build_templates makes them; for tests and inspection.
struct LeafHistograms {
  HistogramGrid<std::uint16_t> gradient;  // one cell per pixel; a sample's vote is kVoteUnits
  HistogramGrid<std::uint16_t> normal;    // one cell per 2x2 pixels
  int samples = 0;
};
inline constexpr int kVoteUnits = 3;
std::vector<FeatureCandidate> leaf_candidates(const LeafHistograms& histograms, const TrainOptions& options);

}  // namespace binpick::train
