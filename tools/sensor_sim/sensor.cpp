#include "sensor.hpp"

#include <algorithm>
#include <cmath>

#include "binpick/base/assert.hpp"

namespace binpick::sim {
namespace {

constexpr double kFrameRateMax = 1000;
constexpr std::uint64_t kRamFeatures[] = {kComponentSelector,
                                          kTriggerSelector,
                                          kTriggerMode,
                                          kTriggerSource,
                                          kTriggerActivation,
                                          kTriggerSoftware,
                                          kAcquisitionMode,
                                          kAcquisitionStart,
                                          kAcquisitionStop,
                                          kTLParamsLocked,
                                          kDeviceReset,
                                          kCoordinateSelector,
                                          kChunkModeActive,
                                          kChunkSelector,
                                          kExposureAuto,
                                          kAcquisitionFrameCount,
                                          kWidth,
                                          kHeight,
                                          kOffsetX,
                                          kOffsetY,
                                          kMultiPartMode};
constexpr std::uint64_t kRamFloats[] = {kAcquisitionFrameRate, kExposureTime, kGain};

// fy / fx such that fx times it is fy to the last bit, where there is such a number.
double aspect_ratio(double fx, double fy) {
  const double ratio = fy / fx;
  for (const double candidate :
       {ratio, std::nextafter(ratio, 0.0), std::nextafter(ratio, 2 * ratio)}) {
    if (fx * candidate == fy) return candidate;
  }
  return ratio;
}

bool is_region(std::uint64_t address) {
  return address == kWidth || address == kHeight || address == kOffsetX || address == kOffsetY;
}

std::uint32_t selector_limit(std::uint64_t address) {
  switch (address) {
    case kComponentSelector:
      return kComponentCount;
    case kCoordinateSelector:
      return kCoordinateCount;
    case kChunkSelector:
      return kChunkCount;
    case kTriggerSelector:
      return 1;
    case kTriggerMode:
    case kChunkModeActive:
    case kTriggerActivation:
    case kExposureAuto:
    case kTLParamsLocked:
    case kMultiPartMode:
      return 2;
    case kTriggerSource:
    case kAcquisitionMode:
      return 3;
    default:
      return 0xffffffff;
  }
}

}  // namespace

std::size_t SensorFrame::byte_count() const {
  std::size_t bytes = chunks.size();
  for (const FramePart& part : parts) bytes += part.bytes->size();
  return bytes;
}

Sensor::Sensor(const SensorOptions& options, SceneSource& scenes)
    : scenes_(scenes),
      personality_(*options.personality),
      registers_(byte_order_of(options.transport)),
      false_values_(registers_.order()),
      xml_(sensor_xml(options.transport, options.name, *options.personality)) {
  registers_.add_block(kFeatureBase, kFeatureEnd - kFeatureBase);
  xml_.resize((xml_.size() + 3) / 4 * 4, '\n');  // hosts read whole words
  registers_.add_block(kXmlBase, xml_.size());
  registers_.store(kXmlBase, {reinterpret_cast<const std::uint8_t*>(xml_.data()), xml_.size()});
  add_features(options);
}

void Sensor::add_features(const SensorOptions& options) {
  const std::shared_ptr<const SceneFrame> first = scenes_.frame(0);
  RegisterFile& r = registers_;
  for (const std::uint64_t address : kRamFeatures) r.allow_write(address, 4);
  for (const std::uint64_t address : kRamFloats) r.allow_write(address, 8);
  r.allow_write(kComponentEnable, 4 * kComponentCount);
  r.allow_write(kPixelFormat, 4 * kComponentCount);
  r.allow_write(kChunkEnable, 4 * kChunkCount);

  for (const std::uint64_t address : {kWidth, kSensorWidth})
    r.set_u32(address, static_cast<std::uint32_t>(first->width));
  for (const std::uint64_t address : {kHeight, kSensorHeight})
    r.set_u32(address, static_cast<std::uint32_t>(first->height));
  r.set_u32(kAcquisitionFrameCount, 1);
  r.set_u32(kOutputMode, personality_.output_mode);
  r.set_u32(kDistanceUnit, personality_.distance_unit);
  r.set_u32(kCoordinateSelector, kCoordinateC);
  r.set_u32(kChunkModeActive, options.chunks_active.value_or(personality_.chunks_active) ? 1 : 0);
  r.set_f64(kAcquisitionFrameRate, options.frame_rate_hz);
  r.set_f64(kExposureTime, 5000);
  const std::uint32_t ids[] = {personality_.range_component_id, 1, 6};  // SFNC ComponentIDValue
  const std::uint32_t formats[] = {personality_.range_format, personality_.intensity_format,
                                   personality_.confidence_format};
  for (std::uint32_t i = 0; i < kComponentCount; ++i) {
    bool enabled = personality_.enabled[i];
    if (i == kIntensity && first->gray.empty()) enabled = false;
    // A USB3 Vision stream carries one image at a time, and hosts expect all of one size.
    if (options.transport == Transport::kUsb3 && i != kRange) enabled = false;
    if (i == kConfidence) enabled = options.confidence.value_or(enabled);
    r.set_u32(kComponentEnable + 4 * i, enabled ? 1 : 0);
    r.set_u32(kComponentId + 4 * i, ids[i]);
    r.set_u32(kPixelFormat + 4 * i, formats[i]);
  }
  const double scale_c = personality_.scale_c == 0 ? first->depth_scale : personality_.scale_c;
  const bool codes = personality_.range_format == kCoord3dAbcy16;
  for (std::uint32_t i = 0; i < kCoordinateCount; ++i) {
    const bool lateral = i != kCoordinateC;
    const double scale = !lateral || codes ? scale_c : 1.0;
    // Coordinates A and B lie on both sides of the axis: the middle code is zero.
    const double offset = lateral && codes ? -32768 * scale_c : 0.0;
    r.set_f64(kCoordinateScale + 8 * i, scale);
    r.set_f64(kCoordinateOffset + 8 * i, offset);
    r.set_u32(kInvalidDataFlag + 4 * i, 1);
    r.set_f64(kInvalidDataValue + 8 * i, personality_.invalid_value);
    r.set_f64(kAxisMin + 8 * i, offset);
    r.set_f64(kAxisMax + 8 * i, offset + 65535 * scale);
  }
  r.set_f64(kBaseline, personality_.baseline_m);
  for (std::uint32_t i = 0; i < kChunkCount; ++i) r.set_u32(kChunkEnable + 4 * i, 1);
  store_camera(*first);
  update_payload_size(options.transport == Transport::kGigE);
}

// Registers carry the camera of the frame that was exposed last; chunks carry that of their own.
void Sensor::store_camera(const SceneFrame& frame) {
  registers_.set_f64(kFocalLength, frame.fx);
  registers_.set_f64(kAspectRatio, aspect_ratio(frame.fx, frame.fy));
  registers_.set_f64(kPrincipalPointU, frame.cx);
  registers_.set_f64(kPrincipalPointV, frame.cy);
}

AccessStatus Sensor::read(std::uint64_t address, std::span<std::uint8_t> out) {
  const std::lock_guard guard(mutex_);
  const AccessStatus status = registers_.read(address, out);
  if (status == AccessStatus::kOk) false_values_.apply(address, out);
  return status;
}

std::string Sensor::tell_falsely(const std::string& feature, const std::string& value) {
  const std::lock_guard guard(mutex_);
  return false_values_.set(feature, value);
}

void Sensor::tell_the_truth() {
  const std::lock_guard guard(mutex_);
  false_values_.clear();
}

// Offset and size are each limited by the other, as the naming convention has it.
AccessStatus Sensor::check_region(std::uint64_t address, std::uint32_t value) const {
  if (acquiring_) return AccessStatus::kBusy;
  const bool across = address == kWidth || address == kOffsetX;
  const bool is_size = address == kWidth || address == kHeight;
  const std::uint32_t sensor = registers_.u32(across ? kSensorWidth : kSensorHeight);
  const std::uint32_t other = is_size ? registers_.u32(across ? kOffsetX : kOffsetY)
                                      : registers_.u32(across ? kWidth : kHeight);
  const bool fits = value <= sensor - other && (!is_size || value > 0);
  return fits ? AccessStatus::kOk : AccessStatus::kInvalidParameter;
}

AccessStatus Sensor::check_value(std::uint64_t address, std::span<const std::uint8_t> bytes) const {
  if (address < kFeatureBase || address >= kFeatureEnd) return AccessStatus::kOk;
  const bool is_float =
      std::find(std::begin(kRamFloats), std::end(kRamFloats), address) != std::end(kRamFloats);
  if (bytes.size() != (is_float ? 8u : 4u)) return AccessStatus::kInvalidParameter;
  if (is_float) {
    const double value = double_of(get<std::uint64_t>(bytes.data(), registers_.order()));
    const bool rate = address == kAcquisitionFrameRate;
    const bool fits =
        std::isfinite(value) && value >= 0 && (!rate || (value > 0 && value <= kFrameRateMax));
    return fits ? AccessStatus::kOk : AccessStatus::kInvalidParameter;
  }
  const auto value = get<std::uint32_t>(bytes.data(), registers_.order());
  if (is_region(address)) return check_region(address, value);
  if (address >= kPixelFormat && address < kPixelFormat + 4 * kComponentCount) {
    if (acquiring_) return AccessStatus::kBusy;
    const auto component = static_cast<Component>((address - kPixelFormat) / 4);
    return find_encoder(value, component) != nullptr ? AccessStatus::kOk
                                                     : AccessStatus::kInvalidParameter;
  }
  const bool component_enable =
      address >= kComponentEnable && address < kComponentEnable + 4 * kComponentCount;
  if (component_enable || address >= kChunkEnable || address == kChunkModeActive) {
    if (acquiring_) return AccessStatus::kBusy;
    return value <= 1 ? AccessStatus::kOk : AccessStatus::kInvalidParameter;
  }
  if (address == kAcquisitionFrameCount && value == 0) return AccessStatus::kInvalidParameter;
  return value < selector_limit(address) ? AccessStatus::kOk : AccessStatus::kInvalidParameter;
}

AccessStatus Sensor::write(std::uint64_t address, std::span<const std::uint8_t> bytes) {
  std::function<void()>* command = nullptr;
  {
    const std::lock_guard guard(mutex_);
    const AccessStatus allowed = registers_.check_write(address, bytes.size());
    if (allowed != AccessStatus::kOk) return allowed;
    const AccessStatus fits = check_value(address, bytes);
    if (fits != AccessStatus::kOk) return fits;
    switch (address) {
      // Commands have no memory: they read as done.
      case kAcquisitionStart:
        command = &commands_.start;
        break;
      case kAcquisitionStop:
        command = &commands_.stop;
        break;
      case kTriggerSoftware:
        command = &commands_.software_trigger;
        break;
      case kDeviceReset:
        command = &commands_.reset;
        break;
      default:
        registers_.store(address, bytes);
        if (is_region(address)) {
          cut_.clear();
          encoded_.clear();
          store_camera(*view(0));
        }
        if (address >= kFeatureBase && address < kFeatureEnd) update_payload_size(multipart_);
    }
  }
  if (command != nullptr && *command) (*command)();
  return AccessStatus::kOk;
}

bool Sensor::acquiring() {
  const std::lock_guard guard(mutex_);
  return acquiring_;
}

void Sensor::set_acquiring(bool acquiring) {
  const std::lock_guard guard(mutex_);
  acquiring_ = acquiring;
}

bool Sensor::trigger_mode() {
  const std::lock_guard guard(mutex_);
  return registers_.u32(kTriggerMode) != 0;
}

bool Sensor::triggered_by(TriggerSource source) {
  const std::lock_guard guard(mutex_);
  return registers_.u32(kTriggerMode) != 0 && registers_.u32(kTriggerSource) == source;
}

double Sensor::frame_rate_hz() {
  const std::lock_guard guard(mutex_);
  return registers_.f64(kAcquisitionFrameRate);
}

std::uint32_t Sensor::frames_limit() {
  const std::lock_guard guard(mutex_);
  switch (registers_.u32(kAcquisitionMode)) {
    case kSingleFrame:
      return 1;
    case kMultiFrame:
      return registers_.u32(kAcquisitionFrameCount);
    default:
      return 0;
  }
}

void Sensor::count_missed_trigger() {
  const std::lock_guard guard(mutex_);
  registers_.set_u32(kTriggersMissed, registers_.u32(kTriggersMissed) + 1);
}

}  // namespace binpick::sim
