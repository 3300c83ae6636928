// A buffer that Aravis calls successful, looked at again: its parts, once every byte that the frame
// announces has been found to be there. Success is not proof: shortened packets and lying leaders
// come with it.
#pragma once

#include <arv.h>

#include <array>
#include <map>
#include <span>

#include "binpick/drivers/camera.hpp"
#include "genicam/payload_converter.hpp"

namespace binpick::drivers {

class ReceivedFrame {
 public:
  static constexpr int kPartsMax = 16;

  struct Rules {
    std::map<std::uint32_t, PixelFormat> formats;  // the sensor's own numbers
    bool mono16_is_depth = false;                  // of a single image
    bool big_endian_chunks = true;
  };

  // kNone, and parts() borrows from the buffer; or why the frame is no good. Allocates nothing.
  DropReason read(ArvBuffer* buffer, std::size_t buffer_bytes, const Rules& rules);
  std::span<const PayloadPart> parts() const { return {parts_.data(), part_count_}; }
  std::span<const std::uint8_t> bytes() const { return bytes_; }  // all that was received

 private:
  DropReason read_part(ArvBuffer* buffer, unsigned index, std::span<const std::uint8_t> received,
                       const Rules& rules);

  std::array<PayloadPart, kPartsMax> parts_;
  std::size_t part_count_ = 0;
  std::span<const std::uint8_t> bytes_;
};

}  // namespace binpick::drivers
