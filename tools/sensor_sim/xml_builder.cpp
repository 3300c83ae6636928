#include "xml_builder.hpp"

#include <algorithm>
#include <cstdio>

namespace binpick::sim {
namespace {

std::string element(const std::string& name, const std::string& value) {
  return "<" + name + ">" + value + "</" + name + ">";
}

std::string hex(std::uint64_t value) {
  char text[24];
  std::snprintf(text, sizeof text, "0x%llX", static_cast<unsigned long long>(value));
  return text;
}

std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

const char* access_name(Access access) {
  switch (access) {
    case Access::kReadOnly:
      return "RO";
    case Access::kReadWrite:
      return "RW";
    case Access::kWriteOnly:
      return "WO";
  }
  return "RO";
}

std::string limits_body(const std::optional<IntegerLimits>& limits) {
  if (!limits) return "";
  return element("Min", std::to_string(limits->min)) + element("Max", std::to_string(limits->max)) +
         element("Inc", std::to_string(limits->increment));
}

std::string entries_body(const EnumEntries& entries) {
  std::string body;
  for (const auto& [name, value] : entries) {
    body += "<EnumEntry Name=\"" + name + "\">" + element("Value", std::to_string(value)) +
            "</EnumEntry>";
  }
  return body;
}

}  // namespace

void XmlBuilder::category(const std::string& name) {
  categories_.push_back({name, {}});
}

void XmlBuilder::add(const std::string& kind, const std::string& name, const std::string& body) {
  features_.push_back({kind, name, body, {}});
  categories_.back().second.push_back(name);
}

std::string XmlBuilder::register_body(const RegisterPlace& place, int bytes, Access access) const {
  std::string body = element("Address", hex(place.address));
  if (!place.selector.empty()) {
    body +=
        "<pIndex Offset=\"" + std::to_string(place.stride) + "\">" + place.selector + "</pIndex>";
  }
  // Nothing is cached: another host, a fault or the sensor itself may change any value.
  return body + element("Length", std::to_string(bytes)) +
         element("AccessMode", access_name(access)) + element("pPort", place.port) +
         element("Cachable", "NoCache");
}

std::string XmlBuilder::integer_register(const std::string& name, const RegisterPlace& place,
                                         int bytes, Access access) {
  registers_ += "<IntReg Name=\"" + name + "Reg\">" + register_body(place, bytes, access) +
                element("Sign", "Unsigned") +
                element("Endianess", order_ == ByteOrder::kBig ? "BigEndian" : "LittleEndian") +
                "</IntReg>\n";
  return element("pValue", name + "Reg");
}

std::string XmlBuilder::bit_register(const std::string& name, std::uint64_t address, int low,
                                     int high, Access access) {
  // GenICam counts the bits of a big-endian register from the most significant one.
  const bool big = order_ == ByteOrder::kBig;
  registers_ += "<MaskedIntReg Name=\"" + name + "Reg\">" +
                register_body({address, "", 4, "Device"}, 4, access) +
                element("LSB", std::to_string(big ? 31 - low : low)) +
                element("MSB", std::to_string(big ? 31 - high : high)) +
                element("Sign", "Unsigned") +
                element("Endianess", big ? "BigEndian" : "LittleEndian") + "</MaskedIntReg>\n";
  return element("pValue", name + "Reg");
}

void XmlBuilder::integer(const std::string& name, const RegisterPlace& place, Access access,
                         std::optional<IntegerLimits> limits, int bytes) {
  add("Integer", name, integer_register(name, place, bytes, access) + limits_body(limits));
}

void XmlBuilder::bit_field(const std::string& name, std::uint64_t address, int low, int high,
                           Access access, std::optional<IntegerLimits> limits) {
  add("Integer", name, bit_register(name, address, low, high, access) + limits_body(limits));
}

void XmlBuilder::bit_flag(const std::string& name, std::uint64_t address, int bit, Access access) {
  add("Boolean", name,
      bit_register(name, address, bit, bit, access) + element("OnValue", "1") +
          element("OffValue", "0"));
}

void XmlBuilder::boolean(const std::string& name, const RegisterPlace& place, Access access) {
  add("Boolean", name,
      integer_register(name, place, 4, access) + element("OnValue", "1") +
          element("OffValue", "0"));
}

void XmlBuilder::floating(const std::string& name, const RegisterPlace& place, Access access,
                          const std::string& unit,
                          std::optional<std::pair<double, double>> limits) {
  registers_ += "<FloatReg Name=\"" + name + "Reg\">" + register_body(place, 8, access) +
                element("Endianess", order_ == ByteOrder::kBig ? "BigEndian" : "LittleEndian") +
                "</FloatReg>\n";
  std::string body = element("pValue", name + "Reg");
  if (limits)
    body += element("Min", number(limits->first)) + element("Max", number(limits->second));
  if (!unit.empty()) body += element("Unit", unit);
  add("Float", name, body);
}

void XmlBuilder::enumeration(const std::string& name, const RegisterPlace& place, Access access,
                             const EnumEntries& entries) {
  add("Enumeration", name, entries_body(entries) + integer_register(name, place, 4, access));
}

void XmlBuilder::bit_enumeration(const std::string& name, std::uint64_t address, int bit,
                                 const EnumEntries& entries) {
  add("Enumeration", name,
      entries_body(entries) + bit_register(name, address, bit, bit, Access::kReadWrite));
}

void XmlBuilder::host_enumeration(const std::string& name, const EnumEntries& entries,
                                  std::uint32_t initial) {
  add("Enumeration", name, entries_body(entries) + element("Value", std::to_string(initial)));
}

void XmlBuilder::command(const std::string& name, std::uint64_t address, std::uint32_t value) {
  const std::string reg = integer_register(name, {address, "", 4, "Device"}, 4, Access::kReadWrite);
  add("Command", name, reg + element("CommandValue", std::to_string(value)));
}

void XmlBuilder::text(const std::string& name, std::uint64_t address, int length, Access access) {
  add("StringReg", name, register_body({address, "", 4, "Device"}, length, access));
}

void XmlBuilder::chunk_port(const std::string& name, std::uint32_t chunk_id) {
  char id[16];
  std::snprintf(id, sizeof id, "%08x", chunk_id);
  registers_ += "<Port Name=\"" + name + "\">" + element("ChunkID", id) + "</Port>\n";
}

void XmlBuilder::selects(const std::string& selector, const std::vector<std::string>& features) {
  for (Feature& feature : features_) {
    if (feature.name == selector) feature.selected = features;
  }
}

std::string XmlBuilder::document(const std::string& vendor, const std::string& model) const {
  std::string xml =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<RegisterDescription ModelName=\"" +
      model + "\" VendorName=\"" + vendor +
      "\""
      " StandardNameSpace=\"None\" SchemaMajorVersion=\"1\" SchemaMinorVersion=\"1\""
      " SchemaSubMinorVersion=\"0\" MajorVersion=\"1\" MinorVersion=\"0\" SubMinorVersion=\"0\""
      " ToolTip=\"Simulated 3D sensor\" ProductGuid=\"3f1e6f2c-7f0a-4b52-9d0e-5a1c1b7b1a01\""
      " VersionGuid=\"3f1e6f2c-7f0a-4b52-9d0e-5a1c1b7b1a02\""
      " xmlns=\"http://www.genicam.org/GenApi/Version_1_1\">\n<Category Name=\"Root\""
      " NameSpace=\"Standard\">";
  for (const auto& [name, features] : categories_) xml += element("pFeature", name);
  xml += "</Category>\n";
  for (const auto& [name, features] : categories_) {
    xml += "<Category Name=\"" + name + "\" NameSpace=\"Standard\">";
    for (const std::string& feature : features) xml += element("pFeature", feature);
    xml += "</Category>\n";
  }
  for (const Feature& feature : features_) {
    xml += "<" + feature.kind + " Name=\"" + feature.name + "\" NameSpace=\"Standard\">" +
           feature.body;
    for (const std::string& selected : feature.selected) xml += element("pSelected", selected);
    xml += "</" + feature.kind + ">\n";
  }
  return xml + registers_ + "<Port Name=\"Device\" NameSpace=\"Standard\"></Port>\n" +
         "</RegisterDescription>\n";
}

}  // namespace binpick::sim
