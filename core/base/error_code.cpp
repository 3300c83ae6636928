#include "binpick/base/error_code.hpp"

#include "binpick/base/result.hpp"

namespace binpick {

const char* error_message(ErrorCode code) {
  switch (code) {
    case ErrorCode::kNone:
      return "no error";
    case ErrorCode::kFrameEmpty:
      return "the frame has no pixels";
    case ErrorCode::kFrameSizeMismatch:
      return "depth and intensity differ in size";
    case ErrorCode::kFrameTooLarge:
      return "the frame is larger than the detector was set up for";
    case ErrorCode::kIntrinsicsInvalid:
      return "focal lengths must be positive and finite";
    case ErrorCode::kRoiOutsideImage:
      return "the region of interest lies outside the image";
    case ErrorCode::kRoiTooLarge:
      return "the region of interest is larger than the detector was set up for";
    case ErrorCode::kFrameWithoutDepth:
      return "depth was chosen, but the frame has no depth image";
    case ErrorCode::kFrameWithoutIntensity:
      return "intensity was chosen, but the frame has no intensity image";
    case ErrorCode::kFrameRefused:
      return "the frame cannot be right, and was not searched";
    case ErrorCode::kModelTruncated:
      return "the model file is shorter than its header says";
    case ErrorCode::kModelForeign:
      return "this is not a binpick model file";
    case ErrorCode::kModelVersion:
      return "the model file has a version that this program does not read; train the part again";
    case ErrorCode::kModelChecksum:
      return "the model file is damaged (checksum differs)";
    case ErrorCode::kModelInconsistent:
      return "the model file contradicts itself";
    case ErrorCode::kModelCameraMismatch:
      return "the model was trained for another camera";
    case ErrorCode::kModelIndexUnknown:
      return "no model with this index was loaded";
    case ErrorCode::kArenaTooSmall:
      return "the memory set aside is too small";
    case ErrorCode::kSensorTimeout:
      return "no frame came in time";
    case ErrorCode::kSensorLost:
      return "the sensor no longer answers";
    case ErrorCode::kSensorNotStarted:
      return "the sensor is not started";
    case ErrorCode::kSensorFrameDropped:
      return "a frame came but was dropped";
    case ErrorCode::kSensorRefused:
      return "the sensor refused a command";
    case ErrorCode::kSensorEnd:
      return "the recording is over";
  }
  return "unknown error";
}

}  // namespace binpick
