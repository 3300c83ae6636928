#include "binpick/drivers/open_camera.hpp"

#include "aravis/aravis_camera.hpp"

namespace binpick::drivers {

std::unique_ptr<Camera> open_camera(const CameraSpec& spec) {
  const std::string& uri = spec.uri;
  if (uri.starts_with("gev://") || uri.starts_with("u3v://")) return open_aravis_camera(spec);
  throw SensorError(uri + ": expected gev://ADDRESS, gev://serial/NUMBER or u3v://serial/NUMBER");
}

}  // namespace binpick::drivers
