#include "register_file.hpp"

#include <algorithm>

#include "binpick/base/assert.hpp"

namespace binpick::sim {

void RegisterFile::add_block(std::uint64_t address, std::size_t size) {
  const std::size_t whole = (size + 3) / 4 * 4;
  blocks_[address] = {std::vector<std::uint8_t>(whole, 0), std::vector<bool>(whole / 4, false)};
}

const RegisterFile::Block* RegisterFile::find(std::uint64_t address, std::size_t size,
                                              std::size_t& offset) const {
  auto it = blocks_.upper_bound(address);
  if (it == blocks_.begin()) return nullptr;
  --it;
  const std::uint64_t inside = address - it->first;
  const std::size_t block_size = it->second.bytes.size();
  if (inside >= block_size || size > block_size - inside) return nullptr;
  offset = static_cast<std::size_t>(inside);
  return &it->second;
}

RegisterFile::Block& RegisterFile::existing(std::uint64_t address, std::size_t size,
                                            std::size_t& offset) {
  const Block* block = find(address, size, offset);
  BINPICK_ASSERT(block != nullptr);
  return blocks_.at(address - offset);
}

void RegisterFile::allow_write(std::uint64_t address, std::size_t size) {
  std::size_t offset = 0;
  Block& block = existing(address, size, offset);
  for (std::size_t i = 0; i < size; i += 4) block.writable[(offset + i) / 4] = true;
}

AccessStatus RegisterFile::read(std::uint64_t address, std::span<std::uint8_t> out) const {
  if (address % 4 != 0 || out.size() % 4 != 0) return AccessStatus::kBadAlignment;
  std::size_t offset = 0;
  const Block* block = find(address, out.size(), offset);
  if (block == nullptr) return AccessStatus::kInvalidAddress;
  std::copy_n(block->bytes.begin() + static_cast<std::ptrdiff_t>(offset), out.size(), out.begin());
  return AccessStatus::kOk;
}

AccessStatus RegisterFile::check_write(std::uint64_t address, std::size_t size) const {
  if (address % 4 != 0 || size % 4 != 0) return AccessStatus::kBadAlignment;
  std::size_t offset = 0;
  const Block* block = find(address, size, offset);
  if (block == nullptr) return AccessStatus::kInvalidAddress;
  for (std::size_t i = 0; i < size; i += 4) {
    if (!block->writable[(offset + i) / 4]) return AccessStatus::kWriteProtected;
  }
  return AccessStatus::kOk;
}

void RegisterFile::store(std::uint64_t address, std::span<const std::uint8_t> bytes) {
  std::size_t offset = 0;
  Block& block = existing(address, bytes.size(), offset);
  std::copy(bytes.begin(), bytes.end(), block.bytes.begin() + static_cast<std::ptrdiff_t>(offset));
}

std::uint32_t RegisterFile::u32(std::uint64_t address) const {
  std::size_t offset = 0;
  const Block* block = find(address, 4, offset);
  BINPICK_ASSERT(block != nullptr);
  return get<std::uint32_t>(block->bytes.data() + offset, order_);
}

std::uint64_t RegisterFile::u64(std::uint64_t address) const {
  std::size_t offset = 0;
  const Block* block = find(address, 8, offset);
  BINPICK_ASSERT(block != nullptr);
  return get<std::uint64_t>(block->bytes.data() + offset, order_);
}

void RegisterFile::set_u32(std::uint64_t address, std::uint32_t value) {
  std::uint8_t bytes[4];
  put(bytes, value, order_);
  store(address, bytes);
}

void RegisterFile::set_u64(std::uint64_t address, std::uint64_t value) {
  std::uint8_t bytes[8];
  put(bytes, value, order_);
  store(address, bytes);
}

void RegisterFile::set_text(std::uint64_t address, std::size_t size, const std::string& text) {
  std::vector<std::uint8_t> bytes(size, 0);
  std::copy_n(text.begin(), std::min(text.size(), size - 1), bytes.begin());
  store(address, bytes);
}

}  // namespace binpick::sim
