// The window of pixels that points are projected into, against the plain rule: of the points of a
// pixel the nearest, of equal ones the first. Rows of points go wherever rows could.
#include "genicam/point_window.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <random>
#include <vector>

namespace binpick::drivers {
namespace {

constexpr int kWidth = 40, kHeight = 300;  // several times what the window holds
constexpr std::int32_t kCount = kWidth * kHeight;

struct Points {
  std::vector<float> depth_mm;
  std::vector<std::uint8_t> gray;
  std::vector<std::int32_t> target;
};

struct Images {
  std::vector<float> depth_mm;
  std::vector<std::uint8_t> gray;
  bool operator==(const Images&) const = default;
};

// `target_of`: where point x, y goes; what is outside of the image is no point.
Points make_points(std::mt19937& random, int depths_count,
                   const std::function<int(int x, int y)>& target_of) {
  Points points;
  for (std::int32_t i = 0; i < kCount; ++i) {
    const int to = target_of(i % kWidth, i / kWidth);
    const bool none = to < 0 || to >= kCount || random() % 20 == 0;
    const auto step = static_cast<float>(random() % static_cast<unsigned>(depths_count));
    points.depth_mm.push_back(none ? kNoPoint : 500 + step / 8);
    points.gray.push_back(static_cast<std::uint8_t>(random()));
    points.target.push_back(none ? i : to);
  }
  return points;
}

Images by_the_rule(const Points& points) {
  Images images{std::vector<float>(kCount), std::vector<std::uint8_t>(kCount)};
  for (std::size_t i = 0; i < kCount; ++i) {
    if (points.depth_mm[i] == kNoPoint) continue;
    const auto to = static_cast<std::size_t>(points.target[i]);
    if (images.depth_mm[to] > 0 && images.depth_mm[to] <= points.depth_mm[i]) continue;
    images.depth_mm[to] = points.depth_mm[i];
    images.gray[to] = points.gray[i];
  }
  return images;
}

Images by_window(PointWindow& window, const Points& points) {
  Images images{std::vector<float>(kCount, 77), std::vector<std::uint8_t>(kCount, 77)};
  window.begin(kWidth, kHeight, images.depth_mm.data(), images.gray.data());
  for (int i = 0; i < kCount; i += kWidth)
    window.add_row(&points.depth_mm[i], &points.gray[i], &points.target[i], kWidth);
  window.finish();
  return images;
}

// All with one window, which has to be as new for each.
void expect_the_rule(PointWindow& window, const std::function<int(int x, int y)>& target_of) {
  std::mt19937 random(20240611);
  for (const int depths_count : {1, 7, 100000}) {
    const Points points = make_points(random, depths_count, target_of);
    EXPECT_EQ(by_window(window, points), by_the_rule(points)) << depths_count << " depths";
  }
}

int pixel(int x, int y) {
  return x < 0 || x >= kWidth ? -1 : y * kWidth + x;
}

// What is in the window, and what comes before the window or after it, in every mixture.
void expect_the_rule_everywhere(PointWindow& window) {
  std::mt19937 random(7);
  const auto around = [&](int reach) {
    return static_cast<int>(random() % static_cast<unsigned>(2 * reach + 1)) - reach;
  };
  expect_the_rule(window, [](int x, int y) { return pixel(x, y); });
  expect_the_rule(window, [&](int x, int y) { return pixel(x + around(2), y + around(2)); });
  expect_the_rule(window, [&](int x, int y) { return pixel(x / 2, y + 100 + around(10)); });
  expect_the_rule(window, [&](int x, int y) { return pixel(x, y - 100 + around(40)); });
  expect_the_rule(window, [](int x, int y) { return pixel(kWidth - 1 - x, kHeight - 1 - y); });
  expect_the_rule(window, [](int x, int y) { return pixel(y * kWidth / kHeight, x * 7); });
  expect_the_rule(window, [](int x, int y) { return pixel(x, y + (x - 20) * (x - 20) / 5); });
  expect_the_rule(window, [](int x, int y) { return pixel(x, y % 2 == 0 ? y : kHeight - y); });
  expect_the_rule(window, [](int x, int y) { return pixel(x, y < 100 ? y + 190 : y - 90); });
  expect_the_rule(window, [](int x, int y) { return pixel(x, y / 2 * (y % 2)); });
  // Some go anywhere: each row, and one row alone, which then takes the pixels of later rows.
  expect_the_rule(window, [&](int x, int y) {
    return random() % 50 == 0 ? static_cast<int>(random() % kCount) : pixel(x, y);
  });
  expect_the_rule(window, [&](int x, int y) {
    return y == 3 ? static_cast<int>(random() % kCount) : pixel(x, y);
  });
  expect_the_rule(window, [&](int, int) { return static_cast<int>(random() % kCount); });
  expect_the_rule(window, [](int, int) { return kCount - 1; });
  expect_the_rule(window, [](int, int) { return -1; });
}

TEST(PointWindow, KeepsTheNearestAndOfEqualOnesTheFirstWhereverRowsGo) {
  PointWindow window(kWidth);
  expect_the_rule_everywhere(window);
}

// As in images of more than 2^24 points.
TEST(PointWindow, KeepsTheFirstOfEqualOnesWhenTheirOrdersRunOut) {
  PointWindow window(kWidth, 5 * kWidth + 3);
  expect_the_rule_everywhere(window);
}

TEST(PointWindow, AnImageMayBeSmallerThanTheWindow) {
  PointWindow window(kWidth);
  const std::vector<float> points_mm = {600, 500, kNoPoint, 500, 400, 500};
  const std::vector<std::uint8_t> points_gray = {1, 2, 3, 4, 5, 6};
  const std::vector<std::int32_t> target = {0, 0, 2, 4, 5, 4};
  std::vector<float> depth_mm(6, 77);
  std::vector<std::uint8_t> gray(6, 77);
  window.begin(3, 2, depth_mm.data(), gray.data());
  window.add_row(&points_mm[0], &points_gray[0], &target[0], 3);
  window.add_row(&points_mm[3], &points_gray[3], &target[3], 3);
  window.finish();
  EXPECT_EQ(depth_mm, (std::vector<float>{500, 0, 0, 0, 500, 400}));
  EXPECT_EQ(gray, (std::vector<std::uint8_t>{2, 0, 0, 0, 4, 5}));
}

}  // namespace
}  // namespace binpick::drivers
