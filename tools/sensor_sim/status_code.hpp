// What acknowledgements say of a command: GigE Vision and USB3 Vision have the same numbers.
#pragma once

#include <cstdint>

#include "register_file.hpp"

namespace binpick::sim {

enum StatusCode : std::uint16_t {
  kSuccess = 0,
  kNotImplemented = 0x8001,
  kInvalidParameter = 0x8002,
  kInvalidAddress = 0x8003,
  kWriteProtect = 0x8004,
  kBadAlignment = 0x8005,
  kAccessDenied = 0x8006,
  kBusy = 0x8007,
  kInvalidHeader = 0x800e,
};

StatusCode status_code(AccessStatus status);

}  // namespace binpick::sim
