#include "binpick/drivers/sensor_list.hpp"

#include "aravis/connection.hpp"
#include "aravis/features.hpp"
#include "binpick/drivers/camera.hpp"

namespace binpick::drivers {
namespace {

std::string text_of(const char* text) {
  return text != nullptr ? text : "";
}

constexpr const char* kFeatures[] = {"DeviceVendorName",
                                     "DeviceModelName",
                                     "DeviceSerialNumber",
                                     "DeviceVersion",
                                     "Width",
                                     "Height",
                                     "PixelFormat",
                                     "PayloadSize",
                                     "AcquisitionMode",
                                     "AcquisitionFrameRate",
                                     "TriggerMode",
                                     "TriggerSource",
                                     "TriggerSoftware",
                                     "ExposureTime",
                                     "Gain",
                                     "Scan3dOutputMode",
                                     "Scan3dDistanceUnit",
                                     "Scan3dFocalLength",
                                     "Scan3dAspectRatio",
                                     "Scan3dPrincipalPointU",
                                     "Scan3dPrincipalPointV",
                                     "Scan3dBaseline",
                                     "ChunkModeActive",
                                     "GevSCPSPacketSize",
                                     "GevGVSPExtendedIDMode"};
constexpr const char* kAxisFeatures[] = {"Scan3dCoordinateScale", "Scan3dCoordinateOffset",
                                         "Scan3dInvalidDataFlag", "Scan3dInvalidDataValue"};

FeatureReading read(const Features& features, const std::string& name, const std::string& label) {
  FeatureReading reading{label, "", features.has(name)};
  if (!reading.present || name == "TriggerSoftware") return reading;  // a command has no value
  try {
    reading.value = features.text(name);
  } catch (const SensorError& e) {
    reading.value = std::string("(") + e.what() + ")";
  }
  return reading;
}

std::string host_address_of(ArvCamera* camera) {
  ArvDevice* device = arv_camera_get_device(camera);
  if (!ARV_IS_GV_DEVICE(device)) return "";
  GSocketAddress* address = arv_gv_device_get_interface_address(ARV_GV_DEVICE(device));
  if (address == nullptr) return "";
  GInetAddress* inet = g_inet_socket_address_get_address(G_INET_SOCKET_ADDRESS(address));
  const std::unique_ptr<char, GFree> text(g_inet_address_to_string(inet));
  return text_of(text.get());
}

}  // namespace

std::vector<SensorEntry> list_sensors() {
  const std::scoped_lock lock(sensor_list_mutex(false), sensor_list_mutex(true));
  arv_update_device_list();
  std::vector<SensorEntry> sensors;
  for (unsigned i = 0; i < arv_get_n_devices(); ++i) {
    SensorEntry sensor;
    sensor.protocol = text_of(arv_get_device_protocol(i));
    if (sensor.protocol != "GigEVision" && sensor.protocol != "USB3Vision") continue;
    sensor.vendor = text_of(arv_get_device_vendor(i));
    sensor.model = text_of(arv_get_device_model(i));
    sensor.serial = text_of(arv_get_device_serial_nbr(i));
    const bool usb = sensor.protocol == "USB3Vision";
    if (!usb) sensor.address = text_of(arv_get_device_address(i));
    sensor.uri = (usb ? "u3v://serial/" : "gev://serial/") + sensor.serial;
    sensors.push_back(sensor);
  }
  return sensors;
}

SensorReport read_sensor_report(const std::string& uri) {
  const GObjectPtr<ArvCamera> camera = connect_sensor(uri);
  const Features features(camera.get(), uri);
  SensorReport report;
  report.vendor = text_of(arv_camera_get_vendor_name(camera.get(), nullptr));
  report.model = text_of(arv_camera_get_model_name(camera.get(), nullptr));
  report.serial = text_of(arv_camera_get_device_serial_number(camera.get(), nullptr));
  report.gige = arv_camera_is_gv_device(camera.get()) != FALSE;
  report.host_address = host_address_of(camera.get());
  if (report.gige)
    report.packet_size_bytes =
        static_cast<int>(arv_camera_gv_auto_packet_size(camera.get(), nullptr));
  report.payload_bytes = arv_camera_get_payload(camera.get(), nullptr);
  for (const char* name : kFeatures) report.features.push_back(read(features, name, name));
  for (const char* axis : {"A", "B", "C"}) {
    try {
      features.set("Scan3dCoordinateSelector", std::string("Coordinate") + axis);
    } catch (const SensorError&) {
      report.features.push_back({std::string("Scan3dCoordinateSelector ") + axis, "", false});
      continue;
    }
    for (const char* name : kAxisFeatures)
      report.features.push_back(read(features, name, std::string(name) + " " + axis));
  }
  return report;
}

}  // namespace binpick::drivers
