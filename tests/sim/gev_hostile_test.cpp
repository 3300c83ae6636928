// Features that tell false values: a start refuses them by name, a running sensor is not disturbed,
// and a session comes back when the values are true again.
#include <gtest/gtest.h>

#include <thread>

#include "gev_bench.hpp"
#include "sensor/sensor_session.hpp"

namespace binpick::drivers {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

struct FalseCase {
  const char* feature;
  const char* value;
  const char* complaint;        // part of the error
  const char* payload = "c16";  // what the simulated sensor sends
};

void PrintTo(const FalseCase& c, std::ostream* out) {
  *out << c.feature << "=" << c.value << " (" << c.payload << ")";
}

std::string start_error(GevBench& b) {
  try {
    b.open();
  } catch (const SensorError& e) {
    return e.what();
  }
  return "";
}

class GevFalseValues : public testing::TestWithParam<FalseCase> {};

TEST_P(GevFalseValues, AreRefusedByNameAndTheTrueValueStarts) {
  const FalseCase& c = GetParam();
  GevBench b({"--payload", c.payload, "--false", std::string(c.feature) + "=" + c.value});
  if (std::string(c.payload) == "disparity") b.spec.profile.baseline_unit_mm = 1000;
  const std::string error = start_error(b);
  EXPECT_TRUE(error.starts_with(b.spec.uri + ": ")) << error;
  EXPECT_NE(error.find(c.feature), std::string::npos) << error;
  EXPECT_NE(error.find(c.complaint), std::string::npos) << error;
  b.camera.reset();
  ASSERT_EQ(b.sim->tell("clear"), "ok");
  ASSERT_EQ(start_error(b), "");
  EXPECT_TRUE(b.grab().ok());
}

INSTANTIATE_TEST_SUITE_P(
    AtTheWire, GevFalseValues,
    testing::Values(
        FalseCase{"Scan3dCoordinateScale", "0", "of axis C is 0"},
        FalseCase{"Scan3dCoordinateScale", "nan", "of axis C is nan"},
        FalseCase{"Scan3dCoordinateScale", "inf", "of axis C is inf"},
        FalseCase{"Scan3dCoordinateOffset", "nan", "of axis C is nan"},
        FalseCase{"Scan3dFocalLength", "nan", "is nan"},
        FalseCase{"Scan3dFocalLength", "0", "is 0"},
        FalseCase{"Scan3dFocalLength", "1e300", "is 1e+300"},
        FalseCase{"Scan3dAspectRatio", "-1", "is -1"},
        FalseCase{"Scan3dPrincipalPointU", "inf", "is inf"},
        FalseCase{"Scan3dPrincipalPointV", "nan", "is nan"},
        FalseCase{"Scan3dBaseline", "0", "is 0", "disparity"},
        FalseCase{"Scan3dBaseline", "nan", "is nan", "disparity"},
        FalseCase{"Scan3dDistanceUnit", "77", ""}, FalseCase{"Scan3dOutputMode", "77", ""},
        FalseCase{"Width", "0", "is 0"}, FalseCase{"Width", "4294967295", "is 4.29497e+09"},
        FalseCase{"Width", "4000", "are 4000x1024"}, FalseCase{"Height", "60000", "are 1280x60000"},
        FalseCase{"PayloadSize", "0", "is 0"}, FalseCase{"PayloadSize", "1000", "is 1000"},
        FalseCase{"PayloadSize", "4000000000", "is 4000000000"}));

TEST(GevFalseValuesWhileRunning, DisturbNoFrameAndKeepASessionOutUntilTheyAreTrue) {
  GevBench b;
  app::SessionParams params;
  params.trigger = b.spec.trigger;
  app::SensorSession session([&b] { return open_camera(b.spec); }, b.pool, params);
  const auto grab = [&](std::chrono::seconds within) {
    return session.grab(Clock::now() + within);
  };
  ASSERT_TRUE(grab(20s).ok());
  for (const char* lie : {"Scan3dCoordinateScale 0", "Scan3dFocalLength nan", "Width 100000",
                          "PayloadSize 12", "Scan3dOutputMode 77"})
    ASSERT_EQ(b.sim->tell(std::string("false ") + lie), "ok");
  for (int i = 0; i < 5; ++i) {
    const Result<FrameRef> frame = grab(20s);
    ASSERT_TRUE(frame.ok());
    EXPECT_TRUE(b.equals_file(frame.value().frame()));
    EXPECT_EQ(frame.value().frame().camera.fx, b.files[0].camera.fx);
  }
  // Control is lost; what it meets when it opens the sensor again is false.
  ASSERT_EQ(b.sim->tell("release"), "ok");
  EXPECT_FALSE(grab(8s).ok());
  const auto end = Clock::now() + 20s;
  while (session.status().open_failures == 0 && Clock::now() < end)
    std::this_thread::sleep_for(50ms);
  EXPECT_NE(session.status().last_error.find("the feature "), std::string::npos)
      << session.status().last_error;
  EXPECT_FALSE(grab(1s).ok());
  ASSERT_EQ(b.sim->tell("clear"), "ok");
  const Result<FrameRef> back = grab(30s);
  ASSERT_TRUE(back.ok()) << session.status().last_error;
  EXPECT_TRUE(b.equals_file(back.value().frame()));
}

// Too small by little: nothing is wrong to see at the start, but no frame fits.
TEST(GevFalseValuesWhileRunning, AFrameThatOutgrowsItsBuffersIsDroppedAndTheSensorOpenedAnew) {
  const long long true_bytes = 1280 * 1024 * 3;
  GevBench b({"--false", "PayloadSize=" + std::to_string(true_bytes - 4000)});
  app::SessionParams params;
  params.trigger = b.spec.trigger;
  app::SensorSession session([&b] { return open_camera(b.spec); }, b.pool, params);
  ASSERT_TRUE(session.wait_ready(Clock::now() + 20s));
  EXPECT_FALSE(session.grab(Clock::now() + 3s).ok());
  EXPECT_GT(session.status().camera.dropped_total(), 0u);
  EXPECT_EQ(session.status().camera.frames, 0u);
  ASSERT_EQ(b.sim->tell("clear"), "ok");
  bool good = false;
  for (int i = 0; i < 20 && !good; ++i) {
    const Result<FrameRef> frame = session.grab(Clock::now() + 5s);
    good = frame.ok() && b.equals_file(frame.value().frame());
  }
  EXPECT_TRUE(good) << session.status().last_error;
}

}  // namespace
}  // namespace binpick::drivers
