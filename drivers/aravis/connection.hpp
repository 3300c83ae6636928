// A sensor found by its URI and connected.
#pragma once

#include <mutex>
#include <string>

#include "aravis/gobject_ptr.hpp"

namespace binpick::drivers {

// gev://ADDRESS, gev://serial/NUMBER, u3v://serial/NUMBER, sim:gev. Throws SensorError that names
// the URI.
GObjectPtr<ArvCamera> connect_sensor(const std::string& uri);

// A GigE Vision sensor has one controller; throws SensorError where it is another program.
void require_control(ArvCamera* camera, const std::string& uri);

// Aravis' lists of sensors on the network and on the USB bus: one user at a time each.
std::mutex& sensor_list_mutex(bool usb);

}  // namespace binpick::drivers
