// The GenICam description of the simulated sensor, with the names of the Standard Features Naming
// Convention. What is not standard: Scan3dAspectRatio (after SICK's Visionary: fy = f x ratio), and
// ChunkImageID and TriggersMissed, which are ours.
#pragma once

#include <string>

#include "byte_order.hpp"
#include "personality.hpp"

namespace binpick::sim {

enum class Transport { kGigE, kUsb3 };

struct SensorName {
  std::string vendor = "Binpick";
  std::string model = "Scan3D";
  std::string version = "1.0";
  std::string serial = "SIM0001";
  std::string user_name;
};

ByteOrder byte_order_of(Transport transport);

std::string sensor_xml(Transport transport, const SensorName& name, const Personality& personality);

}  // namespace binpick::sim
