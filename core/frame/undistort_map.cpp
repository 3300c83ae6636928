#include "binpick/frame/undistort_map.hpp"

#include <algorithm>
#include <cmath>

namespace binpick {
namespace {

constexpr int kSideMin = 2, kSideMax = 65535;  // so that a place fits 32 bits

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
  const auto on_axis = [&](double at, int size, std::uint8_t& rest) {
    const long in_256ths = std::lround(256 * std::clamp(at, 0.0, size - 1.0));
    // The last column has no right neighbour: it is nearly all of the last but one's.
    const long whole = std::min<long>(in_256ths / 256, size - 2);
    rest = static_cast<std::uint8_t>(std::min<long>(in_256ths - 256 * whole, 255));
    return whole;
  };
  const long x = on_axis(pixel.x(), width_, place.right_256ths);
  const long y = on_axis(pixel.y(), height_, place.down_256ths);
  place.upper_left = static_cast<std::uint32_t>(y * width_ + x);
  place.nearest =
      static_cast<std::uint8_t>((place.right_256ths >> 7) + 2 * (place.down_256ths >> 7));
  place.inside = pixel.x() >= -0.5 && pixel.x() < width_ - 0.5 && pixel.y() >= -0.5 &&
                 pixel.y() < height_ - 0.5;
  return place;
}

template <class T>
void UndistortMap::check(ImageView<const T> raw, ImageView<T> out) const {
  BINPICK_ASSERT(raw.width == width_ && raw.height == height_ && raw.stride == width_);
  BINPICK_ASSERT(out.width == width_ && out.height == height_ && out.stride == width_);
}

void UndistortMap::depth(ImageView<const float> raw, ImageView<float> out) const {
  check(raw, out);
  const std::uint32_t step[4] = {0, 1, static_cast<std::uint32_t>(width_),
                                 static_cast<std::uint32_t>(width_) + 1};
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const Place& place = places_[i];
    const float nearest = raw.data[place.upper_left + step[place.nearest]];
    out.data[i] = place.inside != 0 ? nearest : 0;
  }
}

void UndistortMap::intensity(ImageView<const std::uint8_t> raw, ImageView<std::uint8_t> out) const {
  check(raw, out);
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const Place& place = places_[i];
    const std::uint8_t* upper = raw.data + place.upper_left;
    const std::uint8_t* lower = upper + width_;
    const int right = place.right_256ths, down = place.down_256ths;
    const int above = 256 * upper[0] + (upper[1] - upper[0]) * right;
    const int below = 256 * lower[0] + (lower[1] - lower[0]) * right;
    out.data[i] = static_cast<std::uint8_t>((256 * above + (below - above) * down + 32768) >> 16);
  }
}

}  // namespace binpick
