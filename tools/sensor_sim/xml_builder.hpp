// Writes the nodes of a GenICam description. Every feature stands for registers of the device, so
// that what a host reads is what the sensor does; there are no constants in it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "byte_order.hpp"

namespace binpick::sim {

enum class Access { kReadOnly, kReadWrite, kWriteOnly };

// Where a value lies. With a selector, value n of the selector has it at address + n x stride.
struct RegisterPlace {
  std::uint64_t address = 0;
  std::string selector;
  int stride = 4;
  std::string port = "Device";
};

struct IntegerLimits {
  std::int64_t min = 0, max = 0xffffffff, increment = 1;
};

using EnumEntries = std::vector<std::pair<std::string, std::uint32_t>>;

class XmlBuilder {
 public:
  // `order`: of all registers.
  explicit XmlBuilder(ByteOrder order) : order_(order) {}

  // Features added from here on belong to this category.
  void category(const std::string& name);

  void integer(const std::string& name, const RegisterPlace& place, Access access,
               std::optional<IntegerLimits> limits = std::nullopt, int bytes = 4);
  // Bits of a four-byte register; bit 0 is the least significant one.
  void bit_field(const std::string& name, std::uint64_t address, int low, int high, Access access,
                 std::optional<IntegerLimits> limits = std::nullopt);
  void bit_flag(const std::string& name, std::uint64_t address, int bit, Access access);
  void boolean(const std::string& name, const RegisterPlace& place, Access access);
  // All floats take eight bytes, so that a scale such as 0.1 arrives as the double it is.
  void floating(const std::string& name, const RegisterPlace& place, Access access,
                const std::string& unit = "",
                std::optional<std::pair<double, double>> limits = std::nullopt);
  void enumeration(const std::string& name, const RegisterPlace& place, Access access,
                   const EnumEntries& entries);
  // An enumeration that lives in the host, as the selectors of chunk data do.
  void host_enumeration(const std::string& name, const EnumEntries& entries, std::uint32_t initial);
  void command(const std::string& name, std::uint64_t address, std::uint32_t value = 1);
  void text(const std::string& name, std::uint64_t address, int length, Access access);
  // The value is the one that makes the device's bit true; for enumerations on one bit.
  void bit_enumeration(const std::string& name, std::uint64_t address, int bit,
                       const EnumEntries& entries);
  void chunk_port(const std::string& name, std::uint32_t chunk_id);
  // Says that `selector` selects `features`.
  void selects(const std::string& selector, const std::vector<std::string>& features);

  // The whole document.
  std::string document(const std::string& vendor, const std::string& model) const;

 private:
  struct Feature {
    std::string kind, name, body;
    std::vector<std::string> selected;
  };
  void add(const std::string& kind, const std::string& name, const std::string& body);
  std::string register_body(const RegisterPlace& place, int bytes, Access access) const;
  std::string integer_register(const std::string& name, const RegisterPlace& place, int bytes,
                               Access access);
  std::string bit_register(const std::string& name, std::uint64_t address, int low, int high,
                           Access access);

  ByteOrder order_;
  std::vector<Feature> features_;
  std::string registers_;
  std::vector<std::pair<std::string, std::vector<std::string>>> categories_;
};

}  // namespace binpick::sim
