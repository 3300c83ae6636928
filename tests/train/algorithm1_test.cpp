// Algorithm 1 against a second implementation, which gathers each pixel of each depth straight from
// the leaves, and against one that normalises at every step as the paper writes it.
#include <gtest/gtest.h>

#include <cstdio>

#include "train/leaf_accumulator.hpp"
#include "train/template_builder.hpp"
#include "train/toy_part.hpp"

namespace binpick::train {
namespace {

struct Toy {
  TrainOptions options;
  PoseTree tree;
  TemplateCamera camera;
  std::vector<RenderedSample> samples;
};

Toy make_toy(int depths, double tilt_max_deg, double focal_px) {
  Toy toy;
  TrainOptions& o = toy.options;
  o = toy_options();
  o.tree_depths = depths;
  o.tilt_max_deg = tilt_max_deg;
  o.tilt_jitter_deg = 6;
  o.roll_interval_deg = 360.0 / (1 << depths);  // two rolls at the root
  o.camera.fx = o.camera.fy = focal_px;
  o.samples = 60;
  o.gradient_threshold = 4.0 / 60;
  o.normal_threshold = 0.1;
  o.contour_features = 24;
  o.surface_features = 16;
  toy.tree = make_pose_tree(o);
  Mesh mesh = asymmetric_part();
  const MeshBounds bounds = mesh_bounds(mesh);
  const Vec3 centre = (bounds.min_mm + bounds.max_mm) / 2;
  for (auto& v : mesh.vertices_mm) v -= centre.cast<float>();
  toy.camera = make_template_camera(o, bounds);
  SerialPool pool;
  toy.samples = make_sample_pool(mesh, o, toy.tree, toy.camera, 2000, pool, {});
  return toy;
}

// The histograms of every leaf template, in order.
std::vector<LeafHistograms> leaves_of(const Toy& toy) {
  const int rolls = toy.tree.leaves().roll_count;
  std::vector<LeafHistograms> out;
  LeafAccumulator accumulator(toy.samples, toy.camera, toy.options,
                              make_roll_blocks(toy.options, rolls));
  for (int v = 0; v < static_cast<int>(toy.tree.leaves().viewpoints.size()); ++v) {
    accumulator.run(v, toy.tree.leaves().viewpoints[v], rolls,
                    [&](int, const LeafHistograms& h) { out.push_back(h); });
  }
  return out;
}

// Index of the template at depth d above each leaf template.
std::vector<std::size_t> ancestors(const PoseTree& tree, int d) {
  const int leaf = static_cast<int>(tree.depths.size()) - 1, rolls = tree.leaves().roll_count;
  std::vector<std::size_t> out;
  for (int v = 0; v < static_cast<int>(tree.leaves().viewpoints.size()); ++v) {
    int view = v;
    for (int at = leaf; at > d; --at) view = tree.depths[at].viewpoints[view].parent;
    for (int r = 0; r < rolls; ++r) {
      const int roll = r >> (leaf - d);
      out.push_back(static_cast<std::size_t>(view * tree.depths[d].roll_count + roll));
    }
  }
  return out;
}

using Histogram = std::array<double, kOrientationBins>;

// Sum over the cells [first, first + side) in x and y of a leaf's grid.
Histogram box_sum(const HistogramGrid<std::uint16_t>& grid, int first_x, int first_y, int side) {
  Histogram sum{};
  for (int y = std::max(0, first_y); y < std::min(grid.size, first_y + side); ++y) {
    for (int x = std::max(0, first_x); x < std::min(grid.size, first_x + side); ++x) {
      for (int b = 0; b < kOrientationBins; ++b) sum[b] += grid.cell(x, y)[b];
    }
  }
  return sum;
}

// A pixel of depth leaf - k stands for 2^k pixels of the leaf; this is how far the first of them
// lies before 2^k times its offset. Pairs are taken on the lower side at every second depth, from
// the leaves' parents on: -1, then as they are, then another 4. Normals start at pairs of pixels.
constexpr int kBefore[] = {0, 1, 1, 5};
constexpr int kNormalBefore[] = {0, 0, 0, 2};

struct Cell {
  Histogram gradient{}, normal{};
};

// What a template at depth leaf - k, k >= 1, holds at offset (x, y), over these leaves.
Cell gather(const std::vector<const LeafHistograms*>& leaves, int k, int x, int y) {
  Cell out;
  for (const LeafHistograms* h : leaves) {
    const int scale = 1 << k, half = h->gradient.size / 2, normal_half = h->normal.size / 2;
    const Histogram g =
        box_sum(h->gradient, half + scale * x - kBefore[k], half + scale * y - kBefore[k], scale);
    const Histogram n = box_sum(h->normal, normal_half + scale / 2 * x - kNormalBefore[k],
                                normal_half + scale / 2 * y - kNormalBefore[k], scale / 2);
    for (int b = 0; b < kOrientationBins; ++b) {
      out.gradient[b] += g[b];
      out.normal[b] += 4 * n[b];
    }
  }
  return out;
}

std::vector<FeatureCandidate> gathered_candidates(const Toy& toy,
                                                  const std::vector<const LeafHistograms*>& leaves,
                                                  int d) {
  const int k = static_cast<int>(toy.tree.depths.size()) - 1 - d;
  const int half = toy.camera.radius >> k;
  const double votes = static_cast<double>(leaves.size()) * leaves[0]->votes * (1 << (2 * k));
  const float scale = 1.0f / static_cast<float>(votes);
  const auto gradient_threshold = static_cast<float>(toy.options.gradient_threshold);
  const auto normal_threshold = static_cast<float>(toy.options.normal_threshold);
  const bool scanned = d <= toy.camera.scan_depth;
  std::vector<FeatureCandidate> out;
  for (int y = -half; y < half; ++y) {
    for (int x = -half; x < half; ++x) {
      if (!scanned && (x % 2 != 0 || y % 2 != 0)) continue;
      const Cell cell = gather(leaves, k, x, y);
      out.push_back({x, y, dominant_orientation(cell.gradient.data(), scale, gradient_threshold),
                     dominant_orientation(cell.normal.data(), scale, normal_threshold)});
    }
  }
  return out;
}

void expect_same(const std::vector<Feature>& a, const std::vector<Feature>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].x, b[i].x);
    ASSERT_EQ(a[i].y, b[i].y);
    ASSERT_EQ(a[i].gradient_bits, b[i].gradient_bits);
    ASSERT_EQ(a[i].gradient_weight, b[i].gradient_weight);
    ASSERT_EQ(a[i].normal_bits, b[i].normal_bits);
    ASSERT_EQ(a[i].normal_weight, b[i].normal_weight);
  }
}

class Algorithm1 : public testing::TestWithParam<int> {};

TEST_P(Algorithm1, GivesWhatGatheringFromTheLeavesGives) {
  const Toy toy = make_toy(GetParam(), 6, 500);
  SerialPool pool;
  const TemplateSet set = build_templates(toy.tree, toy.samples, toy.camera, toy.options, pool, {});
  const std::vector<LeafHistograms> leaves = leaves_of(toy);
  const FeatureBudget budget{toy.options.contour_features, toy.options.surface_features};
  const int leaf = GetParam() - 1;
  for (std::size_t t = 0; t < leaves.size(); ++t) {
    expect_same(set.depths[leaf].at(t),
                select_features(leaf_candidates(leaves[t], toy.options), budget));
  }
  std::size_t features = 0;
  for (int d = 0; d < leaf; ++d) {
    std::vector<std::vector<const LeafHistograms*>> below(set.depths[d].size());
    const std::vector<std::size_t> above = ancestors(toy.tree, d);
    for (std::size_t t = 0; t < leaves.size(); ++t) below.at(above[t]).push_back(&leaves[t]);
    for (std::size_t t = 0; t < below.size(); ++t) {
      ASSERT_FALSE(below[t].empty());
      SCOPED_TRACE("depth " + std::to_string(d) + ", template " + std::to_string(t));
      expect_same(set.depths[d][t], select_features(gathered_candidates(toy, below[t], d), budget));
      features += set.depths[d][t].size();
    }
  }
  EXPECT_GT(features, 20u);
}

INSTANTIATE_TEST_SUITE_P(Depths, Algorithm1, testing::Values(2, 3, 4));

// One step as the paper writes it: mean over the children, then mean over 2x2 pixels.
std::vector<double> step(const std::vector<const std::vector<double>*>& children, int size,
                         bool lower) {
  const int half = size / 2;
  std::vector<double> out(static_cast<std::size_t>(half) * half * kOrientationBins, 0);
  const double share = 0.25 / static_cast<double>(children.size());
  for (int y = lower ? -1 : 0; y + (lower ? 1 : 0) < size; ++y) {
    for (int x = lower ? -1 : 0; x + (lower ? 1 : 0) < size; ++x) {
      if (x < 0 || y < 0) continue;
      const int cx = (x + (lower ? 1 : 0)) / 2, cy = (y + (lower ? 1 : 0)) / 2;
      if (cx >= half || cy >= half) continue;
      for (const std::vector<double>* child : children) {
        for (int b = 0; b < kOrientationBins; ++b) {
          out[static_cast<std::size_t>((cy * half + cx) * kOrientationBins + b)] +=
              share * (*child)[static_cast<std::size_t>((y * size + x) * kOrientationBins + b)];
        }
      }
    }
  }
  return out;
}

TEST(Algorithm1Steps, AgreeWithNormalisingAtEveryStep) {
  // Sums weigh every leaf the same, means of means every child: they differ where siblings have
  // different numbers of children.
  const Toy toy = make_toy(3, 180, 200);
  const std::vector<LeafHistograms> leaves = leaves_of(toy);
  std::vector<std::vector<double>> means;
  for (const LeafHistograms& h : leaves) {
    means.emplace_back(h.gradient.bins.begin(), h.gradient.bins.end());
    for (double& m : means.back()) m /= h.votes;
  }
  const double threshold = toy.options.gradient_threshold;
  int size = 2 * toy.camera.radius;
  for (int d = 1; d >= 0; --d, size /= 2) {
    const TreeLayer& layer = toy.tree.depths[d];
    const int child_rolls = 2 * layer.roll_count;
    std::vector<std::vector<double>> above;
    for (const TreeViewpoint& view : layer.viewpoints) {
      for (int r = 0; r < layer.roll_count; ++r) {
        std::vector<const std::vector<double>*> children;
        for (int c = view.child_first; c < view.child_first + view.child_count; ++c) {
          children.push_back(&means[static_cast<std::size_t>(c * child_rolls + 2 * r)]);
          children.push_back(&means[static_cast<std::size_t>(c * child_rolls + 2 * r + 1)]);
        }
        above.push_back(step(children, size, d == 1));
      }
    }
    means = std::move(above);
    std::vector<std::vector<const LeafHistograms*>> below(means.size());
    const std::vector<std::size_t> at = ancestors(toy.tree, d);
    for (std::size_t t = 0; t < leaves.size(); ++t) below[at[t]].push_back(&leaves[t]);
    int bits = 0, equal = 0;
    const int half = size / 2, k = 2 - d;
    for (std::size_t t = 0; t < means.size(); ++t) {
      const double votes = static_cast<double>(below[t].size()) * leaves[0].votes * (1 << (2 * k));
      for (int i = 0; i < half * half; ++i) {
        const Cell cell = gather(below[t], k, i % half - half / 2, i / half - half / 2);
        for (int b = 0; b < kOrientationBins; ++b) {
          const bool stepwise =
              means[t][static_cast<std::size_t>(i * kOrientationBins + b)] > threshold;
          const bool summed = cell.gradient[static_cast<std::size_t>(b)] / votes > threshold;
          bits += stepwise || summed;
          equal += stepwise && summed;
        }
      }
    }
    std::printf("depth %d: %d of %d orientation bits as when normalised at each step\n", d, equal,
                bits);
    EXPECT_GT(bits, 0);
    EXPECT_GE(equal, 0.9 * bits);
  }
}

}  // namespace
}  // namespace binpick::train
