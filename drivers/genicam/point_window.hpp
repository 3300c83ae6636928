// The image that points with gray are projected into, row of points by row. Depth and gray are two
// images, and following a point into both costs half as much again as into one. So the pixels that
// the next rows will meet are held as keys (point_keys.hpp), in a ring that fits into the second
// cache, and become depth and gray as soon as the rows have passed. A row may reach beyond the
// window: its points that do are compared in the images themselves, one by one, with the same
// result. Time: linear in the points, whatever their targets. Allocates in the constructor only.
// Thread: one at a time.
#pragma once

#include <cstdint>
#include <vector>

#include "genicam/point_keys.hpp"

namespace binpick::drivers {

class PointWindow {
 public:
  // For images of rows up to width_max. `orders`: how many points are told apart by their order
  // before what came is written to the images and read again; less than all for tests alone.
  explicit PointWindow(int width_max, std::uint32_t orders = kPointOrders);

  // The images, borrowed until finish(). width * height fits an int.
  void begin(int width, int height, float* depth_mm, std::uint8_t* gray);
  // Up to width_max points, after all that came before: the nearest stays, of equal ones the first.
  // Targets are pixels; a point of depth kNoPoint is none.
  void add_row(const float* points_mm, const std::uint8_t* points_gray, const std::int32_t* target,
               int points_count);
  // The images are complete: 0 where no point came.
  void finish();

 private:
  std::int64_t size() const { return static_cast<std::int64_t>(keys_.size()); }
  std::int64_t end() const { return begin_ + size(); }
  bool holds(TargetSpan span) const { return span.first >= begin_ && span.last < end(); }
  void follow(TargetSpan span);
  void move_to(std::int64_t pixel);
  void add_direct(std::int32_t to, float depth_mm, std::uint8_t gray);
  void load(std::int64_t from, std::int64_t to);
  void store(std::int64_t from, std::int64_t to);
  void clear_images(std::int64_t to);

  const std::uint32_t orders_;
  // Of pixel p: keys_[p modulo their number, a power of two]. Empty outside of the window.
  std::vector<double> keys_;
  std::vector<double> row_keys_;  // of the points
  std::int64_t count_ = 0;
  float* depth_mm_ = nullptr;
  std::uint8_t* gray_ = nullptr;
  std::int64_t begin_ = 0;        // first pixel of the window
  std::int64_t lag_ = 0;          // of the window behind the points
  std::int64_t known_ = 0;        // pixels below are in the images or in the window
  std::int64_t moves_left_ = 0;   // pixels that the window may still move
  std::uint32_t next_order_ = 1;  // 0: what came from the images
};

}  // namespace binpick::drivers
