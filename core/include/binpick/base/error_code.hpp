// Every way in which an operation of core can fail. The numbers leave the process (status
// registers, recordings): a number is never reused and never changes its meaning.
#pragma once

namespace binpick {

enum class ErrorCode : int {
  kNone = 0,
  // Frames
  kFrameEmpty = 100,             // zero width or height, or no depth and no intensity
  kFrameSizeMismatch = 101,      // depth and intensity differ in size
  kFrameTooLarge = 102,          // larger than the detector was built for
  kIntrinsicsInvalid = 103,      // focal length not positive or not finite
  kRoiOutsideImage = 104,        // the region of interest shares no pixel with the image
  kRoiTooLarge = 105,            // larger than the detector was built for
  kFrameWithoutDepth = 106,      // depth was chosen, and the frame has no depth image
  kFrameWithoutIntensity = 107,  // intensity was chosen, and the frame has no intensity image
  kFrameRefused = 108,           // by the frame check; detail: which FindingCode
  // Models
  kModelTruncated = 200,       // shorter than its header says
  kModelForeign = 201,         // not a model file at all
  kModelVersion = 202,         // a version that this build does not read
  kModelChecksum = 203,        // checksum differs: damaged
  kModelInconsistent = 204,    // counts, offsets or indices that contradict each other
  kModelCameraMismatch = 205,  // trained for another camera, and re-scaling cannot bridge it
  kModelIndexUnknown = 206,    // the request names a model that was not loaded
  // Memory
  kArenaTooSmall = 300,
  // Sensors
  kSensorTimeout = 400,       // no frame before the deadline
  kSensorLost = 401,          // the sensor no longer answers
  kSensorNotStarted = 402,    // asked for a frame before start or after stop
  kSensorFrameDropped = 403,  // a frame came but could not be used; detail: which DropReason
  kSensorRefused = 404,       // the sensor refused a command
  kSensorEnd = 405,           // a recording that plays once is over
};

}  // namespace binpick
