// A borrowed rectangle of pixels: pointer, size and stride. Never owns.
#pragma once

#include <cstddef>

#include "binpick/base/assert.hpp"

namespace binpick {

template <class T>
struct ImageView {
  T* data = nullptr;
  int width = 0;
  int height = 0;
  std::ptrdiff_t stride = 0;  // in elements, from one row to the next

  bool empty() const { return data == nullptr || width <= 0 || height <= 0; }
  T* row(int y) const { return data + y * stride; }
  T& at(int x, int y) const { return data[y * stride + x]; }
  bool contains(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
  ImageView<T> crop(int x, int y, int w, int h) const {
    BINPICK_ASSERT(x >= 0 && y >= 0 && w >= 0 && h >= 0 && x + w <= width && y + h <= height);
    return {data + y * stride + x, w, h, stride};
  }
  operator ImageView<const T>() const { return {data, width, height, stride}; }
};

}  // namespace binpick
