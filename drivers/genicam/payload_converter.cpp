#include "genicam/payload_converter.hpp"

#include <algorithm>
#include <cstring>
#include <limits>

#include "binpick/base/assert.hpp"
#include "genicam/gray_rows.hpp"

namespace binpick::drivers {
namespace {

const PayloadPart* find_part(std::span<const PayloadPart> parts, PartRole role) {
  for (const PayloadPart& part : parts) {
    if (part.role == role) return &part;
  }
  return nullptr;
}

bool is_depth_image(PixelFormat format) {
  return is_coord3d(format) || format == PixelFormat::kMono16;
}

std::uint16_t load16(const std::uint8_t* bytes) {
  std::uint16_t value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

// The bytes hold all rows; the last one needs no padding.
bool bytes_suffice(const PayloadPart& part) {
  const std::size_t row = row_bytes(part.format, part.width);
  return row > 0 &&
         part.bytes.size() >= part.stride_bytes() * static_cast<std::size_t>(part.height - 1) + row;
}

void depth_rows_16(const PayloadPart& part, const DepthTable& table, float* depth_mm) {
  for (int y = 0; y < part.height; ++y) {
    const std::uint8_t* row = part.row(y);
    for (int x = 0; x < part.width; ++x) *depth_mm++ = table.mm(load16(row + 2 * x));
  }
}

float load32f(const std::uint8_t* bytes) {
  float value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

void depth_rows_32f(const PayloadPart& part, const Scan3d& scan3d, float* depth_mm) {
  const AxisInMm z(scan3d.c, scan3d.mm_per_unit);
  for (int y = 0; y < part.height; ++y, depth_mm += part.width) {
    const std::uint8_t* row = part.row(y);
    if (scan3d.kind == DepthKind::kZ) {
      for (int x = 0; x < part.width; ++x) depth_mm[x] = z.depth_mm(load32f(row + 4 * x));
    } else {
      for (int x = 0; x < part.width; ++x) depth_mm[x] = depth_mm_of(scan3d, load32f(row + 4 * x));
    }
  }
}

// Of a 16-bit image of z; 0 where the depths are no multiples of one number.
double depth_scale_mm(PixelFormat format, const Scan3d& scan3d) {
  const bool codes = format != PixelFormat::kCoord3dC32f && scan3d.kind == DepthKind::kZ;
  const double scale_mm = scan3d.c.scale * scan3d.mm_per_unit;
  return codes && scan3d.c.offset == 0 && scale_mm > 0 ? scale_mm : 0;
}

}  // namespace

PayloadConverter::PayloadConverter(const PayloadParams& params)
    : params_(params), grid_scratch_(params.width_max) {
  // Kernels number pixels by an int.
  BINPICK_ASSERT(std::int64_t{params.width_max} * params.height_max <=
                 std::numeric_limits<std::int32_t>::max());
  const auto pixels = [](int width, int height) {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  };
  gray_scratch_.resize(std::max(pixels(params.width_max, params.height_max),
                                pixels(params.sensor_width, params.sensor_height)));
}

bool PayloadConverter::sensor_size(int width, int height) const {
  const int factor = params_.sensor_width / std::max(1, width);
  return params_.sensor_width == 0 || (factor >= 1 && width * factor == params_.sensor_width &&
                                       height * factor == params_.sensor_height);
}

DropReason PayloadConverter::check(const PayloadPart& depth, const PayloadPart* intensity,
                                   const PayloadPart* confidence) const {
  if (!is_depth_image(depth.format)) return DropReason::kFormat;
  if (intensity != nullptr && !is_gray_or_colour(intensity->format)) return DropReason::kFormat;
  if (confidence != nullptr && !is_confidence(confidence->format)) return DropReason::kFormat;
  for (const PayloadPart* part : {&depth, intensity, confidence}) {
    if (part == nullptr) continue;
    if (part->width <= 0 || part->height <= 0) return DropReason::kSize;
    // Before any product of sizes: what comes from the wire may be anything.
    if (part->width > 65535 || part->height > 65535) return DropReason::kSize;
    if (!sensor_size(part->width, part->height)) return DropReason::kSize;
    if (!bytes_suffice(*part)) return DropReason::kPartBounds;
  }
  if (depth.width > params_.width_max || depth.height > params_.height_max)
    return DropReason::kSize;
  if (confidence != nullptr &&
      (confidence->width != depth.width || confidence->height != depth.height))
    return DropReason::kSize;
  if (intensity != nullptr) {
    const int factor = intensity->width / depth.width;
    if (factor < 1 || depth.width * factor != intensity->width ||
        depth.height * factor != intensity->height)
      return DropReason::kSize;
    if (static_cast<std::size_t>(intensity->width) * static_cast<std::size_t>(intensity->height) >
        gray_scratch_.size())
      return DropReason::kSize;
  }
  return DropReason::kNone;
}

DropReason PayloadConverter::convert(std::span<const PayloadPart> parts, const Scan3d& scan3d,
                                     FrameSlot& slot) {
  const PayloadPart* depth = find_part(parts, PartRole::kDepth);
  const PayloadPart* intensity = find_part(parts, PartRole::kIntensity);
  const PayloadPart* confidence = find_part(parts, PartRole::kConfidence);
  if (depth == nullptr) return DropReason::kNoDepth;
  if (const DropReason reason = check(*depth, intensity, confidence); reason != DropReason::kNone)
    return reason;
  if (scan3d.kind == DepthKind::kDisparity && is_coord3d_abc(depth->format))
    return DropReason::kFormat;

  const int width = depth->width, height = depth->height;
  const bool grid = is_coord3d_abc(depth->format);
  if (grid) {
    convert_points(*depth, intensity, confidence, scan3d, slot);
  } else {
    if (intensity != nullptr) convert_intensity(*intensity, width, height, slot.intensity.data());
    convert_depth(*depth, confidence, scan3d, slot);
  }
  const bool with_intensity = intensity != nullptr || depth->format == PixelFormat::kCoord3dAbcy16;
  slot.frame.depth_scale_mm = grid ? 0 : depth_scale_mm(depth->format, scan3d);

  slot.frame.depth_mm = {slot.depth_mm.data(), width, height, width};
  if (with_intensity) slot.frame.intensity = {slot.intensity.data(), width, height, width};
  slot.frame.camera = scan3d.camera(width, height);
  return DropReason::kNone;
}

void PayloadConverter::convert_intensity(const PayloadPart& part, int width, int height,
                                         std::uint8_t* gray) {
  const int factor = part.width / width;
  std::uint8_t* full = factor == 1 ? gray : gray_scratch_.data();
  for (int y = 0; y < part.height; ++y) {
    gray_row(part.format, part.row(y), part.width,
             full + static_cast<std::ptrdiff_t>(y) * part.width);
  }
  // `gray` may be `full`: no mean is written before the last pixel that it stands in is read.
  if (factor > 1) reduce_gray(full, width * factor, height * factor, factor, gray);
}

void PayloadConverter::convert_depth(const PayloadPart& part, const PayloadPart* confidence,
                                     const Scan3d& scan3d, FrameSlot& slot) {
  if (part.format == PixelFormat::kCoord3dC32f) {
    depth_rows_32f(part, scan3d, slot.depth_mm.data());
  } else {
    table_.update(scan3d);
    depth_rows_16(part, table_, slot.depth_mm.data());
  }
  const ConfidenceRows sure(confidence, params_.confidence_min);
  for (int y = 0; y < part.height; ++y)
    sure.apply(y, slot.depth_mm.data() + static_cast<std::ptrdiff_t>(y) * part.width);
}

void PayloadConverter::convert_points(const PayloadPart& part, const PayloadPart* intensity,
                                      const PayloadPart* confidence, const Scan3d& scan3d,
                                      FrameSlot& slot) {
  const ConfidenceRows sure(confidence, params_.confidence_min);
  const bool carries_gray = part.format == PixelFormat::kCoord3dAbcy16;
  float* depth_mm = slot.depth_mm.data();
  std::uint8_t* gray = slot.intensity.data();
  if (grid_depth(part, scan3d, depth_mm)) {
    for (int y = 0; y < part.height; ++y)
      sure.apply(y, depth_mm + static_cast<std::ptrdiff_t>(y) * part.width);
    if (intensity != nullptr) {
      convert_intensity(*intensity, part.width, part.height, gray);
    } else if (carries_gray) {
      grid_gray(part, gray);
    }
    return;
  }
  // The gray of the grid moves with the points. It is converted row by row where that can be.
  PayloadPart grid_gray;
  if (intensity != nullptr && intensity->width == part.width) {
    grid_gray = *intensity;
  } else if (intensity != nullptr) {
    convert_intensity(*intensity, part.width, part.height, gray_scratch_.data());
    grid_gray.format = PixelFormat::kMono8;
    grid_gray.width = part.width;
    grid_gray.height = part.height;
    grid_gray.bytes = gray_scratch_;
  }
  project_grid(part, scan3d, sure, intensity != nullptr ? &grid_gray : nullptr, grid_scratch_,
               depth_mm, intensity != nullptr || carries_gray ? gray : nullptr);
}

}  // namespace binpick::drivers
