// Modbus TCP frames for tests, byte by byte, right and wrong.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <vector>

namespace binpick::modbus {

using Bytes = std::vector<std::uint8_t>;

inline void put_word(Bytes& bytes, int word) {
  bytes.push_back(static_cast<std::uint8_t>(word >> 8));
  bytes.push_back(static_cast<std::uint8_t>(word & 0xFF));
}

inline Bytes frame_of(const Bytes& pdu, int transaction = 1, int unit = 1) {
  Bytes bytes;
  put_word(bytes, transaction);
  put_word(bytes, 0);
  put_word(bytes, static_cast<int>(pdu.size()) + 1);
  bytes.push_back(static_cast<std::uint8_t>(unit));
  bytes.insert(bytes.end(), pdu.begin(), pdu.end());
  return bytes;
}

inline Bytes read_pdu(int address, int count, int function = 3) {
  Bytes pdu = {static_cast<std::uint8_t>(function)};
  put_word(pdu, address);
  put_word(pdu, count);
  return pdu;
}

inline Bytes write_one_pdu(int address, int value) {
  return read_pdu(address, value, 6);
}

inline Bytes write_many_pdu(int address, const std::vector<std::uint16_t>& values) {
  Bytes pdu = read_pdu(address, static_cast<int>(values.size()), 16);
  pdu.push_back(static_cast<std::uint8_t>(2 * values.size()));
  for (const int value : values) put_word(pdu, value);
  return pdu;
}

inline Bytes read_write_pdu(int read_address, int read_count, int write_address,
                            const std::vector<std::uint16_t>& values) {
  Bytes pdu = read_pdu(read_address, read_count, 23);
  put_word(pdu, write_address);
  put_word(pdu, static_cast<int>(values.size()));
  pdu.push_back(static_cast<std::uint8_t>(2 * values.size()));
  for (const int value : values) put_word(pdu, value);
  return pdu;
}

}  // namespace binpick::modbus
