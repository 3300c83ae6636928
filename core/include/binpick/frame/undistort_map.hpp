// Takes the lens distortion out of images: for each pixel of the pinhole image its place in the
// image as the lens shows it. Made once for a camera; using it allocates nothing.
// Thread: any; immutable.
#pragma once

#include <cstdint>
#include <span>

#include "binpick/base/arena.hpp"
#include "binpick/frame/image_view.hpp"
#include "binpick/geometry/lens_distortion.hpp"

namespace binpick {

class UndistortMap {
 public:
  // Sizes that it can be made for.
  static bool fits(int width, int height);
  // What the constructor takes from its arena.
  static std::size_t footprint(int width, int height);
  // Both images have these intrinsics. Each side is 2 to 65535 px, and fold_radius_px() finds
  // nothing (asserted is the size).
  UndistortMap(const LensDistortion& lens, const CameraIntrinsics& camera, Arena& arena);

  // The measured pixel that is nearest, never a mixture of two: across a step that would be a depth
  // where nothing is. 0 where the place is outside of the image.
  void depth(ImageView<const float> raw, ImageView<float> out) const;
  // Bilinear. Places outside of the image continue its border, so that they show no edge.
  void intensity(ImageView<const std::uint8_t> raw, ImageView<std::uint8_t> out) const;

 private:
  struct Place {
    std::uint16_t x = 0, y = 0;                      // of the pixel at the upper left
    std::uint8_t right_256ths = 0, down_256ths = 0;  // from it on
    std::uint8_t inside = 0;
  };
  Place place_of(const Vec2& pixel) const;

  int width_, height_;
  std::span<Place> places_;
};

}  // namespace binpick
