// Owners for what GLib hands out.
#pragma once

#include <arv.h>

#include <memory>
#include <string_view>

namespace binpick::drivers {

struct GObjectRelease {
  void operator()(gpointer object) const { g_object_unref(object); }
};
template <class T>
using GObjectPtr = std::unique_ptr<T, GObjectRelease>;

struct GFree {
  void operator()(gpointer memory) const { g_free(memory); }
};

// What GigE Vision calls "access-denied".
inline constexpr const char* kControlledElsewhere =
    "another program controls this sensor: close it there; if it was killed, wait some seconds";

// Takes the place of a GError**; freed at the end of its scope.
class CaughtError {
 public:
  CaughtError() = default;
  ~CaughtError() { g_clear_error(&error_); }
  CaughtError(const CaughtError&) = delete;
  CaughtError& operator=(const CaughtError&) = delete;
  GError** out() {
    g_clear_error(&error_);
    return &error_;
  }
  explicit operator bool() const { return error_ != nullptr; }
  const char* message() const {
    if (error_ == nullptr) return "";
    const bool denied =
        std::string_view(error_->message).find("access-denied") != std::string_view::npos;
    return denied ? kControlledElsewhere : error_->message;
  }

 private:
  GError* error_ = nullptr;
};

}  // namespace binpick::drivers
