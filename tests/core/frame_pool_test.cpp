#include "binpick/frame/frame_pool.hpp"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

namespace binpick {
namespace {

constexpr FramePoolParams kParams{3, 33, 7};

TEST(FramePool, TakesExactlyItsFootprint) {
  Arena arena(FramePool::footprint(kParams));
  const FramePool pool(kParams, arena);
  EXPECT_EQ(arena.used_bytes(), arena.size_bytes());
  EXPECT_EQ(pool.free_count(), 3);
}

TEST(FramePool, RefusesAndCountsWhenEverySlotIsHeld) {
  Arena arena(FramePool::footprint(kParams));
  FramePool pool(kParams, arena);
  std::vector<FrameRef> held;
  for (int i = 0; i < 3; ++i) held.push_back(pool.try_take());
  for (const FrameRef& ref : held) EXPECT_TRUE(ref);
  EXPECT_FALSE(pool.try_take());
  EXPECT_FALSE(pool.try_take());
  EXPECT_EQ(pool.exhausted_count(), 2u);
  held[1].reset();
  EXPECT_EQ(pool.free_count(), 1);
  EXPECT_TRUE(pool.try_take());
  EXPECT_EQ(pool.free_count(), 1);
}

TEST(FramePool, SlotsAreDistinctLargeEnoughAndBlankWhenTaken) {
  Arena arena(FramePool::footprint(kParams));
  FramePool pool(kParams, arena);
  FrameRef a = pool.try_take(), b = pool.try_take();
  ASSERT_EQ(a.slot().depth_mm.size(), 33u * 7u);
  ASSERT_EQ(a.slot().intensity.size(), 33u * 7u);
  EXPECT_NE(a.slot().depth_mm.data(), b.slot().depth_mm.data());
  a.slot().frame.sequence = 7;
  a.reset();
  a = pool.try_take();
  EXPECT_EQ(a.frame().sequence, 0u);
}

TEST(FramePool, AMovedReferenceGivesBackOnce) {
  Arena arena(FramePool::footprint(kParams));
  FramePool pool(kParams, arena);
  FrameRef a = pool.try_take();
  FrameRef b = std::move(a);
  EXPECT_EQ(pool.free_count(), 2);
  a = std::move(b);
  FrameRef& same = a;
  a = std::move(same);
  EXPECT_TRUE(a);
  a = FrameRef{};
  EXPECT_EQ(pool.free_count(), 3);
}

TEST(FramePool, ThreadsNeverShareASlot) {
  constexpr int kThreads = 4, kRounds = 20000;
  Arena arena(FramePool::footprint(kParams));
  FramePool pool(kParams, arena);
  std::atomic<int> clashes{0};
  std::atomic<std::uint64_t> refused{0};
  const auto work = [&](std::uint8_t mark) {
    for (int i = 0; i < kRounds; ++i) {
      FrameRef ref = pool.try_take();
      if (!ref) {
        ++refused;
        continue;
      }
      for (std::uint8_t& pixel : ref.slot().intensity) pixel = mark;
      for (const std::uint8_t pixel : ref.slot().intensity) clashes += pixel != mark;
    }
  };
  std::vector<std::thread> threads;
  for (int t = 0; t < kThreads; ++t) threads.emplace_back(work, static_cast<std::uint8_t>(t + 1));
  for (std::thread& t : threads) t.join();
  EXPECT_EQ(clashes, 0);
  EXPECT_EQ(pool.free_count(), 3);
  EXPECT_EQ(pool.exhausted_count(), refused);
}

TEST(FramePoolDeathTest, DiesWhenAFrameOutlivesIt) {
  EXPECT_DEATH(
      {
        Arena arena(FramePool::footprint(kParams));
        FrameRef kept;
        FramePool pool(kParams, arena);
        kept = pool.try_take();
      },
      "assertion failed");
}

}  // namespace
}  // namespace binpick
