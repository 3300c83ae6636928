// A sensor's GenICam features by name. Whatever is missing or refused is a SensorError that names
// the sensor and the feature: Aravis answers 0 for a feature that does not exist.
// Thread: one at a time. On a dead link each call takes seconds.
#pragma once

#include <arv.h>

#include <map>
#include <optional>
#include <string>

#include "binpick/drivers/camera_spec.hpp"
#include "genicam/pixel_format.hpp"

namespace binpick::drivers {

class Features {
 public:
  // Borrows the camera.
  Features(ArvCamera* camera, std::string uri) : camera_(camera), uri_(std::move(uri)) {}

  bool has(const std::string& name) const;
  double number(const std::string& name) const;  // float, integer or boolean
  std::string text(const std::string& name) const;
  void set(const std::string& name, const std::string& value) const;
  void set_number(const std::string& name, double value) const;
  // The value itself, or else its feature's.
  double number(const FeatureOrValue& source) const;
  // The sensor's pixel formats: number to what is understood, vendors' own included.
  std::map<std::uint32_t, PixelFormat> pixel_formats() const;

  [[noreturn]] void fail(const std::string& complaint) const;
  const std::string& uri() const { return uri_; }
  ArvCamera* camera() const { return camera_; }

 private:
  ArvGcNode* node(const std::string& name) const;  // fails when there is none

  ArvCamera* camera_;
  std::string uri_;
};

}  // namespace binpick::drivers
