#include "search/scan.hpp"

#include <algorithm>

#include "binpick/base/arena_plan.hpp"
#include "search/distance_gate.hpp"
#include "search/matched_features.hpp"

namespace binpick {
namespace {

int row_cells(const ScanLimits& limits) {
  return static_cast<int>((limits.width_max / 2 + simd::kReadAhead + 63) / 64 * 64);
}

}  // namespace

void place_scanned(std::span<const Feature> features, int scale_q8, std::ptrdiff_t stride,
                   simd::PlacedFeature* out) {
  for (const Feature& f : features) {
    const std::ptrdiff_t x = (f.x * scale_q8 + 128) >> 8, y = (f.y * scale_q8 + 128) >> 8;
    *out++ = {static_cast<std::int32_t>(y * stride + x), f.gradient_bits, f.gradient_weight,
              f.normal_bits, f.normal_weight};
  }
}

template <class Source>
Scanner::Buffers Scanner::take(const ScanLimits& limits, Source& source) {
  const auto row = static_cast<std::size_t>(row_cells(limits) * limits.thread_count);
  const auto cells =
      static_cast<std::size_t>((limits.width_max / 2 + 1) * (limits.height_max / 2 + 1));
  Buffers b;
  b.templates = source.template take<Template>(static_cast<std::size_t>(limits.templates_max));
  b.features =
      source.template take<simd::PlacedFeature>(static_cast<std::size_t>(limits.features_max));
  b.cells = source.template take<CellEntry>(cells * kViewpointsPerCell);
  b.known = source.template take<std::uint16_t>(row);
  b.better = source.template take<simd::CellScore>(row);
  return b;
}

std::size_t Scanner::footprint(const ScanLimits& limits) {
  ArenaPlan plan;
  take(limits, plan);
  return plan.bytes;
}

Scanner::Scanner(const ScanLimits& limits, Arena& arena)
    : row_cells_(row_cells(limits)), buffers_(take(limits, arena)) {}

void Scanner::load_templates(const ObjectModel& model, int distance_index, const ScalePlan& plan,
                             const FeaturePyramid& pyramid, std::ptrdiff_t stride) {
  const int d = model.info().scan_depth;
  const TreeDepth& depth = model.depth(d);
  template_count_ = static_cast<int>(depth.templates.size());
  simd::PlacedFeature* next = buffers_.features.data();
  for (int t = 0; t < template_count_; ++t) {
    const TemplateRange& range = depth.templates[static_cast<std::size_t>(t)];
    const auto features = matched_features(model, range, pyramid);
    const int count = static_cast<int>(features.size());
    int with_gradient = count;
    while (with_gradient > 0 &&
           features[static_cast<std::size_t>(with_gradient) - 1].gradient_bits == 0)
      --with_gradient;
    place_scanned(features, plan.scale_q8[d][distance_index], stride, next);
    const ScoreScale scale(range.gradient_weight_sum, range.normal_weight_sum);
    buffers_.templates[static_cast<std::size_t>(t)] = {
        {next, count, with_gradient, scale},
        static_cast<std::int16_t>(t / depth.roll_count),
        static_cast<std::int16_t>(t % depth.roll_count)};
    next += count;
  }
}

// Puts a viewpoint's better roll in the place of its roll so far, or of the last entry. Best first;
// of equal scores the earlier viewpoint stays ahead.
void Scanner::enter(CellEntry* cell, CellEntry entry, int viewpoint_first) {
  int at = 0;
  while (at < kViewpointsPerCell - 1 && cell[at].template_index < viewpoint_first) ++at;
  for (; at > 0 && cell[at - 1].score < entry.score; --at) cell[at] = cell[at - 1];
  cell[at] = entry;
}

// Empties the row's cells. No score is better than those of a cell where the distance is
// impossible.
Scanner::CellSpan Scanner::open_cells(int cell_y, const PyramidLevel& level,
                                      const DistanceGate& gate, int depth, int distance_index,
                                      int threshold) {
  CellEntry* row = cell_row(cell_y);
  std::fill_n(row, columns_ * kViewpointsPerCell,
              CellEntry{static_cast<std::uint16_t>(threshold - 1), 0, 0});
  CellSpan span{columns_, columns_};
  for (int c = 0; c < columns_; ++c) {
    if (gate.allows(level, 2 * c, 2 * cell_y, depth, distance_index)) {
      if (span.first == columns_) span.first = c;
      span.end = c + 1;
    } else {
      row[(c + 1) * kViewpointsPerCell - 1].score = UINT16_MAX;
    }
  }
  return span;
}

void Scanner::scan_cell_row(int cell_y, CellSpan span, const PyramidLevel& level,
                            const simd::KernelTable& kernels, int thread) {
  const std::ptrdiff_t buffer = static_cast<std::ptrdiff_t>(thread) * row_cells_;
  std::uint16_t* known = buffers_.known.data() + buffer;
  simd::CellScore* better = buffers_.better.data() + buffer;
  CellEntry* row = cell_row(cell_y) + span.first * kViewpointsPerCell;
  const std::ptrdiff_t row_offset = 2 * (cell_y * level.plain.stride + span.first);
  const int count = span.end - span.first;
  int viewpoint = -1, viewpoint_first = 0;
  for (int t = 0; t < template_count_; ++t) {
    const Template& tpl = buffers_.templates[static_cast<std::size_t>(t)];
    if (tpl.viewpoint != viewpoint) {
      viewpoint = tpl.viewpoint;
      viewpoint_first = t;
      for (int c = 0; c < count; ++c) known[c] = row[(c + 1) * kViewpointsPerCell - 1].score;
    }
    const int found =
        kernels.search.scan_cells(level.plain, row_offset, count, tpl.placed, known, better);
    for (int i = 0; i < found; ++i) {
      const simd::CellScore& b = better[i];
      known[b.cell] = b.score;
      enter(row + b.cell * kViewpointsPerCell, {b.score, static_cast<std::uint16_t>(t), b.pixel},
            viewpoint_first);
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
    const CellSpan span =
        open_cells(y, level, gate, model.info().scan_depth, distance_index, threshold);
    scan_cell_row(y, span, level, kernels, thread);
  });
  std::size_t count = 0;
  for (int i = 0; i < rows * columns_; ++i) {
    const int x = 2 * (i % columns_), y = 2 * (i / columns_);
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
