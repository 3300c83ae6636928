// Orientation histograms of the leaf templates of one viewpoint (paper section III-A), for all its
// rolls in turn. One per thread.
#pragma once

#include <functional>
#include <vector>

#include "train/sample_pool.hpp"
#include "train/sample_votes.hpp"
#include "train/template_builder.hpp"

namespace binpick::train {

class LeafAccumulator {
 public:
  LeafAccumulator(const std::vector<RenderedSample>& samples, const TemplateCamera& camera,
                  const TrainOptions& options, const RollBlocks& blocks);

  // Calls visit(roll, histograms) for every roll of the leaf viewpoint; the histograms are valid
  // during the call.
  void run(int leaf_index, const TreeViewpoint& view, int roll_count,
           const std::function<void(int, const LeafHistograms&)>& visit);

 private:
  struct Block {
    HistogramGrid<std::uint16_t> gradient, normal;
    int row_first = 0, row_end = 0;  // of `normal`, as in LeafHistograms
  };

  Block& slot_of(int block);
  void fill_block(int block);
  void splat(const SampleVotes& votes, float turn_rad, int start, Block& out);
  void sum_window(int roll);

  const std::vector<RenderedSample>& samples_;
  const TrainOptions& options_;
  RollBlocks blocks_;
  int radius_;
  std::vector<Block> ring_;
  LeafHistograms sums_;
  VoteTables tables_;
  std::vector<AlignedSample> near_;
  std::vector<SampleVotes> votes_;  // of the renderings in near_
  TurnedPoints turned_;
  int leaf_index_ = 0;
};

}  // namespace binpick::train
