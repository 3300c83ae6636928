#include "search/scan.hpp"

#include <algorithm>

#include "binpick/base/arena_plan.hpp"
#include "search/distance_gate.hpp"
#include "search/matched_features.hpp"

namespace binpick {
namespace {

int row_stride(const ScanLimits& limits) {
  return static_cast<int>((limits.width_max + simd::kReadAhead + 63) / 64 * 64);
}

}  // namespace

template <class Source>
Scanner::Buffers Scanner::take(const ScanLimits& limits, Source& source) {
  const auto rows = static_cast<std::size_t>(row_stride(limits)) * 2 *
                    static_cast<std::size_t>(limits.thread_count);
  const auto cells =
      static_cast<std::size_t>((limits.width_max / 2 + 1) * (limits.height_max / 2 + 1));
  Buffers b;
  b.templates = source.template take<Template>(static_cast<std::size_t>(limits.templates_max));
  b.features =
      source.template take<simd::ScanFeature>(static_cast<std::size_t>(limits.features_max));
  b.cells = source.template take<CellEntry>(cells * kViewpointsPerCell);
  b.best_rolls = source.template take<CellEntry>(rows / 4);
  b.sums = source.template take<std::uint16_t>(rows);
  b.scores = source.template take<std::uint16_t>(rows);
  return b;
}

std::size_t Scanner::footprint(const ScanLimits& limits) {
  ArenaPlan plan;
  take(limits, plan);
  return plan.bytes;
}

Scanner::Scanner(const ScanLimits& limits, Arena& arena)
    : row_stride_(row_stride(limits)), buffers_(take(limits, arena)) {}

void Scanner::load_templates(const ObjectModel& model, int distance_index, const ScalePlan& plan,
                             const FeaturePyramid& pyramid, std::ptrdiff_t stride) {
  const int d = model.info().scan_depth;
  const TreeDepth& depth = model.depth(d);
  const int scale = plan.scale_q8[d][distance_index];
  template_count_ = static_cast<int>(depth.templates.size());
  int used = 0;
  for (int t = 0; t < template_count_; ++t) {
    const TemplateRange& range = depth.templates[static_cast<std::size_t>(t)];
    Template& to = buffers_.templates[static_cast<std::size_t>(t)];
    const auto features = matched_features(model, range, pyramid);
    to = {used, static_cast<int>(features.size()),
          ScoreScale(range.gradient_weight_sum, range.normal_weight_sum),
          static_cast<std::int16_t>(t / depth.roll_count),
          static_cast<std::int16_t>(t % depth.roll_count)};
    for (const Feature& f : features) {
      const std::ptrdiff_t x = (f.x * scale + 128) >> 8, y = (f.y * scale + 128) >> 8;
      buffers_.features[static_cast<std::size_t>(used++)] = {
          static_cast<std::int32_t>(y * stride + x), f.gradient_bits, f.gradient_weight,
          f.normal_bits, f.normal_weight};
    }
  }
}

void Scanner::insert(CellEntry* cell, CellEntry entry) const {
  // Best first; of equal scores the earlier template stays ahead.
  int at = kViewpointsPerCell - 1;
  while (at > 0 && cell[at - 1].score < entry.score) {
    cell[at] = cell[at - 1];
    --at;
  }
  cell[at] = entry;
}

Scanner::CellSpan Scanner::open_cells(int cell_y, const PyramidLevel& level,
                                      const DistanceGate& gate, int depth,
                                      int distance_index) const {
  const auto open = [&](int c) {
    return gate.allows(level, 2 * c, 2 * cell_y, depth, distance_index);
  };
  CellSpan span{0, columns_};
  while (span.first < span.end && !open(span.first)) ++span.first;
  while (span.first < span.end && !open(span.end - 1)) --span.end;
  return span;
}

void Scanner::scan_cell_row(int cell_y, CellSpan span, const PyramidLevel& level,
                            const simd::KernelTable& kernels, int threshold, int thread) {
  std::uint16_t* gradient =
      buffers_.sums.data() + static_cast<std::ptrdiff_t>(thread) * 2 * row_stride_;
  std::uint16_t* normal = gradient + row_stride_;
  std::uint16_t* scores =
      buffers_.scores.data() + static_cast<std::ptrdiff_t>(thread) * 2 * row_stride_;
  CellEntry* row =
      buffers_.cells.data() + static_cast<std::ptrdiff_t>(cell_y) * columns_ * kViewpointsPerCell;
  const CellEntry none{static_cast<std::uint16_t>(threshold - 1), 0, 0};
  std::fill_n(row, columns_ * kViewpointsPerCell, none);
  if (span.first >= span.end) return;
  const int x_first = 2 * span.first, count = span.end - span.first;
  CellEntry* rolls =
      buffers_.best_rolls.data() + static_cast<std::ptrdiff_t>(thread) * (row_stride_ / 2);
  std::fill_n(rolls, count, none);
  for (int t = 0; t < template_count_; ++t) {
    const Template& tpl = buffers_.templates[static_cast<std::size_t>(t)];
    for (int j = 0; j < 2; ++j) {
      kernels.search.scan_row(level.plain, (2 * cell_y + j) * level.plain.stride + x_first,
                              2 * count, &buffers_.features[static_cast<std::size_t>(tpl.first)],
                              tpl.count, gradient, normal);
      std::uint16_t* out = scores + j * row_stride_;
      const ScoreScale scale = tpl.scale;
      for (int x = 0; x < 2 * count; ++x) out[x] = scale.score(gradient[x], normal[x]);
    }
    for (int c = 0; c < count; ++c) {
      const std::uint16_t* upper = scores + 2 * c;
      const std::uint16_t* lower = upper + row_stride_;
      const std::uint16_t quad[4] = {upper[0], upper[1], lower[0], lower[1]};
      const int best = static_cast<int>(std::max_element(quad, quad + 4) - quad);
      if (quad[best] > rolls[c].score)
        rolls[c] = {quad[best], static_cast<std::uint16_t>(t), static_cast<std::uint8_t>(best)};
    }
    const bool last_roll =
        t + 1 == template_count_ ||
        buffers_.templates[static_cast<std::size_t>(t) + 1].viewpoint != tpl.viewpoint;
    if (!last_roll) continue;
    for (int c = 0; c < count; ++c) {
      CellEntry* cell = row + (span.first + c) * kViewpointsPerCell;
      if (rolls[c].score > cell[kViewpointsPerCell - 1].score) insert(cell, rolls[c]);
      rolls[c] = none;
    }
  }
}

int Scanner::scan(const ObjectModel& model, int model_index, int distance_index,
                  const ScalePlan& plan, const FeaturePyramid& pyramid,
                  const simd::KernelTable& kernels, int threshold, WorkerPool& pool,
                  std::span<Candidate> out, int& lost) {
  const int l = plan.level[model.info().scan_depth][distance_index];
  const PyramidLevel& level = pyramid.level(l);
  load_templates(model, distance_index, plan, pyramid, level.plain.stride);
  columns_ = level.width / 2;
  const int rows = level.height / 2;
  const DistanceGate gate(model);
  pool.parallel_for(rows, [&](int y, int thread) {
    const CellSpan span = open_cells(y, level, gate, model.info().scan_depth, distance_index);
    scan_cell_row(y, span, level, kernels, threshold, thread);
  });
  std::size_t count = 0;
  for (int i = 0; i < rows * columns_; ++i) {
    const int x = 2 * (i % columns_), y = 2 * (i / columns_);
    if (!gate.allows(level, x, y, model.info().scan_depth, distance_index)) continue;
    for (int k = 0; k < kViewpointsPerCell; ++k) {
      const CellEntry& e = buffers_.cells[static_cast<std::size_t>(i * kViewpointsPerCell + k)];
      if (e.score < threshold) break;
      if (count == out.size()) {
        ++lost;
        continue;
      }
      const Template& t = buffers_.templates[e.template_index];
      Candidate c;
      c.x = static_cast<std::int16_t>(x);
      c.y = static_cast<std::int16_t>(y);
      c.viewpoint = t.viewpoint;
      c.origin = static_cast<std::uint8_t>(t.viewpoint);
      c.roll = t.roll;
      c.distance = static_cast<std::int16_t>(distance_index);
      c.score = e.score;
      c.model = static_cast<std::uint8_t>(model_index);
      c.level = static_cast<std::uint8_t>(l);
      c.best_pixel = e.pixel;
      out[count++] = c;
    }
  }
  return static_cast<int>(count);
}

}  // namespace binpick
