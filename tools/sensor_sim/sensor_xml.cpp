#include "sensor_xml.hpp"

#include "chunk_data.hpp"
#include "feature_map.hpp"
#include "pixel_encoder.hpp"
#include "transport_registers.hpp"
#include "xml_builder.hpp"

namespace binpick::sim {
namespace {

constexpr Access kRo = Access::kReadOnly;
constexpr Access kRw = Access::kReadWrite;

RegisterPlace at(std::uint64_t address) {
  return {address, "", 4, "Device"};
}

EnumEntries coordinates() {
  return {
      {"CoordinateA", kCoordinateA}, {"CoordinateB", kCoordinateB}, {"CoordinateC", kCoordinateC}};
}

const EnumEntries kOutputModes = {{"CalibratedABC_Grid", kCalibratedAbcGrid},
                                  {"ProjectedC", kProjectedC},
                                  {"DisparityC", kDisparityC}};
const EnumEntries kDistanceUnits = {{"Millimeter", kMillimeter}, {"Pixel", kPixel}};

void add_device_control(XmlBuilder& xml, Transport transport) {
  xml.category("DeviceControl");
  if (transport == Transport::kGigE) {
    xml.text("DeviceVendorName", gev::kManufacturerName, 32, kRo);
    xml.text("DeviceModelName", gev::kModelName, 32, kRo);
    xml.text("DeviceVersion", gev::kDeviceVersion, 32, kRo);
    xml.text("DeviceManufacturerInfo", gev::kManufacturerInfo, 48, kRo);
    xml.text("DeviceSerialNumber", gev::kSerialNumber, 16, kRo);
    xml.text("DeviceUserID", gev::kUserDefinedName, 16, kRw);
  } else {
    xml.text("DeviceVendorName", u3v::kManufacturerName, 64, kRo);
    xml.text("DeviceModelName", u3v::kModelName, 64, kRo);
    xml.text("DeviceVersion", u3v::kDeviceVersion, 64, kRo);
    xml.text("DeviceManufacturerInfo", u3v::kManufacturerInfo, 64, kRo);
    xml.text("DeviceSerialNumber", u3v::kSerialNumber, 64, kRo);
    xml.text("DeviceUserID", u3v::kUserDefinedName, 64, kRw);
  }
  xml.command("DeviceReset", kDeviceReset);
}

void add_image_format(XmlBuilder& xml, const Personality& personality) {
  xml.category("ImageFormatControl");
  xml.integer("SensorWidth", at(kSensorWidth), kRo);
  xml.integer("SensorHeight", at(kSensorHeight), kRo);
  xml.integer("Width", at(kWidth), kRw);
  xml.integer("Height", at(kHeight), kRw);
  xml.integer("OffsetX", at(kOffsetX), kRw);
  xml.integer("OffsetY", at(kOffsetY), kRw);
  xml.enumeration("ComponentSelector", at(kComponentSelector), kRw,
                  {{personality.range_component, kRange},
                   {"Intensity", kIntensity},
                   {"Confidence", kConfidence}});
  const auto by_component = [](std::uint64_t address) {
    return RegisterPlace{address, "ComponentSelector", 4, "Device"};
  };
  xml.boolean("ComponentEnable", by_component(kComponentEnable), kRw);
  xml.integer("ComponentIDValue", by_component(kComponentId), kRo);
  EnumEntries formats;
  for (const PixelEncoder& encoder : pixel_encoders()) {
    const bool listed = !formats.empty() && [&] {
      for (const auto& [name, value] : formats) {
        if (value == encoder.format) return true;
      }
      return false;
    }();
    if (!listed) formats.push_back({encoder.name, encoder.format});
  }
  xml.enumeration("PixelFormat", by_component(kPixelFormat), kRw, formats);
  xml.selects("ComponentSelector", {"ComponentEnable", "ComponentIDValue", "PixelFormat"});
}

void add_acquisition(XmlBuilder& xml) {
  xml.category("AcquisitionControl");
  xml.enumeration(
      "AcquisitionMode", at(kAcquisitionMode), kRw,
      {{"Continuous", kContinuous}, {"SingleFrame", kSingleFrame}, {"MultiFrame", kMultiFrame}});
  xml.command("AcquisitionStart", kAcquisitionStart);
  xml.command("AcquisitionStop", kAcquisitionStop);
  xml.integer("AcquisitionFrameCount", at(kAcquisitionFrameCount), kRw, IntegerLimits{1, 65535, 1});
  xml.floating("AcquisitionFrameRate", at(kAcquisitionFrameRate), kRw, "Hz", {{0.01, 1000.0}});
  xml.enumeration("TriggerSelector", at(kTriggerSelector), kRw, {{"FrameStart", 0}});
  xml.enumeration("TriggerMode", at(kTriggerMode), kRw, {{"Off", 0}, {"On", 1}});
  xml.enumeration(
      "TriggerSource", at(kTriggerSource), kRw,
      {{"Software", kSourceSoftware}, {"Line0", kSourceLine0}, {"Line1", kSourceLine1}});
  xml.enumeration("TriggerActivation", at(kTriggerActivation), kRw,
                  {{"RisingEdge", 0}, {"FallingEdge", 1}});
  xml.command("TriggerSoftware", kTriggerSoftware);
  xml.selects("TriggerSelector",
              {"TriggerMode", "TriggerSource", "TriggerActivation", "TriggerSoftware"});
  xml.enumeration("ExposureAuto", at(kExposureAuto), kRw, {{"Off", 0}, {"Continuous", 1}});
  xml.floating("ExposureTime", at(kExposureTime), kRw, "us", {{10.0, 1e6}});
  xml.integer("TriggersMissed", at(kTriggersMissed), kRo);
  xml.category("AnalogControl");
  xml.floating("Gain", at(kGain), kRw, "dB", {{0.0, 24.0}});
}

void add_scan3d(XmlBuilder& xml) {
  xml.category("Scan3dControl");
  xml.enumeration("Scan3dOutputMode", at(kOutputMode), kRo, kOutputModes);
  xml.enumeration("Scan3dDistanceUnit", at(kDistanceUnit), kRo, kDistanceUnits);
  xml.enumeration("Scan3dCoordinateSelector", at(kCoordinateSelector), kRw, coordinates());
  const auto by_axis = [](std::uint64_t address, int stride) {
    return RegisterPlace{address, "Scan3dCoordinateSelector", stride, "Device"};
  };
  xml.floating("Scan3dCoordinateScale", by_axis(kCoordinateScale, 8), kRo);
  xml.floating("Scan3dCoordinateOffset", by_axis(kCoordinateOffset, 8), kRo);
  xml.boolean("Scan3dInvalidDataFlag", by_axis(kInvalidDataFlag, 4), kRo);
  xml.floating("Scan3dInvalidDataValue", by_axis(kInvalidDataValue, 8), kRo);
  xml.floating("Scan3dAxisMin", by_axis(kAxisMin, 8), kRo);
  xml.floating("Scan3dAxisMax", by_axis(kAxisMax, 8), kRo);
  xml.selects("Scan3dCoordinateSelector",
              {"Scan3dCoordinateScale", "Scan3dCoordinateOffset", "Scan3dInvalidDataFlag",
               "Scan3dInvalidDataValue", "Scan3dAxisMin", "Scan3dAxisMax"});
  xml.floating("Scan3dFocalLength", at(kFocalLength), kRo, "px");
  // As Helios2 names them; and how rc_visard is told to send the components of a moment together,
  // as this sensor does in any case.
  xml.floating("CalibFocalLengthX", at(kFocalLength), kRo, "px");
  xml.floating("CalibOpticalCenterX", at(kPrincipalPointU), kRo, "px");
  xml.floating("CalibOpticalCenterY", at(kPrincipalPointV), kRo, "px");
  xml.enumeration("AcquisitionMultiPartMode", at(kMultiPartMode), kRw,
                  {{"SingleComponent", 0}, {"SynchronizedComponents", 1}});
  xml.floating("Scan3dAspectRatio", at(kAspectRatio), kRo);
  xml.floating("Scan3dPrincipalPointU", at(kPrincipalPointU), kRo, "px");
  xml.floating("Scan3dPrincipalPointV", at(kPrincipalPointV), kRo, "px");
  xml.floating("Scan3dBaseline", at(kBaseline), kRo, "m");
}

void add_chunks(XmlBuilder& xml) {
  xml.category("ChunkDataControl");
  xml.boolean("ChunkModeActive", at(kChunkModeActive), kRw);
  EnumEntries entries;
  for (std::uint32_t i = 0; i < kChunkCount; ++i)
    entries.push_back({chunk_name(static_cast<Chunk>(i)), i});
  xml.enumeration("ChunkSelector", at(kChunkSelector), kRw, entries);
  xml.boolean("ChunkEnable", {kChunkEnable, "ChunkSelector", 4, "Device"}, kRw);
  xml.selects("ChunkSelector", {"ChunkEnable"});
  // A host that reads chunks has the buffer alone, hence no register to keep the selector in.
  xml.host_enumeration("ChunkScan3dCoordinateSelector", coordinates(), kCoordinateC);
  for (std::uint32_t i = kChunkTimestamp; i < kChunkCount; ++i) {
    const auto chunk = static_cast<Chunk>(i);
    const std::string name = std::string("Chunk") + chunk_name(chunk);
    const std::string port = name + "Port";
    xml.chunk_port(port, i + 1);
    const RegisterPlace place{0, "", 4, port};
    const auto by_axis = [&](int stride) {
      return RegisterPlace{0, "ChunkScan3dCoordinateSelector", stride, port};
    };
    if (chunk == kChunkOutputMode) {
      xml.enumeration(name, place, kRo, kOutputModes);
    } else if (chunk == kChunkDistanceUnit) {
      xml.enumeration(name, place, kRo, kDistanceUnits);
    } else if (chunk == kChunkInvalidDataFlag) {
      xml.boolean(name, by_axis(4), kRo);
    } else if (chunk_size(chunk) == 8 * kCoordinateCount) {
      xml.floating(name, by_axis(8), kRo);
    } else if (chunk < kChunkFocalLength) {
      xml.integer(name, place, kRo, std::nullopt, chunk_size(chunk));
    } else {
      xml.floating(name, place, kRo);
    }
  }
}

void add_gev_transport(XmlBuilder& xml) {
  using namespace gev;
  xml.integer("GevHeartbeatTimeout", at(kHeartbeatTimeout), kRw, IntegerLimits{500, 600000, 1});
  xml.integer("GevTimestampTickFrequency", at(kTimestampTickFrequency), kRo, std::nullopt, 8);
  xml.command("GevTimestampControlLatch", kTimestampControl, 2);
  xml.command("GevTimestampControlReset", kTimestampControl, 1);
  xml.integer("GevTimestampValue", at(kTimestampValue), kRo, std::nullopt, 8);
  xml.integer("GevCCP", at(kControlPrivilege), kRw);
  xml.integer("GevSCPHostPort", at(kStreamPort), kRw, IntegerLimits{0, 65535, 1});
  xml.bit_flag("GevSCPSFireTestPacket", kPacketSize, 31, kRw);
  xml.bit_flag("GevSCPSDoNotFragment", kPacketSize, 30, kRw);
  xml.bit_field("GevSCPSPacketSize", kPacketSize, 0, 15, kRw,
                IntegerLimits{kPacketSizeMin, kPacketSizeMax, 4});
  xml.integer("GevSCPD", at(kPacketDelay), kRw, IntegerLimits{0, 10000000, 1});
  xml.integer("GevSCDA", at(kStreamAddress), kRw);
  xml.bit_enumeration("GevGVSPExtendedIDMode", kGvspConfiguration, 30, {{"Off", 0}, {"On", 1}});
  xml.bit_flag("GevSCCFGMultiPart", kStreamConfiguration, kMultipartBit, kRw);
}

}  // namespace

ByteOrder byte_order_of(Transport transport) {
  return transport == Transport::kGigE ? ByteOrder::kBig : ByteOrder::kLittle;
}

std::string sensor_xml(Transport transport, const SensorName& name,
                       const Personality& personality) {
  XmlBuilder xml(byte_order_of(transport));
  add_device_control(xml, transport);
  add_image_format(xml, personality);
  add_acquisition(xml);
  add_scan3d(xml);
  add_chunks(xml);
  xml.category("TransportLayerControl");
  xml.integer("PayloadSize", at(kPayloadSize), kRo);
  xml.integer("TLParamsLocked", at(kTLParamsLocked), kRw, IntegerLimits{0, 1, 1});
  if (transport == Transport::kGigE) add_gev_transport(xml);
  return xml.document(name.vendor, name.model);
}

}  // namespace binpick::sim
