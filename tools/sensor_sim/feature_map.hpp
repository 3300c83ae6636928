// Where the features of the simulated sensor lie, for both transports: the GenICam description
// refers to these addresses, and the sensor reads and writes them. Integers take 4 bytes, floats 8;
// an indexed feature repeats for each value of its selector.
#pragma once

#include <cstdint>

namespace binpick::sim {

enum FeatureAddress : std::uint64_t {
  kFeatureBase = 0x10000,
  kWidth = 0x10000,
  kHeight = 0x10004,
  kOffsetX = 0x10008,
  kOffsetY = 0x1000c,
  kComponentSelector = 0x10010,
  kTriggerSelector = 0x10014,
  kTriggerMode = 0x10018,
  kTriggerSource = 0x1001c,
  kTriggerActivation = 0x10020,
  kTriggerSoftware = 0x10024,
  kAcquisitionMode = 0x10028,
  kAcquisitionStart = 0x1002c,
  kAcquisitionStop = 0x10030,
  kAcquisitionFrameCount = 0x10034,
  kPayloadSize = 0x10038,
  kTLParamsLocked = 0x1003c,
  kDeviceReset = 0x10040,
  kOutputMode = 0x10044,
  kDistanceUnit = 0x10048,
  kCoordinateSelector = 0x1004c,
  kChunkModeActive = 0x10050,
  kChunkSelector = 0x10054,
  kExposureAuto = 0x10058,
  kTriggersMissed = 0x1005c,  // a vendor's feature: triggers that came while a frame was pending
  kSensorWidth = 0x10060,
  kSensorHeight = 0x10064,
  kMultiPartMode = 0x10068,  // of rc_visard: which components come in one block

  kAcquisitionFrameRate = 0x10080,
  kExposureTime = 0x10088,
  kGain = 0x10090,
  kFocalLength = 0x10098,
  kPrincipalPointU = 0x100a0,
  kPrincipalPointV = 0x100a8,
  kBaseline = 0x100b0,
  kAspectRatio = 0x100b8,

  kComponentEnable = 0x10100,  // [component]
  kComponentId = 0x10110,      // [component]
  kPixelFormat = 0x10120,      // [component]
  kCoordinateScale = 0x10140,  // [coordinate], floats
  kCoordinateOffset = 0x10160,
  kInvalidDataFlag = 0x10180,  // [coordinate], integers
  kInvalidDataValue = 0x101a0,
  kAxisMin = 0x101c0,
  kAxisMax = 0x101e0,
  kChunkEnable = 0x10200,  // [chunk]
  kFeatureEnd = 0x10300,

  kXmlBase = 0x20000,
};

enum Component : std::uint32_t { kRange, kIntensity, kConfidence, kComponentCount };
enum Coordinate : std::uint32_t { kCoordinateA, kCoordinateB, kCoordinateC, kCoordinateCount };

// Values of Scan3dOutputMode and Scan3dDistanceUnit.
enum OutputMode : std::uint32_t { kCalibratedAbcGrid, kProjectedC, kDisparityC };
enum DistanceUnit : std::uint32_t { kMillimeter, kPixel };
enum TriggerSource : std::uint32_t { kSourceSoftware, kSourceLine0, kSourceLine1 };
enum AcquisitionMode : std::uint32_t { kContinuous, kSingleFrame, kMultiFrame };

}  // namespace binpick::sim
