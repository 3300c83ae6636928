// A GigE Vision or USB3 Vision sensor through Aravis. Aravis receives on a thread of its own into
// buffers that lie in this object's memory; wait_frame converts on the caller's thread.
// Aravis and GLib take small blocks from the heap on their thread and inside register accesses.
#pragma once

#include <memory>

#include "binpick/drivers/camera.hpp"
#include "binpick/drivers/camera_spec.hpp"

namespace binpick::drivers {

// Connects. Throws SensorError; an absent sensor takes seconds to be found absent.
std::unique_ptr<Camera> open_aravis_camera(const CameraSpec& spec);

}  // namespace binpick::drivers
