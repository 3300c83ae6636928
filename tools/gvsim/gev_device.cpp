#include "gev_device.hpp"

#include <arpa/inet.h>

#include <cstdio>

#include "transport_registers.hpp"

namespace binpick::sim {
namespace {

using namespace gev;

constexpr std::uint32_t kHeartbeatDefaultMs = 3000;
constexpr std::uint32_t kHeartbeatMinMs = 500;
constexpr std::uint32_t kPacketSizeDefault = 1400;
// GVCP capabilities: user-defined name, serial number, write memory, packet resend, concatenation.
constexpr std::uint32_t kCapabilities = 1u << 31 | 1u << 30 | 1u << 2 | 1u << 1 | 1u << 0;
// GVSP capabilities: source port register, 16-bit block ids still known.
constexpr std::uint32_t kStreamCapabilities = 1u << 31 | 1u << 30;

bool same_host(const sockaddr_in& a, const sockaddr_in& b) {
  return a.sin_addr.s_addr == b.sin_addr.s_addr && a.sin_port == b.sin_port;
}

}  // namespace

GevDevice::GevDevice(Sensor& sensor, FaultBoard& faults, const SensorName& name,
                     const GevOptions& options)
    : sensor_(sensor),
      faults_(faults),
      sender_(options.address, faults, options.link_mbps, options.seed),
      dice_(options.seed + 2),
      acquisition_(
          sensor, faults, options.loop,
          {[this] { return multipart(); }, [this](const SensorFrame& frame) { deliver(frame); }}) {
  const auto guard = sensor_.lock();
  add_bootstrap(name, options);
  describe(name, options.address);
  sensor_.update_payload_size(!options.standard_ids);
}

void GevDevice::add_bootstrap(const SensorName& name, const GevOptions& options) {
  RegisterFile& r = sensor_.registers();
  r.add_block(0, kBootstrapEnd);
  r.set_u32(kVersion, 0x00020000);
  r.set_u32(kDeviceMode, 0x80000001);  // big-endian, UTF-8
  r.set_u32(kInterfaceCount, 1);
  r.set_u32(kStreamChannelCount, 1);
  r.set_u32(kStreamCapability, kStreamCapabilities);
  r.set_u32(kCapability, kCapabilities);
  r.set_u32(kHeartbeatTimeout, kHeartbeatDefaultMs);
  r.set_u64(kTimestampTickFrequency, 1000000000);
  r.set_u32(kGvspConfiguration, options.standard_ids ? 0 : std::uint32_t{kGvspExtendedIds});
  r.set_u32(kPacketSize, kPacketSizeDefault);
  r.set_u32(kStreamSourcePort, sender_.port());
  r.set_u32(kStreamChannelCapability, 1u << kMultipartBit);
  r.set_u32(kStreamConfiguration, options.standard_ids ? 0 : 1u << kMultipartBit);
  for (const std::uint64_t address :
       {std::uint64_t{kHeartbeatTimeout}, std::uint64_t{kTimestampControl},
        std::uint64_t{kGvcpConfiguration}, std::uint64_t{kGvspConfiguration},
        std::uint64_t{kControlPrivilege}, std::uint64_t{kStreamPort}, std::uint64_t{kPacketSize},
        std::uint64_t{kPacketDelay}, std::uint64_t{kStreamAddress},
        std::uint64_t{kStreamConfiguration}}) {
    r.allow_write(address, 4);
  }
  r.allow_write(kUserDefinedName, 16);
  char url[128];
  std::snprintf(url, sizeof url, "Local:%s.xml;%llX;%zX", name.model.c_str(),
                static_cast<unsigned long long>(kXmlBase), sensor_.xml().size());
  r.set_text(kXmlUrl0, 512, url);
}

void GevDevice::describe(const SensorName& name, in_addr address) {
  RegisterFile& r = sensor_.registers();
  const std::uint32_t ip = ntohl(address.s_addr);
  r.set_u32(kMacHigh, 0x0200);  // a locally administered address, one for each IP address
  r.set_u32(kMacLow, ip);
  r.set_u32(kSupportedIpConfiguration, 0x1);  // persistent
  r.set_u32(kCurrentIpConfiguration, 0x1);
  r.set_u32(kCurrentIpAddress, ip);
  r.set_u32(kCurrentSubnetMask, ip >> 24 == 127 ? 0xff000000 : 0xffffff00);
  r.set_text(kManufacturerName, 32, name.vendor);
  r.set_text(kModelName, 32, name.model);
  r.set_text(kDeviceVersion, 32, name.version);
  r.set_text(kManufacturerInfo, 48, "simulated sensor");
  r.set_text(kSerialNumber, 16, name.serial);
  r.set_text(kUserDefinedName, 16, name.user_name);
}

bool GevDevice::controlled_by(const sockaddr_in& host) const {
  return controller_ && same_host(*controller_, host);
}

GevDevice::Verdict GevDevice::may_read(const sockaddr_in& host, std::uint64_t address) {
  const bool shut = controller_ && exclusive_ && !controlled_by(host);
  // Anyone may ask who is in control.
  return shut && address != kControlPrivilege ? Verdict::kDenied : Verdict::kAllowed;
}

GevDevice::Verdict GevDevice::may_write(const sockaddr_in& host, std::uint64_t address) {
  if (faults_.on(kRefuse)) return Verdict::kDenied;
  if (controlled_by(host)) return Verdict::kAllowed;
  const bool takes_control = address == kControlPrivilege && !controller_;
  return takes_control ? Verdict::kAllowed : Verdict::kDenied;
}

AccessStatus GevDevice::read(std::uint64_t address, std::span<std::uint8_t> out) {
  return sensor_.read(address, out);
}

AccessStatus GevDevice::check_bootstrap(std::uint64_t address, std::uint32_t value) {
  const bool streams = sensor_.acquiring();
  switch (address) {
    case kPacketSize: {
      const std::uint32_t size = value & kPacketSizeMask;
      const bool fits = size >= kPacketSizeMin && size <= kPacketSizeMax && size % 4 == 0;
      return fits ? AccessStatus::kOk : AccessStatus::kInvalidParameter;
    }
    case kHeartbeatTimeout:
      return value >= kHeartbeatMinMs ? AccessStatus::kOk : AccessStatus::kInvalidParameter;
    case kGvspConfiguration:
    case kStreamConfiguration:
      return streams ? AccessStatus::kBusy : AccessStatus::kOk;
    default:
      return AccessStatus::kOk;
  }
}

AccessStatus GevDevice::write_privilege(const sockaddr_in& host, std::uint32_t value) {
  if ((value & (kPrivilegeControl | kPrivilegeExclusive)) == 0) {
    release_control();
    return AccessStatus::kOk;
  }
  controller_ = host;
  exclusive_ = (value & kPrivilegeExclusive) != 0;
  heard();
  const auto guard = sensor_.lock();
  RegisterFile& r = sensor_.registers();
  r.set_u32(kControlPrivilege, value & (kPrivilegeControl | kPrivilegeExclusive));
  r.set_u32(kPrimaryPort, ntohs(host.sin_port));
  r.set_u32(kPrimaryAddress, ntohl(host.sin_addr.s_addr));
  return AccessStatus::kOk;
}

AccessStatus GevDevice::write(const sockaddr_in& host, std::uint64_t address,
                              std::span<const std::uint8_t> bytes) {
  if (address >= kFeatureBase || address == kUserDefinedName) return sensor_.write(address, bytes);
  if (bytes.size() != 4) return AccessStatus::kInvalidParameter;
  std::uint32_t value = get_be32(bytes.data());
  if (address == kControlPrivilege) return write_privilege(host, value);
  const AccessStatus fits = check_bootstrap(address, value);
  if (fits != AccessStatus::kOk) return fits;
  std::uint8_t stored[4];
  // Firing a test packet and latching a time are commands: their bits read as zero.
  put_be32(stored, address == kPacketSize         ? value & ~std::uint32_t{kPacketSizeFireTest}
                   : address == kTimestampControl ? 0
                                                  : value);
  const AccessStatus status = sensor_.write(address, stored);
  if (status == AccessStatus::kOk) after_write(address, value);
  return status;
}

void GevDevice::after_write(std::uint64_t address, std::uint32_t value) {
  switch (address) {
    case kPacketSize:
      if ((value & kPacketSizeFireTest) != 0)
        sender_.send_test_packet(stream_target(), value & kPacketSizeMask);
      return;
    case kStreamPort:
      sender_.forget_blocks();
      acquisition_.restart();
      return;
    case kGvspConfiguration:
    case kStreamConfiguration: {
      const bool parts = multipart();
      const auto guard = sensor_.lock();
      sensor_.update_payload_size(parts);
      return;
    }
    case kTimestampControl: {
      const std::uint64_t now = Acquisition::now_ns();
      if ((value & 1) != 0) timestamp_zero_ns_ = now;
      const auto guard = sensor_.lock();
      if ((value & 2) != 0) sensor_.registers().set_u64(kTimestampValue, now - timestamp_zero_ns_);
      return;
    }
    default:
      return;
  }
}

void GevDevice::release_control() {
  acquisition_.stop();
  controller_.reset();
  exclusive_ = false;
  const auto guard = sensor_.lock();
  RegisterFile& r = sensor_.registers();
  r.set_u32(kControlPrivilege, 0);
  r.set_u32(kPrimaryPort, 0);
  r.set_u32(kPrimaryAddress, 0);
  r.set_u32(kStreamPort, 0);
}

void GevDevice::check_heartbeat() {
  if (!controller_) return;
  std::uint32_t timeout_ms = 0;
  {
    const auto guard = sensor_.lock();
    timeout_ms = sensor_.registers().u32(kHeartbeatTimeout);
  }
  if (Clock::now() - last_heard_ < std::chrono::milliseconds(timeout_ms)) return;
  ++heartbeats_lost_;
  release_control();
}

GvspSender::Target GevDevice::stream_target() {
  const auto guard = sensor_.lock();
  const RegisterFile& r = sensor_.registers();
  GvspSender::Target target;
  target.address.sin_family = AF_INET;
  target.address.sin_addr.s_addr = htonl(r.u32(kStreamAddress));
  target.address.sin_port = htons(static_cast<std::uint16_t>(r.u32(kStreamPort)));
  target.do_not_fragment = (r.u32(kPacketSize) & kPacketSizeDoNotFragment) != 0;
  target.packet_delay_ns = r.u32(kPacketDelay);
  return target;
}

bool GevDevice::multipart() {
  const auto guard = sensor_.lock();
  const RegisterFile& r = sensor_.registers();
  return (r.u32(kGvspConfiguration) & kGvspExtendedIds) != 0 &&
         (r.u32(kStreamConfiguration) & 1u << kMultipartBit) != 0;
}

void GevDevice::deliver(const SensorFrame& frame) {
  const GvspSender::Target target = stream_target();
  if (target.address.sin_port == 0) return;  // no stream channel is open
  GvspFormat format;
  {
    const auto guard = sensor_.lock();
    const RegisterFile& r = sensor_.registers();
    format.packet_size = r.u32(kPacketSize) & kPacketSizeMask;
    format.extended_ids = (r.u32(kGvspConfiguration) & kGvspExtendedIds) != 0;
  }
  format.multipart = frame.parts.size() > 1;
  const GvspLies lies{
      dice_.falls(faults_.value(kLyingOffset)), dice_.falls(faults_.value(kLyingSize)),
      dice_.falls(faults_.value(kLyingWidth)), dice_.falls(faults_.value(kLyingHeight))};
  sender_.send(std::make_shared<const GvspBlock>(frame, format, lies), target);
}

void GevDevice::resend(const sockaddr_in& host, std::uint64_t block_id, std::uint32_t first,
                       std::uint32_t last, bool extended_ids) {
  // The request comes from the stream's socket: only the address is the controlling host's.
  if (!controller_ || controller_->sin_addr.s_addr != host.sin_addr.s_addr) return;
  const GvspSender::Target target = stream_target();
  if (target.address.sin_port == 0) return;
  sender_.resend(target, block_id, first, last, extended_ids);
}

}  // namespace binpick::sim
