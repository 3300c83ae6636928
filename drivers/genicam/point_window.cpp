#include "genicam/point_window.hpp"

#include <hwy/cache_control.h>

#include <algorithm>
#include <cstdlib>

#include "binpick/base/assert.hpp"

namespace binpick::drivers {
namespace {

// Enough for the rows that a row of points is bent over, and those that noise moves it by.
constexpr std::int64_t kRows = 32;
// Of the points, so that few come behind the window: rows, then pixels of whole cache lines.
constexpr std::int64_t kLagRows = 3;
constexpr std::int64_t kAlign = 64;
// A window that leaves pixels behind needs each once; one that goes to and fro is not worth it.
constexpr std::int64_t kMovesPerPixel = 4;

// Pixels from .. to-1 of an image, from memory.
template <class T>
void fetch(const T* image, std::int64_t from, std::int64_t to) {
  constexpr std::int64_t kLine = 64 / sizeof(T);
  for (std::int64_t p = from; p < to; p += kLine) hwy::Prefetch(image + p);
}

std::size_t ring_size(int width_max) {
  return std::bit_ceil(static_cast<std::size_t>(kRows * std::max(1, width_max)));
}

// Without a branch: which of two points is the nearer nobody can predict, and a wrong guess costs
// more than all the rest.
void keep_nearest(const double* points, const std::int32_t* target, int count, std::uint32_t mask,
                  double* pixels) {
  for (int i = 0; i < count; ++i) {
    double* held = pixels + (static_cast<std::uint32_t>(target[i]) & mask);
    *held = points[i] < *held ? points[i] : *held;
  }
}

}  // namespace

PointWindow::PointWindow(int width_max, std::uint32_t orders)
    : orders_(orders),
      keys_(ring_size(width_max), empty_key()),
      row_keys_(static_cast<std::size_t>(width_max)) {
  BINPICK_ASSERT(orders <= kPointOrders && orders > static_cast<std::uint32_t>(width_max));
}

void PointWindow::begin(int width, int height, float* depth_mm, std::uint8_t* gray) {
  count_ = std::int64_t{width} * height;
  depth_mm_ = depth_mm;
  gray_ = gray;
  begin_ = 0;
  known_ = std::min(size(), count_);
  lag_ = std::min(kLagRows * width, size() / 2);
  moves_left_ = kMovesPerPixel * count_;
  next_order_ = 1;
}

void PointWindow::add_row(const float* points_mm, const std::uint8_t* points_gray,
                          const std::int32_t* target, int points_count) {
  const TargetSpan span = target_span(points_mm, target, points_count);
  if (span.first > span.last) return;
  if (orders_ - next_order_ < static_cast<std::uint32_t>(points_count)) {
    store(begin_, end());
    load(begin_, end());
    next_order_ = 1;
  }
  point_keys(points_mm, points_gray, next_order_, points_count, row_keys_.data());
  next_order_ += static_cast<std::uint32_t>(points_count);
  follow(span);

  const std::uint32_t mask = static_cast<std::uint32_t>(keys_.size() - 1);
  if (holds(span)) return keep_nearest(row_keys_.data(), target, points_count, mask, keys_.data());
  for (int i = 0; i < points_count; ++i) {
    if (target[i] >= begin_ && target[i] < end()) {
      keep_nearest(&row_keys_[static_cast<std::size_t>(i)], target + i, 1, mask, keys_.data());
    } else {
      add_direct(target[i], points_mm[i], points_gray[i]);
    }
  }
}

void PointWindow::finish() {
  store(begin_, end());
  clear_images(count_);
}

// Behind the span by the lag, which grows where points come behind the window.
void PointWindow::follow(TargetSpan span) {
  if (holds(span) && span.first - begin_ <= lag_) return;
  std::int64_t pixel = 0;
  if (span.last - std::int64_t{span.first} >= size() - kAlign) {
    // Nothing better than around its middle, unless it is about that already.
    pixel = (std::int64_t{span.first} + span.last - size()) / 2;
    if (std::abs(pixel - begin_) < size() / 4) return;
  } else {
    if (span.first < begin_) lag_ = std::min(2 * lag_, size() / 2);
    pixel = std::max(span.first - kAlign - lag_, span.last + 1 - size());
  }
  pixel = (std::max<std::int64_t>(0, pixel) + kAlign - 1) / kAlign * kAlign;
  const std::int64_t distance = std::min(std::abs(pixel - begin_), size());
  if (distance > moves_left_) return;
  moves_left_ -= distance;
  move_to(pixel);
}

void PointWindow::move_to(std::int64_t pixel) {
  const std::int64_t old_begin = begin_, old_end = end();
  begin_ = pixel;
  if (pixel > old_begin) {
    store(old_begin, std::min(pixel, old_end));
    clear_images(pixel);
    load(std::max(old_end, pixel), end());
  } else {
    store(std::max(old_begin, end()), old_end);
    load(pixel, std::min(old_begin, end()));
  }
}

void PointWindow::add_direct(std::int32_t to, float depth_mm, std::uint8_t gray) {
  if (!(depth_mm < kNoPoint)) return;
  clear_images(to + std::int64_t{1});
  if (depth_mm_[to] > 0 && depth_mm_[to] <= depth_mm) return;
  depth_mm_[to] = depth_mm;
  gray_[to] = gray;
}

// What the images know of pixels that the window now holds.
void PointWindow::load(std::int64_t from, std::int64_t to) {
  to = std::min(to, count_);
  for (std::int64_t p = from; p < std::min(to, known_); ++p) {
    if (depth_mm_[p] > 0)
      keys_[static_cast<std::size_t>(p & (size() - 1))] = point_key(depth_mm_[p], 0, gray_[p]);
  }
  known_ = std::max(known_, to);
}

void PointWindow::store(std::int64_t from, std::int64_t to) {
  to = std::min(to, count_);
  for (std::int64_t p = from; p < to;) {
    const std::int64_t at = p & (size() - 1);
    const std::int64_t piece = std::min(to - p, size() - at);
    // What is stored next, a row later, would wait for its cache lines.
    fetch(depth_mm_, p + piece, std::min(p + 2 * piece, count_));
    fetch(gray_, p + piece, std::min(p + 2 * piece, count_));
    take_pixels(keys_.data() + at, static_cast<int>(piece), depth_mm_ + p, gray_ + p);
    p += piece;
  }
}

// Pixels that neither the images nor the window knew, up to `to`.
void PointWindow::clear_images(std::int64_t to) {
  if (to <= known_) return;
  std::fill(depth_mm_ + known_, depth_mm_ + to, 0.0f);
  std::fill(gray_ + known_, gray_ + to, std::uint8_t{0});
  known_ = to;
}

}  // namespace binpick::drivers
