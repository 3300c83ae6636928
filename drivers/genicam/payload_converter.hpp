// Turns the parts of a received frame into the one frame type, inside a slot of the pool. Knows
// bytes, pixel formats and Scan3d values, no device library. Every size is checked against the
// bytes that are there; whatever does not fit is a DropReason.
// Allocates in the constructor only. Thread: one at a time.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "binpick/drivers/camera.hpp"
#include "genicam/depth_table.hpp"
#include "genicam/payload_part.hpp"
#include "genicam/point_grid.hpp"
#include "genicam/scan3d.hpp"

namespace binpick::drivers {

struct PayloadParams {
  int width_max = 0, height_max = 0;  // of the pool's slots
  // The size of the sensor's largest image: the depth has this size or divides both sides by the
  // same number. 0: any size.
  int sensor_width = 0, sensor_height = 0;
  // Share of full confidence that a measurement needs; 0: any but none at all.
  double confidence_min = 0;
};

class PayloadConverter {
 public:
  explicit PayloadConverter(const PayloadParams& params);

  // Fills depth, intensity (empty where no part has it) and camera of the slot's frame. `scan3d` is
  // usable. kNone, or why the frame cannot be used; the slot's content is then undefined.
  DropReason convert(std::span<const PayloadPart> parts, const Scan3d& scan3d, FrameSlot& slot);

 private:
  DropReason check(const PayloadPart& depth, const PayloadPart* intensity,
                   const PayloadPart* confidence) const;
  bool sensor_size(int width, int height) const;
  void convert_intensity(const PayloadPart& part, int width, int height, std::uint8_t* gray);
  void convert_depth(const PayloadPart& part, const PayloadPart* confidence, const Scan3d& scan3d,
                     FrameSlot& slot);
  void convert_points(const PayloadPart& part, const PayloadPart* intensity,
                      const PayloadPart* confidence, const Scan3d& scan3d, FrameSlot& slot);

  PayloadParams params_;
  DepthTable table_;
  std::vector<std::uint8_t> gray_scratch_;
  GridScratch grid_scratch_;
};

}  // namespace binpick::drivers
