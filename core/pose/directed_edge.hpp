// Edges of the intensity that run the way a contour does: where nothing but the intensity is seen,
// an edge that crosses the contour is another's.
#pragma once

#include "pose/contour.hpp"

namespace binpick {

// Gray levels per pixel, by Sobel's filter at the nearest pixel of level 0; zero at the image's
// rim.
Vec2 gray_gradient(const Scene& scene, const Vec2& pixel);

// As match_contour(), without edges of another direction.
ContourMatch match_directed(const ContourPlace& place, const Scene& scene, int range_px);

}  // namespace binpick
