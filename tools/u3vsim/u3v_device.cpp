#include "u3v_device.hpp"

#include <algorithm>
#include <cstring>

#include "status_code.hpp"
#include "transport_registers.hpp"

namespace binpick::sim {
namespace {

using namespace u3v;

constexpr std::uint32_t kCommandPrefix = 0x43563355;  // "U3VC"
constexpr std::uint32_t kLeaderPrefix = 0x4c563355;   // "U3VL"
constexpr std::uint32_t kTrailerPrefix = 0x54563355;  // "U3VT"
constexpr std::size_t kHeader = 12;
constexpr std::size_t kLeaderBytes = 52, kTrailerBytes = 36;
constexpr std::uint16_t kReadMemory = 0x0800, kWriteMemory = 0x0802;
constexpr std::uint16_t kDataDiscarded = 0xa100;
constexpr std::uint32_t kControlMax = 1024;  // bytes of one command or acknowledgement
// Frames waiting for the host to fetch them; a sensor has little memory of its own.
constexpr int kFramesQueuedMax = 2;

std::uint16_t le16(std::span<const std::uint8_t> bytes, std::size_t at) {
  return get<std::uint16_t>(&bytes[at], ByteOrder::kLittle);
}
std::uint64_t le64(std::span<const std::uint8_t> bytes, std::size_t at) {
  return get<std::uint64_t>(&bytes[at], ByteOrder::kLittle);
}

}  // namespace

U3vDevice::U3vDevice(Sensor& sensor, FaultBoard& faults, const U3vOptions& options)
    : sensor_(sensor),
      faults_(faults),
      dice_(options.seed),
      acquisition_(sensor, faults, options.loop,
                   {[] { return false; }, [this](const SensorFrame& frame) { deliver(frame); }}) {
  const auto guard = sensor_.lock();
  add_bootstrap(options);
}

void U3vDevice::add_bootstrap(const U3vOptions& options) {
  RegisterFile& r = sensor_.registers();
  r.add_block(0, kAbrmEnd);
  r.add_block(kSbrm, kSbrmEnd - kSbrm);
  r.add_block(kSirm, kSirmEnd - kSirm);
  r.add_block(kManifest, kManifestEnd - kManifest);
  r.set_u32(kGenCpVersion, 0x00010002);
  r.set_text(kManufacturerName, 64, options.name.vendor);
  r.set_text(kModelName, 64, options.name.model);
  r.set_text(kFamilyName, 64, "Simulated");
  r.set_text(kDeviceVersion, 64, options.name.version);
  r.set_text(kManufacturerInfo, 64, "simulated sensor");
  r.set_text(kSerialNumber, 64, options.name.serial);
  r.set_text(kUserDefinedName, 64, options.name.user_name);
  r.set_u64(kDeviceCapability, 0x1);  // user-defined name
  r.set_u32(kMaxResponseTime, 500);
  r.set_u64(kManifestAddress, kManifest);
  r.set_u64(kSbrmAddress, kSbrm);
  r.set_u64(kTimestampIncrement, 1);
  r.set_u32(kSbrmVersion, 0x00010000);
  r.set_u32(kSbrmMaxCommand, kControlMax);
  r.set_u32(kSbrmMaxAcknowledge, kControlMax);
  r.set_u32(kSbrmStreamCount, 1);
  r.set_u64(kSbrmSirmAddress, kSirm);
  r.set_u32(kSbrmSirmLength, kSirmEnd - kSirm);
  r.set_u32(kSbrmCurrentSpeed, options.usb2 ? 0x4 : 0x8);  // high speed, super speed
  r.set_u32(kSirmLeaderSize, kLeaderBytes);
  r.set_u32(kSirmTrailerSize, kTrailerBytes);
  r.allow_write(kSirmControl, 4);
  r.allow_write(kSirmLeaderMax, kSirmEnd - kSirmLeaderMax);
  r.allow_write(kUserDefinedName, 64);
  r.allow_write(kTimestampLatch, 4);
  // The manifest: one description, uncompressed.
  r.set_u64(kManifest, 1);
  r.set_u32(kManifest + 8, 0x01000000);   // version of the file
  r.set_u32(kManifest + 12, 0x01010000);  // version of the schema; uncompressed
  r.set_u64(kManifest + 16, kXmlBase);
  r.set_u64(kManifest + 24, sensor_.xml().size());
}

AccessStatus U3vDevice::read(std::uint64_t address, std::span<std::uint8_t> out) {
  {
    const auto guard = sensor_.lock();
    RegisterFile& r = sensor_.registers();
    r.set_u64(kSirmPayloadSize, r.u32(kPayloadSize));
  }
  return sensor_.read(address, out);
}

AccessStatus U3vDevice::write(std::uint64_t address, std::span<const std::uint8_t> bytes) {
  const AccessStatus status = sensor_.write(address, bytes);
  if (status == AccessStatus::kOk) after_write(address);
  return status;
}

void U3vDevice::after_write(std::uint64_t address) {
  if (address == kTimestampLatch) {
    const auto guard = sensor_.lock();
    sensor_.registers().set_u64(kTimestamp, Acquisition::now_ns());
  }
  if (address != kSirmControl) return;
  // Enabled or disabled, a stream starts empty.
  clear_halt();
  acquisition_.restart();
}

std::uint16_t U3vDevice::execute(std::uint16_t command, std::span<const std::uint8_t> payload,
                                 std::vector<std::uint8_t>& answer) {
  if (command == kReadMemory) {
    if (payload.size() != 12) return kInvalidHeader;
    const std::size_t size = le16(payload, 10);
    if (size == 0 || size > kControlMax - kHeader) return kInvalidParameter;
    answer.resize(size);
    const std::uint16_t status = status_code(read(le64(payload, 0), answer));
    if (status != kSuccess) answer.clear();
    return status;
  }
  if (command == kWriteMemory) {
    if (payload.size() <= 8) return kInvalidHeader;
    if (faults_.on(kRefuse)) return kAccessDenied;
    const auto bytes = payload.subspan(8);
    const std::uint16_t status = status_code(write(le64(payload, 0), bytes));
    answer.assign(4, 0);
    put_le16(&answer[2], static_cast<std::uint16_t>(status == kSuccess ? bytes.size() : 0));
    return status;
  }
  return kNotImplemented;
}

void U3vDevice::command(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kHeader ||
      get<std::uint32_t>(bytes.data(), ByteOrder::kLittle) != kCommandPrefix)
    return;
  const std::uint16_t command = le16(bytes, 6);
  std::vector<std::uint8_t> payload;
  const std::uint16_t status = le16(bytes, 8) == bytes.size() - kHeader
                                   ? execute(command, bytes.subspan(kHeader), payload)
                                   : std::uint16_t{kInvalidHeader};
  std::vector<std::uint8_t> answer(kHeader);
  put_le32(&answer[0], kCommandPrefix);
  put_le16(&answer[4], status);
  put_le16(&answer[6], static_cast<std::uint16_t>(command + 1));
  put_le16(&answer[8], static_cast<std::uint16_t>(payload.size()));
  put_le16(&answer[10], le16(bytes, 10));
  answer.insert(answer.end(), payload.begin(), payload.end());
  const std::lock_guard guard(mutex_);
  acknowledgements_.clear();  // the host has given up on an earlier one
  acknowledgements_.push_back(std::move(answer));
}

std::vector<std::uint8_t> U3vDevice::take_acknowledgement() {
  const std::lock_guard guard(mutex_);
  if (acknowledgements_.empty()) return {};
  std::vector<std::uint8_t> answer = std::move(acknowledgements_.front());
  acknowledgements_.pop_front();
  return answer;
}

std::vector<std::uint8_t> U3vDevice::leader(const SensorFrame& frame) {
  std::vector<std::uint8_t> bytes(kLeaderBytes, 0);
  put_le32(&bytes[0], kLeaderPrefix);
  put_le16(&bytes[6], kLeaderBytes);
  put_le64(&bytes[8], frame.id);
  put_le16(&bytes[18], frame.chunks.empty() ? 0x0001 : 0x4001);
  put_le64(&bytes[20], frame.timestamp_ns);
  put_le32(&bytes[28], frame.parts.front().pixel_format);
  const bool wide = dice_.falls(faults_.value(kLyingWidth));
  const bool high = dice_.falls(faults_.value(kLyingHeight));
  put_le32(&bytes[32], static_cast<std::uint32_t>(frame.width) * (wide ? 2 : 1));
  put_le32(&bytes[36], static_cast<std::uint32_t>(frame.height) * (high ? 2 : 1));
  put_le32(&bytes[40], frame.offset_x);
  put_le32(&bytes[44], frame.offset_y);
  return bytes;
}

std::vector<std::uint8_t> U3vDevice::trailer(const SensorFrame& frame, std::size_t payload_bytes) {
  std::vector<std::uint8_t> bytes(kTrailerBytes, 0);
  put_le32(&bytes[0], dice_.falls(faults_.value(kWrongTrailer)) ? ~kTrailerPrefix : kTrailerPrefix);
  put_le16(&bytes[6], kTrailerBytes);
  put_le64(&bytes[8], frame.id);
  put_le16(&bytes[16],
           dice_.falls(faults_.value(kTrailerStatus)) ? kDataDiscarded : std::uint16_t{kSuccess});
  put_le64(&bytes[20], payload_bytes);
  put_le32(&bytes[28], static_cast<std::uint32_t>(frame.height));
  return bytes;
}

void U3vDevice::deliver(const SensorFrame& frame) {
  std::size_t transfer_size = 0;
  {
    const auto guard = sensor_.lock();
    if ((sensor_.registers().u32(kSirmControl) & 1) == 0) return;  // no stream is enabled
    transfer_size = sensor_.registers().u32(kSirmTransferSize);
  }
  if (transfer_size == 0) return;
  auto shared = std::make_shared<const SensorFrame>(frame);
  const std::size_t whole = frame.byte_count();
  const std::size_t bytes = dice_.falls(faults_.value(kShortPayload)) ? whole / 2 : whole;
  const std::lock_guard guard(mutex_);
  if (frames_queued_ >= kFramesQueuedMax) {
    ++frames_dropped_;
    return;
  }
  ++frames_queued_;
  transfers_.push_back({leader(frame), nullptr, 0, kLeaderBytes});
  for (std::size_t begin = 0; begin < bytes; begin += transfer_size)
    transfers_.push_back({{}, shared, begin, std::min(begin + transfer_size, bytes)});
  transfers_.push_back({trailer(frame, bytes), nullptr, 0, kTrailerBytes});
  changed_.notify_all();
}

// As much of the transfer as there is room for.
std::size_t U3vDevice::copy(const Transfer& transfer, std::span<std::uint8_t> out) const {
  const std::size_t wanted = std::min(out.size(), transfer.end - transfer.begin);
  if (transfer.frame == nullptr) {
    std::copy_n(transfer.own.begin() + static_cast<std::ptrdiff_t>(transfer.begin), wanted,
                out.begin());
    return wanted;
  }
  const std::vector<std::uint8_t>& image = *transfer.frame->parts.front().bytes;
  const std::vector<std::uint8_t>& chunks = transfer.frame->chunks;
  std::size_t done = 0;
  if (transfer.begin < image.size()) {
    done = std::min(wanted, image.size() - transfer.begin);
    std::memcpy(out.data(), image.data() + transfer.begin, done);
  }
  if (done < wanted)
    std::memcpy(out.data() + done, chunks.data() + (transfer.begin + done - image.size()),
                wanted - done);
  return wanted;
}

std::ptrdiff_t U3vDevice::take_stream(std::span<std::uint8_t> buffer) {
  const std::lock_guard guard(mutex_);
  if (transfers_.empty()) return -1;
  Transfer& transfer = transfers_.front();
  const std::size_t bytes = copy(transfer, buffer);
  transfer.begin += bytes;
  if (transfer.begin == transfer.end) {
    const bool was_trailer = transfer.own.size() == kTrailerBytes;
    transfers_.pop_front();
    if (was_trailer) --frames_queued_;
  }
  return static_cast<std::ptrdiff_t>(bytes);
}

bool U3vDevice::wait_for_data(std::chrono::microseconds timeout) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, timeout, [this] { return !transfers_.empty(); });
}

void U3vDevice::clear_halt() {
  const std::lock_guard guard(mutex_);
  transfers_.clear();
  frames_queued_ = 0;
}

void U3vDevice::power_cycle() {
  acquisition_.stop();
  {
    const auto guard = sensor_.lock();
    sensor_.registers().set_u32(kSirmControl, 0);
  }
  clear_halt();
  const std::lock_guard guard(mutex_);
  acknowledgements_.clear();
}

}  // namespace binpick::sim
