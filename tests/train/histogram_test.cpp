// From votes to templates, worked by hand: soft votes, thresholds, 2x2 reduction, choice of
// features.
#include "train/histogram.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>

#include "binpick/geometry/angle.hpp"
#include "train/leaf_accumulator.hpp"
#include "train/template_features.hpp"
#include "train/toy_part.hpp"

namespace binpick::train {
namespace {

using Bins = std::array<std::uint32_t, kOrientationBins>;

TEST(DominantOrientation, TakesEveryBinAboveTheThresholdAndTheLargestAsWeight) {
  const Bins bins{0, 101, 300, 99, 0, 0, 150, 0};
  const DominantOrientation d = dominant_orientation(bins.data(), 0.001f, 0.1f);
  EXPECT_EQ(d.bits, (1 << 1) | (1 << 2) | (1 << 6));
  EXPECT_FLOAT_EQ(d.frequency, 0.3f);
}

TEST(DominantOrientation, IsNoneWhereTheVotesAreSpread) {
  const Bins corner{90, 80, 95, 70, 60, 85, 99, 10};
  const DominantOrientation d = dominant_orientation(corner.data(), 0.001f, 0.1f);
  EXPECT_EQ(d.bits, 0);
  EXPECT_EQ(d.frequency, 0);
}

TEST(DominantOrientation, HasToBeLargerThanTheThreshold) {
  // In quarters, which floating point holds exactly.
  const Bins bins{1, 2, 3, 0, 0, 0, 0, 0};
  const DominantOrientation d = dominant_orientation(bins.data(), 0.25f, 0.5f);
  EXPECT_EQ(d.bits, 1 << 2);
  EXPECT_EQ(dominant_orientation(bins.data(), 0.25f, 0.75f).bits, 0);
  EXPECT_EQ(dominant_orientation(bins.data(), 0.25f, 0.0f).bits, 0b111);
}

TEST(SoftVotes, SplitAGradientBetweenTheTwoNearestBins) {
  const float bin = kPi / kOrientationBins;
  const SoftBins quarter = soft_gradient_bins(2.25f * bin);
  ASSERT_EQ(quarter.count, 2);
  EXPECT_EQ(quarter.bin[0], 2);
  EXPECT_EQ(quarter.bin[1], 3);
  EXPECT_NEAR(quarter.weight[0], 0.75f, 1e-5f);
  EXPECT_NEAR(quarter.weight[1], 0.25f, 1e-5f);
  // The other side of an edge, 180 degrees away, is the same orientation; bin 7 borders on bin 0.
  const SoftBins last = soft_gradient_bins(-0.5f * bin);
  EXPECT_EQ(last.bin[0], 7);
  EXPECT_EQ(last.bin[1], 0);
  EXPECT_NEAR(last.weight[0], 0.5f, 1e-5f);
}

// One rendering, seen exactly from the viewpoint that the accumulator is asked for.
RenderedSample sample_from_the_front() {
  RenderedSample s;
  s.direction_obj = -Vec3::UnitZ();
  s.R_view_obj = Mat3::Identity();
  s.distance_mm = 600;
  return s;
}

// Histograms of one leaf roll of `rolls`, from these renderings of one viewpoint.
LeafHistograms accumulate(const std::vector<RenderedSample>& samples, const TrainOptions& options,
                          int rolls, int roll) {
  TreeViewpoint view;
  view.direction_obj = samples[0].direction_obj;
  view.R_view_obj = samples[0].R_view_obj;
  TemplateCamera camera;
  camera.radius = 16;
  LeafAccumulator accumulator(samples, camera, options, make_roll_blocks(options, rolls));
  LeafHistograms out;
  accumulator.run(0, view, rolls, [&](int r, const LeafHistograms& h) {
    if (r == roll) out = h;
  });
  return out;
}

double frequency(const LeafHistograms& h, const std::uint16_t* bins, int bin) {
  return static_cast<double>(bins[bin]) / h.votes;
}

int votes_of(const std::uint16_t* bins) {
  return std::accumulate(bins, bins + kOrientationBins, 0);
}

TEST(LeafAccumulator, SpreadsAnEdgeOverTheBinsThatItsRollJitterReaches) {
  const TrainOptions options = toy_options();
  const int rolls = 64, roll = 13;
  RenderedSample sample = sample_from_the_front();
  // At the centre, where a roll does not move it; in the middle of bin 5 at the roll's own angle.
  // Twice, because of two neighbours one votes for both.
  const double bin = kPi / kOrientationBins;
  const auto angle = static_cast<float>(5 * bin - roll_centre_rad(roll, rolls));
  sample.contour.assign(2, {0, 0, angle});
  const LeafHistograms h = accumulate({sample}, options, rolls, roll);
  const std::uint16_t* bins = h.gradient.cell(16, 16);
  // Angles spread evenly over +-7.5 degrees of bins 22.5 degrees apart are on average 3.75 degrees
  // off, a sixth of a bin.
  EXPECT_NEAR(frequency(h, bins, 5) / 2, 5.0 / 6, 0.02);
  EXPECT_NEAR(frequency(h, bins, 4) / 2, 1.0 / 12, 0.02);
  EXPECT_NEAR(frequency(h, bins, 6) / 2, 1.0 / 12, 0.02);
  EXPECT_EQ(votes_of(bins), 2 * h.votes);
  EXPECT_EQ(std::accumulate(h.gradient.bins.begin(), h.gradient.bins.end(), 0), 2 * h.votes);
}

TEST(LeafAccumulator, TurnsAPointWithTheRoll) {
  const TrainOptions options = toy_options();
  const int rolls = 64;
  for (const int roll : {0, 15, 37, 63}) {
    RenderedSample sample = sample_from_the_front();
    sample.contour.push_back({11, 0, 0});
    const LeafHistograms h = accumulate({sample}, options, rolls, roll);
    Vec2 mean = Vec2::Zero();
    double votes = 0;
    for (int y = 0; y < h.gradient.size; ++y) {
      for (int x = 0; x < h.gradient.size; ++x) {
        const double here = votes_of(h.gradient.cell(x, y));
        mean += here * Vec2(x - 16, y - 16);
        votes += here;
      }
    }
    const double turn = roll_centre_rad(roll, rolls);
    EXPECT_LT((mean / votes - 11 * Vec2(std::cos(turn), std::sin(turn))).norm(), 0.3);
    EXPECT_NEAR(votes / h.votes, 1, 0.1);
  }
}

// Renderings of a surface that faces the camera and fills the template, thinned as a pool is.
std::vector<RenderedSample> facing_plane() {
  std::vector<RenderedSample> samples(kPooledSurfaceStride, sample_from_the_front());
  for (int y = -16; y < 16; ++y) {
    for (int x = -16; x < 16; ++x) {
      RenderedSample& sample = samples[static_cast<std::size_t>(x - y + 32) % samples.size()];
      sample.surface.push_back({static_cast<float>(x), static_cast<float>(y), 0.05f, 1.0f});
    }
  }
  return samples;
}

TEST(LeafAccumulator, CountsASurfaceOncePerSample) {
  TrainOptions options = toy_options();
  for (const int samples : {10, 1000, 2500}) {
    options.samples = samples;
    const LeafHistograms h = accumulate(facing_plane(), options, 64, 20);
    double sum = 0;
    int cells = 0;
    for (int y = 0; y < h.normal.size; ++y) {
      for (int x = 0; x < h.normal.size; ++x) {
        if (std::hypot(x - 8, y - 8) > 6) continue;
        sum += frequency(h, h.normal.cell(x, y), 0);
        ++cells;
      }
    }
    EXPECT_NEAR(sum / cells, 1, samples < 100 ? 0.2 : 0.03) << samples << " samples";
  }
}

TEST(LeafAccumulator, HoldsEveryVoteOfAnyAllowedOptions) {
  TrainOptions options = toy_options();
  for (const int samples : {1000, 2500}) {
    options.samples = samples;
    for (const double roll_jitter_deg : {0.1, 1.0, 2.5, 7.5, 30.0, 90.0}) {
      options.roll_jitter_deg = roll_jitter_deg;
      SCOPED_TRACE(std::to_string(samples) + " samples, roll jitter " +
                   std::to_string(roll_jitter_deg));
      const RollBlocks blocks = make_roll_blocks(options, 64);
      const int kept = 2 * (blocks.full_per_side + (blocks.outer_weight > 0 ? 1 : 0));
      EXPECT_LT(kept * blocks.samples_per_block, 2 * options.samples);
      const LeafHistograms h = accumulate(facing_plane(), options, 64, 20);
      // All votes of a bin, and what they may come to where pixels fall onto one another.
      EXPECT_LT(2.5 * h.votes, 65535);
      double least = 2, most = 0;
      for (int y = 5; y < 11; ++y) {
        for (int x = 5; x < 11; ++x) {
          least = std::min(least, frequency(h, h.normal.cell(x, y), 0));
          most = std::max(most, frequency(h, h.normal.cell(x, y), 0));
        }
      }
      EXPECT_GT(least, 0.7);
      EXPECT_LT(most, 1.3);
    }
  }
}

HistogramGrid<std::uint16_t> counting_grid(int size) {
  HistogramGrid<std::uint16_t> grid(size);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      grid.cell(x, y)[3] = static_cast<std::uint16_t>(1 + x + size * y);
      grid.cell(x, y)[7] = 1;
    }
  }
  return grid;
}

TEST(Reduction, SumsTheUpperPairs) {
  HistogramGrid<std::uint32_t> coarse(2);
  add_reduced_2x2(counting_grid(4), PairSide::kUpper, coarse);
  // Rows of the fine grid: 1 2 3 4 / 5 6 7 8 / 9 10 11 12 / 13 14 15 16.
  EXPECT_EQ(coarse.cell(0, 0)[3], 1u + 2 + 5 + 6);
  EXPECT_EQ(coarse.cell(1, 0)[3], 3u + 4 + 7 + 8);
  EXPECT_EQ(coarse.cell(0, 1)[3], 9u + 10 + 13 + 14);
  EXPECT_EQ(coarse.cell(1, 1)[3], 11u + 12 + 15 + 16);
  EXPECT_EQ(coarse.cell(1, 1)[7], 4u);
  EXPECT_EQ(coarse.cell(1, 1)[0], 0u);
}

TEST(Reduction, SumsTheLowerPairsAndTakesWhatLiesOutsideForEmpty) {
  HistogramGrid<std::uint32_t> coarse(2);
  add_reduced_2x2(counting_grid(4), PairSide::kLower, coarse);
  EXPECT_EQ(coarse.cell(0, 0)[3], 1u);
  EXPECT_EQ(coarse.cell(1, 0)[3], 2u + 3);
  EXPECT_EQ(coarse.cell(0, 1)[3], 5u + 9);
  EXPECT_EQ(coarse.cell(1, 1)[3], 6u + 7 + 10 + 11);
  EXPECT_EQ(coarse.cell(0, 0)[7], 1u);
  EXPECT_EQ(coarse.cell(1, 1)[7], 4u);
}

TEST(Reduction, AddsToWhatIsThereAndOnlyInItsRows) {
  HistogramGrid<std::uint32_t> coarse(2);
  const auto fine = counting_grid(4);
  add_reduced_2x2(fine, PairSide::kUpper, coarse);
  add_reduced_2x2(fine, PairSide::kUpper, coarse, 1, 2);
  EXPECT_EQ(coarse.cell(0, 0)[3], 14u);
  EXPECT_EQ(coarse.cell(0, 1)[3], 2 * 46u);
  add_scaled(coarse, 3, coarse, 0, 1);
  EXPECT_EQ(coarse.cell(0, 0)[3], 4 * 14u);
  EXPECT_EQ(coarse.cell(0, 1)[3], 2 * 46u);
}

FeatureCandidate contour_at(int x, int y, float weight) {
  return {x, y, {0b100, weight}, {}};
}
FeatureCandidate surface_at(int x, int y, float weight) {
  return {x, y, {}, {0b10, weight}};
}

TEST(FeatureSelection, KeepsBothBudgetsApart) {
  std::vector<FeatureCandidate> candidates;
  for (int i = 0; i < 30; ++i) {
    candidates.push_back(contour_at(2 * i, 0, 0.5f));
    candidates.push_back(surface_at(2 * i, 20, 0.9f));
  }
  candidates.push_back({0, 40, {0b1, 0.7f}, {0b1000, 0.8f}});  // both: counts as contour
  const auto features = select_features(candidates, {12, 7});
  ASSERT_EQ(features.size(), 19u);
  EXPECT_EQ(std::ranges::count_if(features, [](const Feature& f) { return f.gradient_bits != 0; }),
            12);
  EXPECT_EQ(features[0].y, 40);
  EXPECT_EQ(features[0].gradient_bits, 0b1);
  EXPECT_EQ(features[0].normal_bits, 0b1000);
}

TEST(FeatureSelection, TakesAllWhereThereAreFewerThanTheBudget) {
  const auto features = select_features(
      {contour_at(0, 0, 0.2f), contour_at(2, 0, 0.4f), surface_at(0, 2, 0.3f), {4, 4, {}, {}}},
      {56, 40});
  EXPECT_EQ(features.size(), 3u);
  EXPECT_TRUE(select_features({}, {56, 40}).empty());
  EXPECT_TRUE(select_features({contour_at(0, 0, 0.5f)}, {0, 40}).empty());
}

TEST(FeatureSelection, PutsTheStrongestFirstAndKeepsTheRestApart) {
  std::vector<FeatureCandidate> candidates;
  for (int y = 0; y < 8; y += 2) {
    for (int x = 0; x < 8; x += 2)
      candidates.push_back(contour_at(x, y, x == 6 && y == 6 ? 1 : 0.9f));
  }
  for (const int x : {-60, -30, 30, 60}) candidates.push_back(contour_at(x, 0, 0.3f));
  // 20 candidates stand for 80 px, 16 for each of five: 1.2 times their root is a distance of 4 px.
  const auto features = select_features(candidates, {5, 0});
  ASSERT_EQ(features.size(), 5u);
  const std::array<int, 2> expected[] = {{6, 6}, {0, 0}, {4, 0}, {0, 4}, {-60, 0}};
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(features[i].x, expected[i][0]);
    EXPECT_EQ(features[i].y, expected[i][1]);
  }
}

TEST(FeatureSelection, DoesNotDependOnTheOrderOfTheCandidates) {
  std::mt19937_64 engine(3);
  std::vector<FeatureCandidate> candidates;
  for (int y = -20; y < 20; y += 2) {
    for (int x = -20; x < 20; x += 2) {
      const auto weight = static_cast<float>(engine() % 8) / 8.0f;  // many ties
      candidates.push_back(engine() % 3 == 0 ? contour_at(x, y, weight) : surface_at(x, y, weight));
    }
  }
  const auto first = select_features(candidates, {40, 30});
  std::ranges::shuffle(candidates, engine);
  const auto second = select_features(candidates, {40, 30});
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].x, second[i].x);
    EXPECT_EQ(first[i].y, second[i].y);
    EXPECT_EQ(first[i].gradient_weight, second[i].gradient_weight);
  }
}

TEST(FeatureSelection, QuantizesWeightsTo1To31) {
  const auto features =
      select_features({contour_at(0, 0, 0.001f), contour_at(20, 0, 0.5f), contour_at(40, 0, 1.0f),
                       contour_at(60, 0, 1.7f), surface_at(80, 0, 0.2f)},
                      {8, 8});
  ASSERT_EQ(features.size(), 5u);
  const int expected[] = {31, 31, 16, 1};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(features[i].gradient_weight, expected[i]);
    EXPECT_EQ(features[i].normal_weight, 0);
    EXPECT_EQ(features[i].normal_bits, 0);
  }
  EXPECT_EQ(features[4].normal_weight, 6);
  EXPECT_EQ(features[4].gradient_weight, 0);
}

}  // namespace
}  // namespace binpick::train
