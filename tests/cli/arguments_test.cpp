#include "cli/arguments.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>

namespace binpick::app {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

// The message names the option and repeats what was given.
template <class Parse>
void expect_refused(Parse parse, const std::string& text) {
  EXPECT_THAT([&] { (void)parse("--option", text); },
              ThrowsMessage<CLI::ValidationError>(AllOf(
                  HasSubstr("--option"), HasSubstr("'" + text + "'"), HasSubstr("expected"))));
}

TEST(Arguments, RangeIsTwoRisingPositiveNumbers) {
  EXPECT_EQ(parse_range("--option", "500:700"), std::make_pair(500.0, 700.0));
  EXPECT_EQ(parse_range("--option", "0.5:1e3"), std::make_pair(0.5, 1000.0));
  for (const char* text : {"", ":", "5", "5:", ":5", "7:5", "5:5", "-1:5", "0:5", "1:2:3", "a:b",
                           "1:2x", "1 :2", "nan:5", "1:inf", "1:nan"}) {
    expect_refused(parse_range, text);
  }
}

TEST(Arguments, RoiIsFourWholeNumbers) {
  const Roi roi = parse_roi("--option", "-5,10,700,400");
  EXPECT_EQ(roi.x, -5);
  EXPECT_EQ(roi.y, 10);
  EXPECT_EQ(roi.width, 700);
  EXPECT_EQ(roi.height, 400);
  for (const char* text : {"", "1,2,3", "1,2,3,4,5", "1,2,0,4", "1,2,3,-4", "1;2;3;4", "1,2,3,4.5",
                           "1,2,3,99999999", "1,2,3,99999999999999"}) {
    expect_refused(parse_roi, text);
  }
}

TEST(Arguments, FrameIsSceneAndImage) {
  EXPECT_EQ(parse_frame_id("--option", "1/12"), (drivers::FrameId{1, 12}));
  EXPECT_EQ(parse_frame_id("--option", "000003/000000"), (drivers::FrameId{3, 0}));
  for (const char* text : {"", "1", "1/", "/1", "1/2/3", "a/b", "-1/2", "1/2.5"}) {
    expect_refused(parse_frame_id, text);
  }
}

TEST(Arguments, UnitIsThatOfTheFileWhenItIsNotGiven) {
  EXPECT_EQ(parse_unit("--option", ""), train::LengthUnit::kOfFile);
  EXPECT_EQ(parse_unit("--option", "mm"), train::LengthUnit::kMillimetre);
  EXPECT_EQ(parse_unit("--option", "m"), train::LengthUnit::kMetre);
  EXPECT_EQ(parse_unit("--option", "inch"), train::LengthUnit::kInch);
  EXPECT_EQ(parse_unit("--option", "cm"), train::LengthUnit::kCentimetre);
  EXPECT_EQ(parse_unit("--option", "ft"), train::LengthUnit::kFoot);
  EXPECT_EQ(parse_unit("--option", "um"), train::LengthUnit::kMicrometre);
  for (const char* text : {"MM", "inches", "unknown", "the file's own"})
    expect_refused(parse_unit, text);
}

TEST(Arguments, IsaHasToBeKnown) {
  EXPECT_EQ(parse_isa("--option", "best"), Isa::kBest);
  EXPECT_EQ(parse_isa("--option", "scalar"), Isa::kScalar);
  for (const char* text : {"", "mmx", "AVX2"}) expect_refused(parse_isa, text);
}

}  // namespace
}  // namespace binpick::app
