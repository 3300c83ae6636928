// The registers of a simulated sensor: bytes at addresses, some of them writable from outside.
// Thread: one at a time; its owner locks.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "byte_order.hpp"

namespace binpick::sim {

// What an access from outside comes to. Each transport has its own numbers for these.
enum class AccessStatus {
  kOk,
  kInvalidAddress,
  kBadAlignment,
  kWriteProtected,
  kInvalidParameter,
  kBusy,  // not while frames are being acquired
};

class RegisterFile {
 public:
  explicit RegisterFile(ByteOrder order) : order_(order) {}

  ByteOrder order() const { return order_; }

  // A block of memory, read-only from outside until allow_write. Blocks do not overlap.
  void add_block(std::uint64_t address, std::size_t size);
  void allow_write(std::uint64_t address, std::size_t size);

  // From outside. Address and size in whole words of four bytes.
  AccessStatus read(std::uint64_t address, std::span<std::uint8_t> out) const;
  AccessStatus check_write(std::uint64_t address, std::size_t size) const;

  // From inside: no access rules; the address has to exist.
  void store(std::uint64_t address, std::span<const std::uint8_t> bytes);
  std::uint32_t u32(std::uint64_t address) const;
  std::uint64_t u64(std::uint64_t address) const;
  double f64(std::uint64_t address) const { return double_of(u64(address)); }
  void set_u32(std::uint64_t address, std::uint32_t value);
  void set_u64(std::uint64_t address, std::uint64_t value);
  void set_f64(std::uint64_t address, double value) { set_u64(address, bits_of(value)); }
  // Cut to `size` with a closing zero.
  void set_text(std::uint64_t address, std::size_t size, const std::string& text);

 private:
  struct Block {
    std::vector<std::uint8_t> bytes;
    std::vector<bool> writable;  // by word
  };
  // The block that holds all of it and where in the block; nullptr when there is none.
  const Block* find(std::uint64_t address, std::size_t size, std::size_t& offset) const;
  Block& existing(std::uint64_t address, std::size_t size, std::size_t& offset);

  ByteOrder order_;
  std::map<std::uint64_t, Block> blocks_;  // by first address
};

}  // namespace binpick::sim
