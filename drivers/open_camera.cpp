#include "binpick/drivers/open_camera.hpp"

#include "aravis/aravis_camera.hpp"
#include "replay/replay_camera.hpp"

namespace binpick::drivers {

bool is_live_sensor(const std::string& uri) {
  return uri.starts_with("gev://") || uri.starts_with("u3v://") || uri == "sim:gev";
}

std::unique_ptr<Camera> open_camera(const CameraSpec& spec) {
  const std::string& uri = spec.uri;
  if (is_live_sensor(uri)) return open_aravis_camera(spec);
  if (uri.starts_with("replay:")) return open_replay_camera(spec);
  throw SensorError(uri +
                    ": expected gev://ADDRESS, gev://serial/NUMBER, u3v://serial/NUMBER, "
                    "replay:DIR or sim:gev");
}

}  // namespace binpick::drivers
