// A sensor found by its URI and connected.
#pragma once

#include <string>

#include "aravis/gobject_ptr.hpp"

namespace binpick::drivers {

// gev://ADDRESS, gev://serial/NUMBER, u3v://serial/NUMBER. Throws SensorError that names the URI.
GObjectPtr<ArvCamera> connect_sensor(const std::string& uri);

}  // namespace binpick::drivers
