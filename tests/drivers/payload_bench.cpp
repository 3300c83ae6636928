// Times the conversion of a 1280x1024 frame to the frame type, format by format. Prints a table; a
// test by itself it is not.
#include <algorithm>
#include <chrono>
#include <cstdio>

#include "drivers/payload_parts.hpp"

namespace binpick::drivers {
namespace {

constexpr int kWidth = 1280, kHeight = 1024;
constexpr std::size_t kRuns = 101;
constexpr std::size_t kPixels = static_cast<std::size_t>(kWidth) * kHeight;

void bench(const char* name, const std::vector<PayloadPart>& parts, const Scan3d& scan3d) {
  Conversion conversion(kWidth, kHeight);
  std::vector<double> took_ms(kRuns);
  for (double& ms : took_ms) {
    const auto start = std::chrono::steady_clock::now();
    if (conversion.run(parts, scan3d) != DropReason::kNone) std::printf("%s: dropped\n", name);
    ms =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  }
  std::sort(took_ms.begin(), took_ms.end());
  std::printf("%-36s %8.2f %8.2f ms\n", name, took_ms.front(), took_ms[kRuns / 2]);
}

// A bin: 600 to 750 mm at 0.1 mm a code, holes here and there. Noise of 50 mm makes neighbours meet
// in a pixel in every order, which is the worst that can be projected.
std::vector<std::uint16_t> depth_codes(unsigned noise) {
  std::vector<std::uint16_t> codes(kPixels);
  std::uint32_t state = 1;
  for (std::size_t i = 0; i < kPixels; ++i) {
    state = state * 1664525u + 1013904223u;
    codes[i] = state % 29 == 0 ? 0 : static_cast<std::uint16_t>(6000 + i / 1280 + state % noise);
  }
  return codes;
}

// How the rays of the grid differ from those of the image that it is projected into.
struct Lens {
  const char* name;
  double scale;     // of all rays
  double bend;      // of those in the corners, beside it
  double aside_mm;  // what measures, beside what the image is of
};

constexpr Lens kLenses[] = {
    {"on their rays", 1, 0, 0},
    // Neighbours go to neighbours.
    {"to be projected", 1.02, 0, 0},
    // Rows go over 40 rows, and every point by as much as its depth says: neighbours meet.
    {"to be projected, bent and seen from aside", 0.98, -0.12, 40},
};

std::vector<float> points(const std::vector<std::uint16_t>& codes, const Lens& lens) {
  std::vector<float> abc;
  for (std::size_t i = 0; i < kPixels; ++i) {
    const double z = codes[i] * 0.1;
    const double x = static_cast<double>(i % kWidth) - 640,
                 y = static_cast<double>(i / kWidth) - 512;
    const double scale = lens.scale + lens.bend * (x * x + y * y) / (640 * 640 + 512 * 512);
    abc.push_back(static_cast<float>(x * scale / 1900 * z + lens.aside_mm));
    abc.push_back(static_cast<float>(y * scale / 1900 * z + lens.aside_mm / 4));
    abc.push_back(static_cast<float>(z));
  }
  return abc;
}

// The same points in steps of 0.25 mm, x and y shifted to be positive, as LUCID Helios2 has them; z
// in steps of its own.
template <int kChannels>
std::vector<std::uint16_t> point_codes(const std::vector<float>& points, float z_steps_per_mm) {
  std::vector<std::uint16_t> codes;
  for (std::size_t i = 0; i < kPixels; ++i) {
    codes.push_back(static_cast<std::uint16_t>((points[3 * i] + 8192) * 4));
    codes.push_back(static_cast<std::uint16_t>((points[3 * i + 1] + 8192) * 4));
    codes.push_back(static_cast<std::uint16_t>(points[3 * i + 2] * z_steps_per_mm));
    if (kChannels == 4) codes.push_back(static_cast<std::uint16_t>(i));
  }
  return codes;
}

void run() {
  Scan3d z = millimetres(1900, 640, 512);
  z.c = {0.1, 0, 0.0};
  Scan3d disparity = z;
  disparity.kind = DepthKind::kDisparity;
  disparity.baseline_mm = 65;
  const Scan3d floats = millimetres(1900, 640, 512);

  const auto codes = depth_codes(500);
  const auto c16 = bytes_of(codes), confidence = bytes_of(std::vector<std::uint16_t>(kPixels, 9));
  const std::vector<std::uint8_t> gray8(kPixels, 7);
  std::vector<float> metric;
  for (const std::uint16_t code : codes) metric.push_back(static_cast<float>(code * 0.1));
  const auto c32f = bytes_of(metric);
  const auto part = [](PartRole role, PixelFormat format, const std::vector<std::uint8_t>& bytes) {
    return part_of(role, format, kWidth, kHeight, bytes);
  };
  const auto mono8 = part(PartRole::kIntensity, PixelFormat::kMono8, gray8);
  const auto mono16 = part(PartRole::kIntensity, PixelFormat::kMono16, c16);
  const auto depth16 = part(PartRole::kDepth, PixelFormat::kCoord3dC16, c16);
  const auto sure = part(PartRole::kConfidence, PixelFormat::kConfidence16, confidence);
  std::printf("%d x %d, best and median of %zu\n", kWidth, kHeight, kRuns);
  bench("C16 + Mono8", {depth16, mono8}, z);
  bench("C16 disparity + Mono8", {depth16, mono8}, disparity);
  bench("C16 + Mono8 + Confidence16", {depth16, mono8, sure}, z);
  bench("C32f + Mono16", {part(PartRole::kDepth, PixelFormat::kCoord3dC32f, c32f), mono16}, floats);

  Scan3d steps = floats;
  steps.a = steps.b = {0.25, -8192, {}};
  steps.c = {0.25, 0, 65535.0};
  // As these steps are no float, each depth needs double.
  Scan3d fine = steps;
  fine.c = {0.1, 0, 65535.0};
  for (const Lens& lens : kLenses) {
    for (const unsigned noise : {500u, 5u}) {
      const std::vector<float> abc = points(depth_codes(noise), lens);
      const auto abc32f = bytes_of(abc), abc16 = bytes_of(point_codes<3>(abc, 4)),
                 abc16_fine = bytes_of(point_codes<3>(abc, 10)),
                 abcy16 = bytes_of(point_codes<4>(abc, 4));
      const auto depth32f = part(PartRole::kDepth, PixelFormat::kCoord3dAbc32f, abc32f);
      std::printf("points %s, %s\n", lens.name, noise == 500 ? "noisy" : "smooth");
      bench("  ABC32f", {depth32f}, floats);
      bench("  ABC32f + Mono8", {depth32f, mono8}, floats);
      bench("  ABC32f + Confidence16", {depth32f, sure}, floats);
      bench("  ABC32f + Mono8 + Confidence16", {depth32f, mono8, sure}, floats);
      bench("  ABC16", {part(PartRole::kDepth, PixelFormat::kCoord3dAbc16, abc16)}, steps);
      bench("  ABC16, z in 0.1 mm",
            {part(PartRole::kDepth, PixelFormat::kCoord3dAbc16, abc16_fine)}, fine);
      bench("  ABCY16", {part(PartRole::kDepth, PixelFormat::kCoord3dAbcy16, abcy16)}, steps);
    }
  }
}

}  // namespace
}  // namespace binpick::drivers

int main() {
  binpick::drivers::run();
}
