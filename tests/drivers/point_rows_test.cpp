// The kernels for rows of points: each vector unit of this machine against the specification, bit
// for bit.
#include "genicam/point_rows.hpp"

#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "drivers/payload_parts.hpp"
#include "genicam/point_keys.hpp"

namespace binpick::drivers {
namespace {

constexpr std::uint8_t kGuardByte = 0xA5;
constexpr std::size_t kGuard = 64;

struct Row {
  PointLayout layout;
  int width;
  std::vector<std::uint8_t> points;  // begins at an odd address
};

float wild_float(std::mt19937& random) {
  constexpr float kSpecial[] = {0.0f,
                                -0.0f,
                                std::numeric_limits<float>::quiet_NaN(),
                                std::numeric_limits<float>::infinity(),
                                -std::numeric_limits<float>::infinity(),
                                std::numeric_limits<float>::max(),
                                std::numeric_limits<float>::denorm_min(),
                                65535.0f,
                                -700.25f};
  if (random() % 4 == 0) return kSpecial[random() % std::size(kSpecial)];
  if (random() % 4 == 0) return std::bit_cast<float>(static_cast<std::uint32_t>(random()));
  return static_cast<float>(random() % 200000) / 100 - 500;
}

Row make_row(PointLayout layout, int width, std::mt19937& random) {
  Row row{layout, width, {0}};
  const int channels = layout == PointLayout::kAbcy16 ? 4 : 3;
  for (int i = 0; i < width * channels; ++i) {
    std::vector<std::uint8_t> bytes;
    if (layout == PointLayout::kAbc32f) {
      bytes = bytes_of(std::vector<float>{wild_float(random)});
    } else {
      const std::uint16_t code =
          static_cast<std::uint16_t>(random() % 5 == 0 ? 65535 : random() % 65536);
      bytes = bytes_of(std::vector<std::uint16_t>{code});
    }
    row.points.insert(row.points.end(), bytes.begin(), bytes.end());
  }
  return row;
}

template <class T>
std::vector<T> guarded(int width) {
  std::vector<T> values(static_cast<std::size_t>(width) + kGuard);
  std::memset(values.data(), kGuardByte, values.size() * sizeof(T));
  return values;
}

template <class T>
void expect_same_bits(const std::vector<T>& got, const std::vector<T>& want, const char* what) {
  EXPECT_EQ(std::memcmp(got.data(), want.data(), want.size() * sizeof(T)), 0) << what;
}

PointAxes axes_for(PointLayout layout, std::mt19937& random) {
  Scan3dAxis a{0.25, -300, {}}, b{0.26, -250, {}}, c{0.1, random() % 2 == 0 ? 0.0 : 3.5, 65535.0};
  if (random() % 3 == 0) c = {1, 0, {}};
  if (random() % 3 == 0) c = {-0.5, 900, 0.0};
  if (random() % 4 == 0) c = {0.25, 0, 0.1};  // a code that no float is
  return {layout, AxisInPx(a, 1000), AxisInPx(b, 1000), AxisInMm(c, 1), 320.5f, 239.25f};
}

void compare_with_specification(std::mt19937& random) {
  for (const PointLayout layout :
       {PointLayout::kAbc32f, PointLayout::kAbc16, PointLayout::kAbcy16}) {
    for (int width = 0; width <= 70; ++width) {
      const PointAxes axes = axes_for(layout, random);
      const Row row = make_row(layout, width, random);
      const std::uint8_t* points = row.points.data() + 1;
      auto depth = guarded<float>(width), depth_wanted = depth;
      point_depth_row_scalar(axes, points, width, depth_wanted.data());
      point_depth_row(axes, points, width, depth.data());
      expect_same_bits(depth, depth_wanted, "depth");
      auto target = guarded<std::int32_t>(width), target_wanted = target;
      EXPECT_EQ(points_on_rays(axes, points, width, 77, depth.data()),
                points_on_rays_scalar(axes, points, 0, width, 77, depth.data()));
      if (layout == PointLayout::kAbcy16) {
        auto gray = guarded<std::uint8_t>(width), gray_wanted = gray;
        point_gray_row_scalar(points, width, gray_wanted.data());
        point_gray_row(points, width, gray.data());
        expect_same_bits(gray, gray_wanted, "gray");
      }
      point_targets_row_scalar(axes, points, 0, width, 77, 480, depth_wanted.data(),
                               target_wanted.data());
      point_targets_row(axes, points, width, 77, 480, depth.data(), target.data());
      expect_same_bits(target, target_wanted, "targets");
      expect_same_bits(depth, depth_wanted, "depth of what has a target");
      for (int x = 0; x < width; ++x) {
        EXPECT_GE(target[x], 0);
        EXPECT_LT(target[x], width * 480);
      }
    }
  }
}

TEST(PointKeys, TheSmallerIsTheNearerAndOfEquallyNearTheEarlier) {
  const float least = std::numeric_limits<float>::denorm_min();
  const float most = std::numeric_limits<float>::max();
  EXPECT_LT(point_key(least, kPointOrders - 1, 255), point_key(2 * least, 0, 0));
  EXPECT_LT(point_key(500, kPointOrders - 1, 255), point_key(std::nextafter(500.0f, most), 0, 0));
  EXPECT_LT(point_key(500, 6, 255), point_key(500, 7, 0));
  EXPECT_LT(point_key(most, kPointOrders - 1, 255), empty_key());
  EXPECT_LT(empty_key(), point_key(kNoPoint, 1, 0));
}

// One point off its ray, at each place of a row whose other points lie within the tolerance.
void compare_on_rays(std::mt19937& random) {
  const int width = 53, y = 40;
  const Scan3dAxis in_mm{1, 0, {}};
  const PointAxes axes{PointLayout::kAbc32f, AxisInPx(in_mm, 1000),    AxisInPx(in_mm, 1000),
                       AxisInMm(in_mm, 1),   static_cast<float>(20.5), 30.0f};
  for (int bad = -1; bad < width; ++bad) {
    std::vector<float> abc;
    for (int x = 0; x < width; ++x) {
      const float z = static_cast<float>(500 + random() % 300);
      const float shift = x == bad ? 1.5f : static_cast<float>(random() % 180) / 100 - 0.9f;
      abc.push_back((static_cast<float>(x) - 20.5f + shift) * z / 1000);
      abc.push_back((static_cast<float>(y) - 30.0f) * z / 1000);
      abc.push_back(z);
    }
    const auto points = bytes_of(abc);
    std::vector<float> depth(static_cast<std::size_t>(width));
    point_depth_row(axes, points.data(), width, depth.data());
    EXPECT_EQ(points_on_rays(axes, points.data(), width, y, depth.data()), bad < 0) << bad;
    EXPECT_EQ(points_on_rays_scalar(axes, points.data(), 0, width, y, depth.data()), bad < 0);
  }
}

// Depths of points, of any positive number, some of none.
std::vector<float> make_depths(int count, std::mt19937& random) {
  std::vector<float> depths;
  for (int i = 0; i < count; ++i) {
    const float depth = std::abs(wild_float(random));
    depths.push_back(depth > 0 ? depth : kNoPoint);  // so is NaN
  }
  return depths;
}

void compare_keys(std::mt19937& random) {
  for (int count = 0; count <= 70; ++count) {
    const std::vector<float> depths = make_depths(count, random);
    std::vector<std::uint8_t> points_gray;
    std::vector<std::int32_t> target;
    for (int i = 0; i < count; ++i) {
      points_gray.push_back(static_cast<std::uint8_t>(random()));
      target.push_back(static_cast<std::int32_t>(random() >> 1));
    }
    const TargetSpan span = target_span(depths.data(), target.data(), count);
    const TargetSpan wanted = target_span_scalar(depths.data(), target.data(), count);
    EXPECT_EQ(span.first, wanted.first);
    EXPECT_EQ(span.last, wanted.last);

    const std::uint32_t order = kPointOrders - 70;
    auto keys = guarded<double>(count), keys_wanted = keys;
    point_keys_scalar(depths.data(), points_gray.data(), order, count, keys_wanted.data());
    point_keys(depths.data(), points_gray.data(), order, count, keys.data());
    expect_same_bits(keys, keys_wanted, "keys");
    for (int i = 0; i < count; ++i) {
      if (random() % 4 == 0) keys[static_cast<std::size_t>(i)] = empty_key();
    }
    keys_wanted = keys;
    auto depth = guarded<float>(count), depth_wanted = depth;
    auto gray = guarded<std::uint8_t>(count), gray_wanted = gray;
    take_pixels_scalar(keys_wanted.data(), count, depth_wanted.data(), gray_wanted.data());
    take_pixels(keys.data(), count, depth.data(), gray.data());
    expect_same_bits(keys, keys_wanted, "keys that were taken");
    expect_same_bits(depth, depth_wanted, "depth from keys");
    expect_same_bits(gray, gray_wanted, "gray from keys");
  }
}

TEST(PointRows, EveryVectorUnitGivesTheBitsOfTheSpecification) {
  constexpr std::uint32_t kSeed = 20240607;
  const std::int64_t supported = hwy::SupportedTargets();
  for (std::int64_t left = supported & HWY_TARGETS; left != 0; left &= left - 1) {
    const std::int64_t target = left & -left;
    SCOPED_TRACE(hwy::TargetName(target));
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(target);
    std::mt19937 random(kSeed);
    compare_with_specification(random);
    compare_on_rays(random);
    compare_keys(random);
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace
}  // namespace binpick::drivers
