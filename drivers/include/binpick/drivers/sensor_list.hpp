// What GenICam sensors there are, and what one of them says of itself. Takes a second (the network
// is asked) and allocates: for set-up and for people.
#pragma once

#include <string>
#include <vector>

#include "binpick/drivers/camera_spec.hpp"

namespace binpick::drivers {

struct SensorEntry {
  std::string protocol;  // "GigEVision" or "USB3Vision"
  std::string vendor, model, serial;
  std::string address;  // of GigE Vision
  std::string uri;      // to open it by
};

std::vector<SensorEntry> list_sensors();

struct FeatureReading {
  std::string name,
      value;             // the axis after the name where it has several: "Scan3dCoordinateScale C"
  bool present = false;  // false: the sensor has no such feature
};

struct SensorReport {
  std::string vendor, model, serial;
  bool gige = false;
  std::string host_address;  // of the network interface that it is reached by
  int packet_size_bytes = 0;
  std::size_t payload_bytes = 0;
  std::vector<FeatureReading> features;  // those that matter for 3D, trigger and transport
};

// Connects, reads, disconnects. Throws SensorError.
SensorReport read_sensor_report(const std::string& uri);

}  // namespace binpick::drivers
