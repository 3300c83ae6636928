#include "train/leaf_accumulator.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "binpick/geometry/angle.hpp"
#include "binpick/train/errors.hpp"
#include "train/random.hpp"

namespace binpick::train {
namespace {

// Weight of a block of rolls that counts fully; less where there are many samples. 16 bits have to
// hold the votes of all samples for one bin, and up to 2.7 times as many: several pixels of a
// rendering may fall onto one.
constexpr int kBlockWeightMax = 8;
constexpr int kWeightedSamplesMax = 8000;
// Different renderings that a viewpoint should find within its tilt jitter.
constexpr double kRenderingsPerViewpoint = 80;

// Adds four bins at a time: no bin overflows into its neighbour.
void add_vote(const CellVote& vote, std::uint16_t* bins) {
  std::array<std::uint64_t, 2> sum{}, more{};
  static_assert(sizeof sum == sizeof vote);
  std::memcpy(sum.data(), bins, sizeof sum);
  std::memcpy(more.data(), vote.data(), sizeof more);
  for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += more[k];
  std::memcpy(bins, sum.data(), sizeof sum);
}

// Adds points to the grid's cells; widens [row_first, row_last] to the rows they are in, times
// `rows_each`.
template <class VoteOf>
void add_votes(const TurnedPoints& points, VoteOf&& vote_of, int rows_each,
               HistogramGrid<std::uint16_t>& grid, int& row_first, int& row_last) {
  const auto size = static_cast<unsigned>(grid.size);
  int y_min = grid.size, y_max = -1;
  for (std::size_t i = 0; i < points.x.size(); ++i) {
    const int x = points.x[i], y = points.y[i];
    if (static_cast<unsigned>(x) >= size || static_cast<unsigned>(y) >= size) continue;
    y_min = std::min(y_min, y);
    y_max = std::max(y_max, y);
    add_vote(vote_of(points.vote[i]), grid.cell(x, y));
  }
  if (y_max < 0) return;
  row_first = std::min(row_first, rows_each * y_min);
  row_last = std::max(row_last, rows_each * y_max);
}

// sum = sum of weight * block over rows of `row_bins` bins each.
void add_weighted(const HistogramGrid<std::uint16_t>& block, int weight, std::size_t first,
                  std::size_t end, HistogramGrid<std::uint16_t>& sum) {
  const std::uint16_t* from = block.bins.data();
  std::uint16_t* to = sum.bins.data();
  for (std::size_t i = first; i < end; ++i)
    to[i] = static_cast<std::uint16_t>(to[i] + weight * from[i]);
}

}  // namespace

RollBlocks make_roll_blocks(const TrainOptions& options, int leaf_roll_count) {
  RollBlocks blocks;
  blocks.count = 2 * leaf_roll_count;
  // Less than a block on either side is not resolved.
  const double per_side = std::max(1.0, options.roll_jitter_deg / (360.0 / blocks.count));
  blocks.full_per_side = static_cast<int>(per_side);
  blocks.full_weight = std::clamp(kWeightedSamplesMax / options.samples, 1, kBlockWeightMax);
  blocks.outer_weight =
      static_cast<int>(std::lround((per_side - blocks.full_per_side) * blocks.full_weight));
  blocks.samples_per_block =
      std::max(1, static_cast<int>(std::lround(options.samples / (2 * per_side))));
  return blocks;
}

int sample_pool_size(const TrainOptions& options) {
  const double side = 2 * options.tilt_jitter_deg * kDegree;
  const double share = side * side / (4 * kPi);
  return static_cast<int>(std::clamp(
      std::min<double>(options.samples, kRenderingsPerViewpoint) / share, 200.0, 40000.0));
}

LeafAccumulator::LeafAccumulator(const std::vector<RenderedSample>& samples,
                                 const TemplateCamera& camera, const TrainOptions& options,
                                 const RollBlocks& blocks)
    : samples_(samples),
      options_(options),
      blocks_(blocks),
      radius_(camera.radius),
      tables_(options.normal_codebook) {
  const int size = 2 * radius_;
  ring_.resize(static_cast<std::size_t>(2 * (blocks.full_per_side + 1)));
  for (Block& b : ring_)
    b = {HistogramGrid<std::uint16_t>(size), HistogramGrid<std::uint16_t>(size / 2), 0, 0};
  sums_.gradient = HistogramGrid<std::uint16_t>(size);
  sums_.normal = HistogramGrid<std::uint16_t>(size / 2);
  sums_.votes = 2 * (blocks.full_per_side * blocks.full_weight + blocks.outer_weight) *
                blocks.samples_per_block * kVoteUnits;
}

void LeafAccumulator::run(int leaf_index, const TreeViewpoint& view, int roll_count,
                          const std::function<void(int, const LeafHistograms&)>& visit) {
  near_ = samples_near(view, samples_, options_.tilt_jitter_deg);
  if (near_.empty())
    throw TrainError(
        "no rendering lies within the tilt jitter of a viewpoint: the jitter is too small");
  votes_.clear();
  for (const AlignedSample& near : near_)
    votes_.emplace_back(samples_[static_cast<std::size_t>(near.index)], options_.normal_codebook);
  leaf_index_ = leaf_index;
  // The centre of roll r lies between blocks 2r and 2r + 1.
  int filled = -blocks_.full_per_side;
  for (int roll = 0; roll < roll_count; ++roll) {
    const int end = 2 * roll + 2 + blocks_.full_per_side;
    for (; filled < end; ++filled) fill_block(filled);
    sum_window(roll);
    visit(roll, sums_);
  }
}

LeafAccumulator::Block& LeafAccumulator::slot_of(int block) {
  const int slots = static_cast<int>(ring_.size());
  return ring_[static_cast<std::size_t>(((block % slots) + slots) % slots)];
}

void LeafAccumulator::fill_block(int block) {
  Block& slot = slot_of(block);
  std::fill(slot.gradient.bins.begin(), slot.gradient.bins.end(), std::uint16_t{0});
  std::fill(slot.normal.bins.begin(), slot.normal.bins.end(), std::uint16_t{0});
  slot.row_first = slot.normal.size;
  slot.row_end = 0;
  const int wrapped = (block + blocks_.count) % blocks_.count;
  const std::uint64_t seed = (options_.seed << 40) ^
                             (static_cast<std::uint64_t>(leaf_index_) << 16) ^
                             static_cast<std::uint64_t>(wrapped);
  const int near = static_cast<int>(near_.size());
  // The renderings in turn, but all votes of one while it is in the cache.
  for (int first = 0; first < std::min(near, blocks_.samples_per_block); ++first) {
    const auto pick = static_cast<std::size_t>(
        (static_cast<std::int64_t>(wrapped) * blocks_.samples_per_block + first) % near);
    for (int k = first; k < blocks_.samples_per_block; k += near) {
      // Each sample draws two numbers.
      RandomSequence rng{seed + 2 * static_cast<std::uint64_t>(k) * kSplitmixStep};
      const double roll = (wrapped + rng.uniform()) * 2 * kPi / blocks_.count;
      splat(votes_[pick], near_[pick].turn_rad + static_cast<float>(roll),
            static_cast<int>(rng.next() % kSurfaceStride), slot);
    }
  }
}

void LeafAccumulator::splat(const SampleVotes& votes, float turn_rad, int start, Block& out) {
  int row_first = 2 * radius_, row_last = 0;
  votes.turn_contour(start, turn_rad, static_cast<float>(radius_) + 0.5f, turned_);
  add_votes(
      turned_, [&](int vote) -> const CellVote& { return tables_.contour(vote); }, 1, out.gradient,
      row_first, row_last);
  votes.turn_surface(start, turn_rad, static_cast<float>(radius_) / 2 + 0.5f, turned_);
  add_votes(
      turned_, [&](int vote) -> const CellVote& { return tables_.surface(vote); }, 2, out.normal,
      row_first, row_last);
  out.row_first = std::min(out.row_first, row_first / 2);
  out.row_end = std::max(out.row_end, row_last / 2 + 1);
}

void LeafAccumulator::sum_window(int roll) {
  std::fill(sums_.gradient.bins.begin(), sums_.gradient.bins.end(), std::uint16_t{0});
  std::fill(sums_.normal.bins.begin(), sums_.normal.bins.end(), std::uint16_t{0});
  sums_.row_first = sums_.normal.size;
  sums_.row_end = 0;
  const int reach = blocks_.full_per_side + (blocks_.outer_weight > 0 ? 1 : 0);
  for (int b = 2 * roll + 1 - reach; b < 2 * roll + 1 + reach; ++b) {
    const bool outer =
        b < 2 * roll + 1 - blocks_.full_per_side || b >= 2 * roll + 1 + blocks_.full_per_side;
    const Block& block = slot_of(b);
    const int weight = outer ? blocks_.outer_weight : blocks_.full_weight;
    const std::size_t normal_row = static_cast<std::size_t>(sums_.normal.size) * kOrientationBins;
    const auto first = static_cast<std::size_t>(block.row_first),
               end = static_cast<std::size_t>(std::max(block.row_first, block.row_end));
    add_weighted(block.gradient, weight, 4 * normal_row * first, 4 * normal_row * end,
                 sums_.gradient);
    add_weighted(block.normal, weight, normal_row * first, normal_row * end, sums_.normal);
    sums_.row_first = std::min(sums_.row_first, block.row_first);
    sums_.row_end = std::max(sums_.row_end, block.row_end);
  }
}

}  // namespace binpick::train
