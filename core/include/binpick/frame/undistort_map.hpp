// Removes lens distortion from images: for each pixel of the pinhole image its place in the
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

  // Images are without gaps between their rows (asserted).
  // The measured pixel that is nearest, never a mixture of two: across a step that would be a depth
  // where nothing is. 0 where the place is outside of the image.
  void depth(ImageView<const float> raw, ImageView<float> out) const;
  // Bilinear. Places outside of the image continue its border, so that they show no edge.
  void intensity(ImageView<const std::uint8_t> raw, ImageView<std::uint8_t> out) const;

 private:
  struct Place {
    std::uint32_t upper_left = 0;                    // pixels from the first one
    std::uint8_t right_256ths = 0, down_256ths = 0;  // from there on
    std::uint8_t nearest = 0;                        // of the four pixels: 1 right, 2 down
    std::uint8_t inside = 0;
  };
  Place place_of(const Vec2& pixel) const;
  template <class T>
  void check(ImageView<const T> raw, ImageView<T> out) const;

  int width_, height_;
  std::span<Place> places_;
};

}  // namespace binpick
