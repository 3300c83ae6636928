#include "binpick/model/object_model.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "binpick/geometry/angle.hpp"
#include "model/model_format.hpp"

namespace binpick {
namespace {

constexpr Error inconsistent(const char* where, long long detail = 0) {
  return {ErrorCode::kModelInconsistent, detail, where};
}

// The table as a span, or false when it does not lie within the file.
template <class T>
bool read_table(std::span<const std::uint8_t> bytes, const ModelTable& table,
                std::span<const T>& out) {
  if (table.offset_bytes % kModelAlignment != 0 || table.offset_bytes > bytes.size()) return false;
  if (table.count > (bytes.size() - table.offset_bytes) / sizeof(T)) return false;
  out = {reinterpret_cast<const T*>(bytes.data() + table.offset_bytes),
         static_cast<std::size_t>(table.count)};
  return true;
}

bool finite_and_positive(double x) {
  return std::isfinite(x) && x > 0;
}

bool all_finite(std::span<const float> values) {
  return std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
}

bool plausible(const ModelInfo& i) {
  for (int k = 0; k < 3; ++k) {
    if (!std::isfinite(i.bounds_min_mm[k]) || !std::isfinite(i.bounds_max_mm[k])) return false;
  }
  return i.camera.valid() && finite_and_positive(i.distance_min_mm) &&
         std::isfinite(i.distance_max_mm) && i.distance_max_mm >= i.distance_min_mm &&
         finite_and_positive(i.reference_distance_mm) && finite_and_positive(i.diameter_mm) &&
         i.depth_count >= 1 && i.depth_count <= kModelDepthsMax && i.scan_depth >= 0 &&
         i.scan_depth < i.depth_count && i.base_level >= 0 && i.base_level < 8 &&
         static_cast<int>(i.normal_codebook) <= 1;
}

bool plausible(const ScoreCalibration& c) {
  return finite_and_positive(c.slope) && c.slope <= 100 && std::abs(c.offset) <= 100;
}

bool plausible(const ModelTrials& t) {
  const auto share = [](double value) { return value >= 0 && value <= 1; };
  const SelfTestRecord& test = t.self_test;
  return plausible(t.with_intensity) && plausible(t.depth_alone) && plausible(t.intensity_alone) &&
         t.calibration_piles >= 0 && finite_and_positive(t.variance_scale) &&
         finite_and_positive(t.variance_scale_intensity_alone) && test.piles >= 0 &&
         test.instances >= 0 && share(test.recall) && share(test.precision) &&
         share(test.visible_fraction_min);
}

bool range_within(std::uint64_t first, std::uint64_t count, std::size_t size) {
  return first <= size && count <= size - first;
}

bool samples_within(std::uint64_t first, std::uint64_t count, int count_max, std::size_t size) {
  return count <= static_cast<std::uint64_t>(count_max) && first % kSampleLanes == 0 &&
         range_within(first, 6 * padded_samples(count), size);
}

// Weights sum up as stated, and no template is larger than the search's accumulators hold.
bool template_valid(const TemplateRange& t, std::span<const Feature> features) {
  if (!range_within(t.first, t.count, features.size()) || t.count > 255) return false;
  unsigned gradient = 0, normal = 0;
  for (const Feature& f : features.subspan(t.first, t.count)) {
    if (f.gradient_weight > kFeatureWeightMax || f.normal_weight > kFeatureWeightMax) return false;
    gradient += f.gradient_weight;
    normal += f.normal_weight;
  }
  return gradient == t.gradient_weight_sum && normal == t.normal_weight_sum;
}

// What turns and axes have in common.
template <class Row>
bool symmetry_row_valid(const Row& row) {
  const auto kind = static_cast<std::int32_t>(row.kind);
  if (kind < 0 || kind > 2) return false;
  if (!all_finite(row.axis) || !all_finite(row.point_mm)) return false;
  const double length =
      std::hypot(static_cast<double>(row.axis[0]), static_cast<double>(row.axis[1]),
                 static_cast<double>(row.axis[2]));
  if (std::abs(length - 1) > 1e-4) return false;
  if (!(row.differing_share >= 0 && row.differing_share <= 1) || !(row.deviation_mm >= 0) ||
      !std::isfinite(row.deviation_mm)) {
    return false;
  }
  return kind != 0 || row.differing_share == 0;
}

bool turn_valid(const SymmetryTurn& t) {
  const double angle = std::abs(static_cast<double>(t.angle_rad));
  return symmetry_row_valid(t) && angle > 1e-3 && angle <= kPi + 1e-6 &&
         std::isfinite(t.shift_mm) && (t.kind != SymmetryKind::kExact || t.shift_mm == 0);
}

// How many rows are exact, when these are the first ones and both kinds are within their limits.
template <class Row>
bool split_kinds(std::span<const Row> rows, std::size_t exact_max, std::size_t near_max,
                 std::span<const Row>& exact, std::span<const Row>& near) {
  std::size_t count = 0;
  while (count < rows.size() && rows[count].kind == SymmetryKind::kExact) ++count;
  exact = rows.first(count);
  near = rows.subspan(count);
  for (const Row& row : near) {
    if (row.kind == SymmetryKind::kExact) return false;
  }
  return exact.size() <= exact_max && near.size() <= near_max;
}

}  // namespace

Result<ObjectModel> ObjectModel::parse(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < sizeof(kModelMagic))
    return Error{ErrorCode::kModelTruncated, static_cast<long long>(bytes.size()), "magic"};
  if (std::memcmp(bytes.data(), kModelMagic, sizeof(kModelMagic)) != 0)
    return Error{ErrorCode::kModelForeign, 0, "magic"};
  if (bytes.size() < sizeof(ModelHeader))
    return Error{ErrorCode::kModelTruncated, static_cast<long long>(bytes.size()), "header"};
  BINPICK_ASSERT(reinterpret_cast<std::uintptr_t>(bytes.data()) % alignof(std::max_align_t) == 0);
  const auto& header = *reinterpret_cast<const ModelHeader*>(bytes.data());
  if (header.version != kModelVersion || header.header_bytes != sizeof(ModelHeader)) {
    return Error{ErrorCode::kModelVersion, header.version, "header"};
  }
  if (header.file_bytes != bytes.size() || header.file_bytes > kModelBytesMax) {
    return Error{ErrorCode::kModelTruncated, static_cast<long long>(header.file_bytes),
                 "file size"};
  }
  if (model_checksum(bytes.subspan(kChecksumFrom)) != header.checksum) {
    return Error{ErrorCode::kModelChecksum, 0, "checksum"};
  }
  if (!plausible(header.info)) return inconsistent("training parameters");
  if (!plausible(header.trials)) return inconsistent("calibration of the score");

  ObjectModel model;
  model.info_ = &header.info;
  model.trials_ = &header.trials;
  model.bytes_total_ = bytes.size();
  if (!read_table(bytes, header.features, model.features_)) return inconsistent("feature table");
  std::span<const float> directions;
  if (!read_table(bytes, header.samples, model.samples_)) return inconsistent("sample table");
  if (!read_table(bytes, header.viewing_directions, directions))
    return inconsistent("viewing direction table");
  if (!all_finite(model.samples_)) return inconsistent("sample");
  if (!all_finite(directions)) return inconsistent("viewing direction");
  const Error symmetry_error = model.read_symmetry(bytes, header);
  if (symmetry_error.code != ErrorCode::kNone) return symmetry_error;
  for (int d = 0; d < header.info.depth_count; ++d) {
    const Error error = model.read_depth(bytes, header, d);
    if (error.code != ErrorCode::kNone) return error;
  }
  const std::size_t leaves = model.depths_[header.info.depth_count - 1].viewpoints.size();
  const std::size_t row = padded_samples(leaves);
  if (directions.size() != 3 * row) return inconsistent("viewing direction count");
  const float* x = directions.data();
  model.viewing_directions_ = {
      static_cast<int>(leaves), x, x + row, x + 2 * row, nullptr, nullptr, nullptr};
  model.place_distances();
  for (int d = 0; d < header.info.depth_count; ++d) {
    const Error error = model.check_viewpoints(d);
    if (error.code != ErrorCode::kNone) return error;
  }
  return model;
}

Error ObjectModel::read_depth(std::span<const std::uint8_t> bytes, const ModelHeader& header,
                              int d) {
  const ModelDepthHeader& from = header.depths[d];
  TreeDepth& to = depths_[d];
  if (!read_table(bytes, from.viewpoints, to.viewpoints)) return inconsistent("viewpoint table", d);
  if (!read_table(bytes, from.templates, to.templates)) return inconsistent("template table", d);
  to.roll_count = from.roll_count;
  to.distance_count = from.distance_count;
  if (to.viewpoints.empty() || to.viewpoints.size() > 30000) {
    return inconsistent("viewpoint count", d);
  }
  if (to.roll_count < 1 || to.roll_count > 4096 || to.distance_count < 1 ||
      to.distance_count > kModelDistancesMax) {
    return inconsistent("roll or distance count", d);
  }
  if (to.templates.size() != to.viewpoints.size() * static_cast<std::size_t>(to.roll_count)) {
    return inconsistent("template count", d);
  }
  if (d == header.info.scan_depth && to.templates.size() > kModelScanTemplatesMax) {
    return inconsistent("scanned template count", d);
  }
  for (const TemplateRange& t : to.templates) {
    if (!template_valid(t, features_)) return inconsistent("template", d);
  }
  if (d > 0 && (to.roll_count != 2 * depths_[d - 1].roll_count ||
                (to.distance_count + 1) / 2 != depths_[d - 1].distance_count)) {
    return inconsistent("halving of rolls or distances", d);
  }
  return {};
}

Error ObjectModel::read_symmetry(std::span<const std::uint8_t> bytes, const ModelHeader& header) {
  std::span<const SymmetryTurn> turns;
  std::span<const SymmetryAxis> axes;
  if (!read_table(bytes, header.symmetry_turns, turns)) return inconsistent("symmetry turn table");
  if (!read_table(bytes, header.symmetry_axes, axes)) return inconsistent("symmetry axis table");
  for (const SymmetryTurn& t : turns) {
    if (!turn_valid(t)) return inconsistent("symmetry turn");
  }
  for (const SymmetryAxis& a : axes) {
    if (!symmetry_row_valid(a)) return inconsistent("symmetry axis");
  }
  if (!split_kinds(turns, kExactTurnsMax, kNearTurnsMax, symmetry_.exact_turns,
                   symmetry_.near_turns) ||
      !split_kinds(axes, kSymmetryAxesMax, kSymmetryAxesMax, symmetry_.exact_axes,
                   symmetry_.near_axes)) {
    return inconsistent("symmetry kinds");
  }
  return {};
}

Error ObjectModel::check_viewpoints(int d) const {
  const std::size_t below =
      d + 1 < info_->depth_count ? depths_[d + 1].viewpoints.size() : std::size_t{0};
  for (const Viewpoint& v : depths_[d].viewpoints) {
    if (!all_finite(v.R_view_obj) || !std::isfinite(v.sample_area_mm2)) {
      return inconsistent("viewpoint", d);
    }
    if (v.child_first < 0 || v.child_count < 0 ||
        !range_within(static_cast<std::uint64_t>(v.child_first),
                      static_cast<std::uint64_t>(v.child_count), below)) {
      return inconsistent("viewpoint children", d);
    }
    if (!samples_within(v.surface_first, v.surface_count, kSurfaceSamplesMax, samples_.size()) ||
        !samples_within(v.contour_first, v.contour_count, kContourSamplesMax, samples_.size()) ||
        v.outline_count > v.contour_count) {
      return inconsistent("viewpoint samples", d);
    }
  }
  return {};
}

SampleArrays ObjectModel::arrays(std::uint64_t first, std::uint64_t count) const {
  const std::uint64_t row = padded_samples(count);
  const float* x = samples_.data() + first;
  return {static_cast<int>(count), x, x + row, x + 2 * row, x + 3 * row, x + 4 * row, x + 5 * row};
}

double ObjectModel::roll_rad(int d, int roll) const {
  return (roll + 0.5) * 2 * kPi / depths_[d].roll_count;
}

Vec3 ObjectModel::centre_mm() const {
  Vec3 centre;
  for (int k = 0; k < 3; ++k) centre[k] = (info_->bounds_min_mm[k] + info_->bounds_max_mm[k]) / 2;
  return centre;
}

Mat3 ObjectModel::rotation(int d, int viewpoint, int roll) const {
  const Viewpoint& v = depths_[d].viewpoints[static_cast<std::size_t>(viewpoint)];
  Mat3 R;
  for (int i = 0; i < 9; ++i) R(i / 3, i % 3) = static_cast<double>(v.R_view_obj[i]);
  const double c = std::cos(roll_rad(d, roll)), s = std::sin(roll_rad(d, roll));
  Mat3 Z;
  Z << c, -s, 0, s, c, 0, 0, 0, 1;
  return Z * R;
}

// What matters is scale: leaves cut the range into equal ratios, and a node stands in the middle of
// its leaves, in this sense.
void ObjectModel::place_distances() {
  const int leaves = depths_[depth_count() - 1].distance_count;
  const double ratio = info_->distance_max_mm / info_->distance_min_mm;
  const auto border_mm = [&](int leaf) {
    return info_->distance_min_mm * std::pow(ratio, static_cast<double>(leaf) / leaves);
  };
  for (int d = 0; d < depth_count(); ++d) {
    const int halvings = depth_count() - 1 - d;
    for (int k = 0; k < depths_[d].distance_count; ++k) {
      const double near_mm = border_mm(k << halvings);
      const double far_mm = border_mm(std::min(leaves, (k + 1) << halvings));
      distances_[d][k] = {std::sqrt(near_mm * far_mm), far_mm - near_mm};
    }
  }
}

}  // namespace binpick
