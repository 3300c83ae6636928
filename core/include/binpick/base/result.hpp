// Result<T>: a value or an Error, for operations that can fail while the system runs. No heap, no
// exceptions, so it may be used inside the cycle.
#pragma once

#include <utility>
#include <variant>

#include "binpick/base/assert.hpp"
#include "binpick/base/error_code.hpp"

namespace binpick {

struct Error {
  ErrorCode code = ErrorCode::kNone;
  long long detail =
      0;  // a number that helps: an offset, a size, an index; meaning depends on code
  const char* where = "";  // string literal: what was being read or checked
};

// One English sentence for an error code; a string literal.
const char* error_message(ErrorCode code);

template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}
  Result(Error error) : state_(std::in_place_index<1>, error) {}

  bool ok() const { return state_.index() == 0; }
  explicit operator bool() const { return ok(); }

  T& value() & {
    BINPICK_ASSERT(ok());
    return *std::get_if<0>(&state_);
  }
  const T& value() const& {
    BINPICK_ASSERT(ok());
    return *std::get_if<0>(&state_);
  }
  T&& value() && {
    BINPICK_ASSERT(ok());
    return std::move(*std::get_if<0>(&state_));
  }
  const Error& error() const {
    BINPICK_ASSERT(!ok());
    return *std::get_if<1>(&state_);
  }

 private:
  std::variant<T, Error> state_;
};

}  // namespace binpick
