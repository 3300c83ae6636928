#include "binpick/drivers/open_camera.hpp"

#include "aravis/aravis_camera.hpp"
#include "replay/replay_camera.hpp"

namespace binpick::drivers {

std::unique_ptr<Camera> open_camera(const CameraSpec& spec) {
  const std::string& uri = spec.uri;
  if (uri.starts_with("gev://") || uri.starts_with("u3v://")) return open_aravis_camera(spec);
  if (uri.starts_with("replay:")) return open_replay_camera(spec);
  if (uri == "sim:gev") {
    // The double is a program of its own, so that the whole way through the network is the
    // sensor's.
    CameraSpec simulated = spec;
    simulated.uri = "gev://127.0.0.1";
    try {
      return open_aravis_camera(simulated);
    } catch (const SensorError& e) {
      throw SensorError(std::string("sim:gev: ") + e.what() +
                        "; start it first: gvsim --scenes DIR");
    }
  }
  throw SensorError(uri +
                    ": expected gev://ADDRESS, gev://serial/NUMBER, u3v://serial/NUMBER, "
                    "replay:DIR or sim:gev");
}

}  // namespace binpick::drivers
