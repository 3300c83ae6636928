// Hand-made parts of a frame for tests: codes in, little-endian bytes out.
#pragma once

#include <cstring>
#include <vector>

#include "genicam/payload_converter.hpp"

namespace binpick::drivers {

template <class T>
std::vector<std::uint8_t> bytes_of(const std::vector<T>& codes) {
  std::vector<std::uint8_t> bytes(codes.size() * sizeof(T));
  std::memcpy(bytes.data(), codes.data(), bytes.size());
  return bytes;
}

inline PayloadPart part_of(PartRole role, PixelFormat format, int width, int height,
                           const std::vector<std::uint8_t>& bytes) {
  return {role, format, width, height, 0, bytes};
}

// A pool of one slot and a converter for frames of up to width x height.
struct Conversion {
  explicit Conversion(int width, int height, PayloadParams params = {})
      : arena(FramePool::footprint({1, width, height})),
        pool({1, width, height}, arena),
        converter([&] {
          params.width_max = width;
          params.height_max = height;
          return params;
        }()) {}

  DropReason run(const std::vector<PayloadPart>& parts, const Scan3d& scan3d) {
    frame.reset();
    frame = pool.try_take();
    return converter.convert(parts, scan3d, frame.slot());
  }
  std::vector<float> depth() const {
    const ImageView<const float>& d = frame.frame().depth_mm;
    return {d.data, d.data + static_cast<std::ptrdiff_t>(d.width) * d.height};
  }
  std::vector<int> gray() const {
    const ImageView<const std::uint8_t>& g = frame.frame().intensity;
    return {g.data, g.data + static_cast<std::ptrdiff_t>(g.width) * g.height};
  }

  Arena arena;
  FramePool pool;
  PayloadConverter converter;
  FrameRef frame;
};

// A pinhole camera that measures z in mm.
inline Scan3d millimetres(double focal_px = 100, double cu = 1, double cv = 1) {
  Scan3d scan3d;
  scan3d.focal_length_px = focal_px;
  scan3d.principal_u_px = cu;
  scan3d.principal_v_px = cv;
  return scan3d;
}

}  // namespace binpick::drivers
