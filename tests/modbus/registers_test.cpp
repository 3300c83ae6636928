#include "modbus/registers.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

namespace binpick::modbus {
namespace {

using map::WordOrder;

constexpr std::array kOrders = {WordOrder::kAbcd, WordOrder::kCdab, WordOrder::kBadc,
                                WordOrder::kDcba};

TEST(Registers, PutTheTestNumberAsTheMapSays) {
  std::array<std::uint16_t, 2> words{};
  put_uint32(words, WordOrder::kAbcd, 0x12345678);
  EXPECT_EQ(words, (std::array<std::uint16_t, 2>{0x1234, 0x5678}));
  put_uint32(words, WordOrder::kCdab, 0x12345678);
  EXPECT_EQ(words, (std::array<std::uint16_t, 2>{0x5678, 0x1234}));
  put_uint32(words, WordOrder::kBadc, 0x12345678);
  EXPECT_EQ(words, (std::array<std::uint16_t, 2>{0x3412, 0x7856}));
  put_uint32(words, WordOrder::kDcba, 0x12345678);
  EXPECT_EQ(words, (std::array<std::uint16_t, 2>{0x7856, 0x3412}));
}

TEST(Registers, PutOneAsFloat) {
  std::array<std::uint16_t, 2> words{};
  put_float32(words, WordOrder::kAbcd, 1.0F);
  EXPECT_EQ(words, (std::array<std::uint16_t, 2>{0x3F80, 0}));
  put_float32(words, WordOrder::kCdab, -2.0F);
  EXPECT_EQ(words, (std::array<std::uint16_t, 2>{0, 0xC000}));
}

TEST(Registers, GiveBackWhatWasPutInEveryOrder) {
  std::array<std::uint16_t, 2> words{};
  for (const WordOrder order : kOrders) {
    for (const std::int32_t value :
         {0, 1, -1, 0x12345678, std::numeric_limits<std::int32_t>::min(), 70000, -70000}) {
      put_int32(words, order, value);
      EXPECT_EQ(get_int32(words, order), value);
    }
    put_float32(words, order, -0.15625F);
    EXPECT_EQ(get_float32(words, order), -0.15625F);
  }
}

TEST(Registers, RoundToTheNearestAndHoldAtTheEnds) {
  EXPECT_EQ(rounded_int32(1.5), 2);
  EXPECT_EQ(rounded_int32(-1.5), -2);
  EXPECT_EQ(rounded_int32(1e12), std::numeric_limits<std::int32_t>::max());
  EXPECT_EQ(rounded_int32(-1e12), std::numeric_limits<std::int32_t>::min());
  EXPECT_EQ(rounded_int32(std::nan("")), 0);
  EXPECT_EQ(rounded_int16(40000), 32767);
  EXPECT_EQ(rounded_uint16(-3), 0);
  EXPECT_EQ(rounded_uint16(70000), 65535);
}

}  // namespace
}  // namespace binpick::modbus
