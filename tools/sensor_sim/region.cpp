#include "region.hpp"

#include "binpick/base/assert.hpp"

namespace binpick::sim {
namespace {

template <class T>
std::vector<T> cut_rows(const std::vector<T>& image, int width, const Region& region) {
  std::vector<T> part;
  if (image.empty()) return part;
  part.reserve(static_cast<std::size_t>(region.width) * static_cast<std::size_t>(region.height));
  for (int y = region.y; y < region.y + region.height; ++y) {
    const auto row = image.begin() + static_cast<std::ptrdiff_t>(y) * width + region.x;
    part.insert(part.end(), row, row + region.width);
  }
  return part;
}

}  // namespace

SceneFrame cut_out(const SceneFrame& frame, const Region& region) {
  BINPICK_ASSERT(region.x >= 0 && region.y >= 0 && region.x + region.width <= frame.width &&
                 region.y + region.height <= frame.height);
  SceneFrame part;
  part.image_id = frame.image_id;
  part.width = region.width;
  part.height = region.height;
  part.depth_codes = cut_rows(frame.depth_codes, frame.width, region);
  part.gray = cut_rows(frame.gray, frame.width, region);
  part.depth_scale = frame.depth_scale;
  part.fx = frame.fx;
  part.fy = frame.fy;
  part.cx = frame.cx - region.x;
  part.cy = frame.cy - region.y;
  return part;
}

}  // namespace binpick::sim
