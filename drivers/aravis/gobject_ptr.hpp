// Owners for what GLib hands out.
#pragma once

#include <arv.h>

#include <memory>

namespace binpick::drivers {

struct GObjectRelease {
  void operator()(gpointer object) const { g_object_unref(object); }
};
template <class T>
using GObjectPtr = std::unique_ptr<T, GObjectRelease>;

struct GFree {
  void operator()(gpointer memory) const { g_free(memory); }
};

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
  const char* message() const { return error_ != nullptr ? error_->message : ""; }

 private:
  GError* error_ = nullptr;
};

}  // namespace binpick::drivers
