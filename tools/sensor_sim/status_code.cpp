#include "status_code.hpp"

namespace binpick::sim {

StatusCode status_code(AccessStatus status) {
  switch (status) {
    case AccessStatus::kOk:
      return kSuccess;
    case AccessStatus::kInvalidAddress:
      return kInvalidAddress;
    case AccessStatus::kBadAlignment:
      return kBadAlignment;
    case AccessStatus::kWriteProtected:
      return kWriteProtect;
    case AccessStatus::kInvalidParameter:
      return kInvalidParameter;
    case AccessStatus::kBusy:
      return kBusy;
  }
  return kInvalidParameter;
}

}  // namespace binpick::sim
