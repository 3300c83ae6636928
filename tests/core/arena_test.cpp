#include "binpick/base/arena.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>

#include "binpick/base/arena_plan.hpp"

namespace binpick {
namespace {

// A part lists its buffers once, for planning and for taking.
template <class Source>
std::size_t take_some(Source& source) {
  return source.template take<std::uint8_t>(3).size() + source.template take<double>(100).size() +
         source.template take<std::uint8_t>(0).size() +
         source.template take<std::uint16_t>(65).size();
}

TEST(Arena, GivesZeroedAlignedPiecesThatDoNotOverlap) {
  Arena arena(1024);
  const auto a = arena.take<std::uint8_t>(3);
  const auto b = arena.take<double>(5);
  EXPECT_EQ(0u, reinterpret_cast<std::uintptr_t>(a.data()) % Arena::kAlignment);
  EXPECT_EQ(0u, reinterpret_cast<std::uintptr_t>(b.data()) % Arena::kAlignment);
  EXPECT_TRUE(std::all_of(b.begin(), b.end(), [](double x) { return x == 0; }));
  std::fill(b.begin(), b.end(), 1.0);
  EXPECT_TRUE(std::all_of(a.begin(), a.end(), [](std::uint8_t x) { return x == 0; }));
  EXPECT_EQ(128u, arena.used_bytes());
}

TEST(Arena, TakesWhatItsPlanCounts) {
  ArenaPlan plan;
  take_some(plan);
  Arena arena(plan.bytes);
  EXPECT_EQ(168u, take_some(arena));
  EXPECT_EQ(plan.bytes, arena.used_bytes());
  EXPECT_EQ(arena.size_bytes(), arena.used_bytes());
}

TEST(ArenaDeathTest, EndsTheProcessWhenItIsAskedForTooMuch) {
  Arena arena(128);
  arena.take<std::uint8_t>(65);
  EXPECT_DEATH(arena.take<std::uint8_t>(1), "assertion failed");
}

TEST(ArenaDeathTest, GivesNothingOnceItIsSealed) {
  Arena arena(128);
  arena.seal();
  EXPECT_DEATH(arena.take<std::uint8_t>(1), "assertion failed");
}

}  // namespace
}  // namespace binpick
