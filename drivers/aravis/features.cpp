#include "aravis/features.hpp"

#include <charconv>

#include "aravis/gobject_ptr.hpp"
#include "binpick/drivers/camera.hpp"

namespace binpick::drivers {

void Features::fail(const std::string& complaint) const {
  throw SensorError(uri_ + ": " + complaint);
}

bool Features::has(const std::string& name) const {
  return arv_camera_is_feature_available(camera_, name.c_str(), nullptr) != FALSE;
}

ArvGcNode* Features::node(const std::string& name) const {
  ArvGcNode* node = arv_device_get_feature(arv_camera_get_device(camera_), name.c_str());
  if (node == nullptr) fail("the sensor has no feature " + name);
  return node;
}

double Features::number(const std::string& name) const {
  ArvGcNode* feature = node(name);
  CaughtError error;
  double value = 0;
  if (ARV_IS_GC_FLOAT(feature)) {
    value = arv_gc_float_get_value(ARV_GC_FLOAT(feature), error.out());
  } else if (ARV_IS_GC_BOOLEAN(feature)) {
    value = arv_gc_boolean_get_value(ARV_GC_BOOLEAN(feature), error.out()) != FALSE ? 1 : 0;
  } else if (ARV_IS_GC_INTEGER(feature)) {
    value = static_cast<double>(arv_gc_integer_get_value(ARV_GC_INTEGER(feature), error.out()));
  } else {
    fail("the feature " + name + " is not a number");
  }
  if (error) fail("the feature " + name + " cannot be read: " + error.message());
  return value;
}

double Features::number(const FeatureOrValue& source) const {
  return source.value ? *source.value : number(source.feature);
}

std::string Features::text(const std::string& name) const {
  ArvGcNode* feature = node(name);
  if (!ARV_IS_GC_FEATURE_NODE(feature)) fail("the feature " + name + " has no value");
  CaughtError error;
  const char* value =
      arv_gc_feature_node_get_value_as_string(ARV_GC_FEATURE_NODE(feature), error.out());
  if (error) fail("the feature " + name + " cannot be read: " + error.message());
  return value != nullptr ? value : "";
}

void Features::set(const std::string& name, const std::string& value) const {
  ArvGcNode* feature = node(name);
  if (!ARV_IS_GC_FEATURE_NODE(feature)) fail("the feature " + name + " cannot be set");
  CaughtError error;
  arv_gc_feature_node_set_value_from_string(ARV_GC_FEATURE_NODE(feature), value.c_str(),
                                            error.out());
  if (error) fail("the feature " + name + " cannot be set to " + value + ": " + error.message());
}

void Features::set_number(const std::string& name, double value) const {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  set(name, std::string(text, end));
}

std::map<std::uint32_t, PixelFormat> Features::pixel_formats() const {
  std::map<std::uint32_t, PixelFormat> formats;
  ArvGcNode* feature = arv_device_get_feature(arv_camera_get_device(camera_), "PixelFormat");
  if (feature == nullptr || !ARV_IS_GC_ENUMERATION(feature)) return formats;
  for (const GSList* i = arv_gc_enumeration_get_entries(ARV_GC_ENUMERATION(feature)); i != nullptr;
       i = i->next) {
    const char* name = arv_gc_feature_node_get_name(ARV_GC_FEATURE_NODE(i->data));
    const PixelFormat format = pixel_format_from_name(name != nullptr ? name : "");
    const gint64 number = arv_gc_enum_entry_get_value(ARV_GC_ENUM_ENTRY(i->data), nullptr);
    if (format != PixelFormat::kUnknown) formats[static_cast<std::uint32_t>(number)] = format;
  }
  return formats;
}

}  // namespace binpick::drivers
