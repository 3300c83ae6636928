// The vector loop against the rule, pixel by pixel.
#include "genicam/confidence_rows.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <vector>

namespace binpick::drivers {
namespace {

// Two rows of an odd width, so that vectors have a rest.
constexpr int kWidth = 77;

template <class Confidence>
void expect_rule(PixelFormat format, double min, int least) {
  std::mt19937 random(3);
  std::vector<Confidence> values(2 * kWidth);
  for (Confidence& v : values) v = static_cast<Confidence>(random());
  values[kWidth + 1] = static_cast<Confidence>(least);
  values[kWidth + 2] = static_cast<Confidence>(least - 1);
  std::vector<std::uint8_t> bytes(values.size() * sizeof(Confidence));
  std::memcpy(bytes.data(), values.data(), bytes.size());
  PayloadPart part;
  part.role = PartRole::kConfidence;
  part.format = format;
  part.width = kWidth;
  part.height = 2;
  part.bytes = bytes;
  std::vector<float> depth_mm(kWidth);
  for (int x = 0; x < kWidth; ++x)
    depth_mm[static_cast<std::size_t>(x)] = 500.0f + static_cast<float>(x);
  std::vector<float> expected = depth_mm;
  for (std::size_t x = 0; x < kWidth; ++x) {
    if (values[kWidth + x] < least) expected[x] = -1;
  }
  ConfidenceRows(&part, min).apply(1, depth_mm.data(), -1);
  EXPECT_EQ(depth_mm, expected);
}

TEST(ConfidenceRows, KeepsWhatIsSureAtAnyWidth) {
  expect_rule<std::uint8_t>(PixelFormat::kConfidence8, 0.5, 128);
  expect_rule<std::uint8_t>(PixelFormat::kConfidence8, 0, 1);
  expect_rule<std::uint16_t>(PixelFormat::kConfidence16, 0.5, 32768);
  expect_rule<std::uint16_t>(PixelFormat::kConfidence16, 0.999, 65470);
}

}  // namespace
}  // namespace binpick::drivers
