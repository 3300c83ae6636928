#include "genicam/frame_order.hpp"

#include <gtest/gtest.h>

#include <optional>

namespace binpick::drivers {
namespace {

// How many were missed; nothing: not newer.
std::optional<int> advance(FrameOrder& order, std::uint64_t number) {
  std::uint64_t missed = 0;
  if (!order.advance(number, missed)) return std::nullopt;
  return static_cast<int>(missed);
}

TEST(FrameOrder, CountsWhatLiesBetweenTheNumbers) {
  FrameOrder order;
  EXPECT_EQ(advance(order, 7), 0);
  EXPECT_EQ(advance(order, 8), 0);
  EXPECT_EQ(advance(order, 11), 2);
  EXPECT_EQ(advance(order, 11), std::nullopt);
  EXPECT_EQ(advance(order, 9), std::nullopt);
  EXPECT_EQ(advance(order, 12), 0);
  order.clear();
  EXPECT_EQ(advance(order, 3), 0);
}

TEST(FrameOrder, AFrameThatCameAndWasDroppedIsNotMissing) {
  FrameOrder order;
  EXPECT_EQ(advance(order, 1), 0);
  order.note_dropped();
  EXPECT_EQ(advance(order, 3), 0);
  order.note_dropped();
  EXPECT_EQ(advance(order, 7), 2);
  // Dropped as a repetition of the last: it fills no gap, and hides no more than one.
  order.note_dropped();
  EXPECT_EQ(advance(order, 8), 0);
  EXPECT_EQ(advance(order, 10), 1);
}

TEST(FrameOrder, ShortNumbersWrapAndLeaveZeroOut) {
  FrameOrder order;
  EXPECT_EQ(advance(order, 65535), 0);
  EXPECT_EQ(advance(order, 1), 0);
  EXPECT_EQ(advance(order, 65535), std::nullopt);
  EXPECT_EQ(advance(order, 3), 1);
  FrameOrder wide;
  EXPECT_EQ(advance(wide, 65535), 0);
  EXPECT_EQ(advance(wide, 65536), 0);
  EXPECT_EQ(advance(wide, 65538), 1);
}

}  // namespace
}  // namespace binpick::drivers
