#include "train/template_builder.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <numbers>

#include "binpick/train/errors.hpp"

namespace binpick::train {
namespace {

// Normals vary slowly over a surface: of each rendering every 8th pixel votes, for a cell of 2x2 pixels, which
// makes half a vote per sample and cell; each counts double.
constexpr int kSurfaceStride = 8;
constexpr int kSurfaceVote = 2 * kVoteUnits;
// Votes of a block fit into a byte: samples_per_block * kVoteUnits, with room for the scatter.
constexpr int kSamplesPerBlockMax = 64;

struct BlockHistograms {
  HistogramGrid<std::uint8_t> gradient, normal;
};

void add_vote(std::uint8_t& bin, int units) {
  bin = static_cast<std::uint8_t>(std::min(255, bin + units));
}

// Splits `units` between two neighbouring bins in proportion to the fraction.
void add_split_vote(std::uint8_t* bins, int first, int second, float fraction, int units) {
  const int upper = static_cast<int>(fraction * static_cast<float>(units) + 0.5f);
  if (units - upper > 0) add_vote(bins[first], units - upper);
  if (upper > 0) add_vote(bins[second], upper);
}

struct Rng {  // splitmix64: small, seeded per block
  std::uint64_t state;
  std::uint64_t next() {
    std::uint64_t x = (state += 0x9E3779B97F4A7C15ull);
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ull;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBull;
    return x ^ (x >> 31);
  }
  double uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }
};

class LeafAccumulator {
 public:
  LeafAccumulator(const std::vector<RenderedSample>& samples, const TemplateCamera& camera,
                  const TrainOptions& options, const RollBlocks& blocks)
      : samples_(samples), options_(options), blocks_(blocks), radius_(camera.radius) {
    const int size = 2 * radius_;
    for (int b = 0; b < blocks.per_window; ++b) {
      ring_.push_back({HistogramGrid<std::uint8_t>(size), HistogramGrid<std::uint8_t>(size / 2)});
    }
    sums_.gradient = HistogramGrid<std::uint16_t>(size);
    sums_.normal = HistogramGrid<std::uint16_t>(size / 2);
    sums_.samples = blocks.per_window * blocks.samples_per_block;
  }

  // Calls `visit(roll, histograms)` for every roll of a leaf viewpoint.
  template <class Visit>
  void run(int leaf_index, const TreeViewpoint& view, int roll_count, Visit&& visit) {
    near_ = samples_near(view, samples_, options_.tilt_jitter_deg);
    if (near_.empty()) throw TrainError("no rendering lies within the tilt jitter of a viewpoint: the jitter is too small");
    leaf_index_ = leaf_index;
    std::fill(sums_.gradient.bins.begin(), sums_.gradient.bins.end(), std::uint16_t{0});
    std::fill(sums_.normal.bins.begin(), sums_.normal.bins.end(), std::uint16_t{0});
    for (auto& block : ring_) {
      std::fill(block.gradient.bins.begin(), block.gradient.bins.end(), std::uint8_t{0});
      std::fill(block.normal.bins.begin(), block.normal.bins.end(), std::uint8_t{0});
    }
    // The window of roll r covers blocks [first, first + per_window).
    const int offset = blocks_.per_roll / 2 - blocks_.per_window / 2;
    int done = offset;
    for (int roll = 0; roll < roll_count; ++roll) {
      const int end = roll * blocks_.per_roll + offset + blocks_.per_window;
      for (; done < end; ++done) replace_oldest(done);
      visit(roll, sums_);
    }
  }

 private:
  void replace_oldest(int block) {
    BlockHistograms& slot = ring_[static_cast<std::size_t>(((block % blocks_.per_window) + blocks_.per_window) % blocks_.per_window)];
    subtract(slot.gradient, sums_.gradient);
    subtract(slot.normal, sums_.normal);
    std::fill(slot.gradient.bins.begin(), slot.gradient.bins.end(), std::uint8_t{0});
    std::fill(slot.normal.bins.begin(), slot.normal.bins.end(), std::uint8_t{0});
    const int wrapped = ((block % blocks_.count) + blocks_.count) % blocks_.count;
    Rng rng{(options_.seed << 40) ^ (static_cast<std::uint64_t>(leaf_index_) << 16) ^ static_cast<std::uint64_t>(wrapped)};
    for (int k = 0; k < blocks_.samples_per_block; ++k) {
      const std::size_t pick = static_cast<std::size_t>(wrapped * blocks_.samples_per_block + k) % near_.size();
      const double roll = (wrapped + rng.uniform()) * 2 * std::numbers::pi / blocks_.count;
      splat(near_[pick], static_cast<float>(roll), static_cast<int>(rng.next() % kSurfaceStride), slot);
    }
    add(slot.gradient, sums_.gradient);
    add(slot.normal, sums_.normal);
  }

  void splat(const AlignedSample& aligned, float roll_rad, int surface_start, BlockHistograms& out) const {
    const RenderedSample& sample = samples_[static_cast<std::size_t>(aligned.index)];
    const float turn = aligned.turn_rad + roll_rad;
    const float c = std::cos(turn), s = std::sin(turn);
    const float centre = static_cast<float>(radius_) + 0.5f;
    const unsigned size = static_cast<unsigned>(2 * radius_);
    for (const ContourPoint& p : sample.contour) {
      const unsigned x = static_cast<unsigned>(static_cast<int>(c * p.x - s * p.y + centre));
      const unsigned y = static_cast<unsigned>(static_cast<int>(s * p.x + c * p.y + centre));
      if (x >= size || y >= size) continue;
      const float position = (p.angle_rad + turn) * (kOrientationBins / kPi) + 64;
      const int bin = static_cast<int>(position);
      add_split_vote(out.gradient.cell(static_cast<int>(x), static_cast<int>(y)), bin & 7, (bin + 1) & 7,
                     position - static_cast<float>(bin), kVoteUnits);
    }
    const unsigned cells = size / 2;
    const float cell_centre = static_cast<float>(radius_) / 2 + 0.5f;
    for (std::size_t i = static_cast<std::size_t>(surface_start); i < sample.surface.size(); i += kSurfaceStride) {
      const SurfacePoint& p = sample.surface[i];
      const unsigned x = static_cast<unsigned>(static_cast<int>((c * p.x - s * p.y) * 0.5f + cell_centre));
      const unsigned y = static_cast<unsigned>(static_cast<int>((s * p.x + c * p.y) * 0.5f + cell_centre));
      if (x >= cells || y >= cells) continue;
      std::uint8_t* bins = out.normal.cell(static_cast<int>(x), static_cast<int>(y));
      const SoftBins soft = soft_normal_bins(options_.normal_codebook, p.tilt_sin, p.azimuth_rad + turn);
      for (int k = 0; k < soft.count; ++k) {
        const int units = static_cast<int>(soft.weight[k] * kSurfaceVote + 0.5f);
        if (units > 0) add_vote(bins[soft.bin[k]], units);
      }
    }
  }

  static void add(const HistogramGrid<std::uint8_t>& block, HistogramGrid<std::uint16_t>& sum) {
    for (std::size_t i = 0; i < sum.bins.size(); ++i) sum.bins[i] = static_cast<std::uint16_t>(sum.bins[i] + block.bins[i]);
  }
  static void subtract(const HistogramGrid<std::uint8_t>& block, HistogramGrid<std::uint16_t>& sum) {
    for (std::size_t i = 0; i < sum.bins.size(); ++i) sum.bins[i] = static_cast<std::uint16_t>(sum.bins[i] - block.bins[i]);
  }

  const std::vector<RenderedSample>& samples_;
  const TrainOptions& options_;
  RollBlocks blocks_;
  int radius_;
  std::vector<BlockHistograms> ring_;
  LeafHistograms sums_;
  std::vector<AlignedSample> near_;
  int leaf_index_ = 0;
};

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
  add_reduced_2x2(leaf.gradient, PairSide::kLower, parent.gradient);
  add_scaled(leaf.normal, 4, parent.normal);
  parent.weight += 4ull * kVoteUnits * static_cast<std::uint64_t>(leaf.samples);
}

}  // namespace

RollBlocks make_roll_blocks(const TrainOptions& options, int leaf_roll_count) {
  RollBlocks blocks;
  const double interval_deg = 360.0 / leaf_roll_count;
  for (blocks.per_roll = 2;; blocks.per_roll += 2) {
    const double block_deg = interval_deg / blocks.per_roll;
    blocks.per_window = 2 * std::max(1, static_cast<int>(std::lround(options.roll_jitter_deg / block_deg)));
    blocks.samples_per_block = (options.samples + blocks.per_window - 1) / blocks.per_window;
    if (blocks.samples_per_block <= kSamplesPerBlockMax) break;
  }
  blocks.count = blocks.per_roll * leaf_roll_count;
  return blocks;
}

int sample_pool_size(const TrainOptions& options, const RollBlocks& blocks) {
  const double side = 2 * options.tilt_jitter_deg * std::numbers::pi / 180;
  const double share = side * side / (4 * std::numbers::pi);
  return static_cast<int>(std::clamp(1.25 * blocks.samples_per_block / share, 200.0, 40000.0));
}

std::vector<FeatureCandidate> leaf_candidates(const LeafHistograms& h, const TrainOptions& options) {
  std::vector<FeatureCandidate> out;
  const float scale = 1.0f / static_cast<float>(kVoteUnits * h.samples);
  const float gradient_threshold = static_cast<float>(options.gradient_threshold) / static_cast<float>(options.samples);
  const float normal_threshold = static_cast<float>(options.normal_threshold) / static_cast<float>(options.samples);
  const int half = h.gradient.size / 2;
  for (int y = 0; y < h.normal.size; ++y) {
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
