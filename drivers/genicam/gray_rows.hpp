// Gray and colour rows to 8 bits: of more than 8 significant bits the highest stay. Colour becomes
// gray by the weights that the reader of image files uses, bit for bit.
#pragma once

#include <cstdint>

#include "genicam/pixel_format.hpp"

namespace binpick::drivers {

// `source` holds row_bytes(format, width) bytes, little-endian; `format` is gray or colour.
void gray_row(PixelFormat format, const std::uint8_t* source, int width, std::uint8_t* gray);

// Means of factor x factor blocks of an image without gaps; width and height are multiples of it.
void reduce_gray(const std::uint8_t* source, int width, int height, int factor,
                 std::uint8_t* reduced);

}  // namespace binpick::drivers
