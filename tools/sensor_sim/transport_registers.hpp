// The bootstrap registers of both transports, as their standards place them.
#pragma once

#include <cstdint>

namespace binpick::sim {

// GigE Vision; all big-endian.
namespace gev {
enum Register : std::uint64_t {
  kVersion = 0x0000,
  kDeviceMode = 0x0004,
  kMacHigh = 0x0008,
  kMacLow = 0x000c,
  kSupportedIpConfiguration = 0x0010,
  kCurrentIpConfiguration = 0x0014,
  kCurrentIpAddress = 0x0024,
  kCurrentSubnetMask = 0x0034,
  kCurrentGateway = 0x0044,
  kManufacturerName = 0x0048,
  kModelName = 0x0068,
  kDeviceVersion = 0x0088,
  kManufacturerInfo = 0x00a8,
  kSerialNumber = 0x00d8,
  kUserDefinedName = 0x00e8,
  kDiscoveryEnd = 0x00f8,
  kXmlUrl0 = 0x0200,
  kXmlUrl1 = 0x0400,
  kInterfaceCount = 0x0600,
  kPersistentIpAddress = 0x064c,
  kMessageChannelCount = 0x0900,
  kStreamChannelCount = 0x0904,
  kStreamCapability = 0x092c,
  kCapability = 0x0934,
  kHeartbeatTimeout = 0x0938,
  kTimestampTickFrequency = 0x093c,
  kTimestampControl = 0x0944,
  kTimestampValue = 0x0948,
  kGvcpConfiguration = 0x0954,
  kGvspConfiguration = 0x0960,
  kControlPrivilege = 0x0a00,
  kPrimaryPort = 0x0a04,
  kPrimaryAddress = 0x0a14,
  kStreamPort = 0x0d00,
  kPacketSize = 0x0d04,
  kPacketDelay = 0x0d08,
  kStreamAddress = 0x0d18,
  kStreamSourcePort = 0x0d1c,
  kStreamChannelCapability = 0x0d20,
  kStreamConfiguration = 0x0d24,
  kBootstrapEnd = 0x0d28,
};
enum Bits : std::uint32_t {
  kPacketSizeFireTest = 1u << 31,
  kPacketSizeDoNotFragment = 1u << 30,
  kPacketSizeMask = 0xffff,
  kGvspExtendedIds = 1u << 30,
  kPrivilegeExclusive = 1u << 0,
  kPrivilegeControl = 1u << 1,
};
constexpr int kMultipartBit = 6;  // bit 25 in the standard's counting, from the other end
constexpr int kPacketSizeMin = 576;
constexpr int kPacketSizeMax = 9000;
}  // namespace gev

// USB3 Vision; all little-endian.
namespace u3v {
enum Register : std::uint64_t {
  kGenCpVersion = 0x0000,
  kManufacturerName = 0x0004,
  kModelName = 0x0044,
  kFamilyName = 0x0084,
  kDeviceVersion = 0x00c4,
  kManufacturerInfo = 0x0104,
  kSerialNumber = 0x0144,
  kUserDefinedName = 0x0184,
  kDeviceCapability = 0x01c4,
  kMaxResponseTime = 0x01cc,
  kManifestAddress = 0x01d0,
  kSbrmAddress = 0x01d8,
  kDeviceConfiguration = 0x01e0,
  kTimestamp = 0x01f0,
  kTimestampLatch = 0x01f8,
  kTimestampIncrement = 0x01fc,
  kAccessPrivilege = 0x0204,
  kAbrmEnd = 0x0210,
  kSbrm = 0x1000,
  kSbrmVersion = 0x1000,
  kSbrmMaxCommand = 0x1014,
  kSbrmMaxAcknowledge = 0x1018,
  kSbrmStreamCount = 0x101c,
  kSbrmSirmAddress = 0x1020,
  kSbrmSirmLength = 0x1028,
  kSbrmCurrentSpeed = 0x1040,
  kSbrmEnd = 0x1044,
  kSirm = 0x2000,
  kSirmInfo = 0x2000,
  kSirmControl = 0x2004,
  kSirmPayloadSize = 0x2008,
  kSirmLeaderSize = 0x2010,
  kSirmTrailerSize = 0x2014,
  kSirmLeaderMax = 0x2018,
  kSirmTransferSize = 0x201c,
  kSirmTransferCount = 0x2020,
  kSirmFinalSize1 = 0x2024,
  kSirmFinalSize2 = 0x2028,
  kSirmTrailerMax = 0x202c,
  kSirmEnd = 0x2030,
  kManifest = 0x3000,
  kManifestEnd = 0x3048,
};
}  // namespace u3v

}  // namespace binpick::sim
