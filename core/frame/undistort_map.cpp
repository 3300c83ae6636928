#include "binpick/frame/undistort_map.hpp"

#include <algorithm>
#include <cmath>

namespace binpick {
namespace {

constexpr int kSideMin = 2, kSideMax = 65535;

std::size_t pixels(int width, int height) {
  return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
}

}  // namespace

bool UndistortMap::fits(int width, int height) {
  return std::min(width, height) >= kSideMin && std::max(width, height) <= kSideMax;
}

std::size_t UndistortMap::footprint(int width, int height) {
  return Arena::padded(pixels(width, height) * sizeof(Place));
}

UndistortMap::UndistortMap(const LensDistortion& lens, const CameraIntrinsics& camera, Arena& arena)
    : width_(camera.width),
      height_(camera.height),
      places_(arena.take<Place>(pixels(width_, height_))) {
  BINPICK_ASSERT(fits(width_, height_));
  std::size_t i = 0;
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      const Vec2 p = lens.distort({(x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy});
      places_[i++] = place_of({p.x() * camera.fx + camera.cx, p.y() * camera.fy + camera.cy});
    }
  }
}

UndistortMap::Place UndistortMap::place_of(const Vec2& pixel) const {
  Place place;
  if (!pixel.allFinite()) return place;
  const auto on_axis = [&](double at, int size, std::uint16_t& whole, std::uint8_t& rest) {
    const long in_256ths = std::lround(256 * std::clamp(at, 0.0, size - 1.0));
    // The last column has no right neighbour: it is nearly all of the last but one's.
    whole = static_cast<std::uint16_t>(std::min<long>(in_256ths / 256, size - 2));
    rest = static_cast<std::uint8_t>(std::min<long>(in_256ths - 256 * whole, 255));
    return at >= -0.5 && at < size - 0.5;
  };
  const bool x_inside = on_axis(pixel.x(), width_, place.x, place.right_256ths);
  const bool y_inside = on_axis(pixel.y(), height_, place.y, place.down_256ths);
  place.inside = x_inside && y_inside;
  return place;
}

void UndistortMap::depth(ImageView<const float> raw, ImageView<float> out) const {
  BINPICK_ASSERT(raw.width == width_ && raw.height == height_);
  BINPICK_ASSERT(out.width == width_ && out.height == height_);
  const Place* place = places_.data();
  for (int y = 0; y < height_; ++y) {
    float* to = out.row(y);
    for (int x = 0; x < width_; ++x, ++place) {
      const float nearest =
          raw.at(place->x + (place->right_256ths >> 7), place->y + (place->down_256ths >> 7));
      to[x] = place->inside != 0 ? nearest : 0;
    }
  }
}

void UndistortMap::intensity(ImageView<const std::uint8_t> raw, ImageView<std::uint8_t> out) const {
  BINPICK_ASSERT(raw.width == width_ && raw.height == height_);
  BINPICK_ASSERT(out.width == width_ && out.height == height_);
  const Place* place = places_.data();
  for (int y = 0; y < height_; ++y) {
    std::uint8_t* to = out.row(y);
    for (int x = 0; x < width_; ++x, ++place) {
      const std::uint8_t* upper = raw.row(place->y) + place->x;
      const std::uint8_t* lower = upper + raw.stride;
      const unsigned right = place->right_256ths, down = place->down_256ths;
      const unsigned above = upper[0] * (256 - right) + upper[1] * right;
      const unsigned below = lower[0] * (256 - right) + lower[1] * right;
      to[x] = static_cast<std::uint8_t>((above * (256 - down) + below * down + 32768) >> 16);
    }
  }
}

}  // namespace binpick
