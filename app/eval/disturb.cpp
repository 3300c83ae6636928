#include "eval/disturb.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "binpick/geometry/angle.hpp"

namespace binpick::app {
namespace {

using drivers::LoadedFrame;

constexpr int kStepPx = 4;              // of second differences: beyond what sensors smooth over
constexpr double kSmoothShare = 0.005;  // a larger second difference, of the depth, is an edge
constexpr int kNoiseBlockPx = 2;
constexpr int kBlobRadiusMin = 3, kBlobRadiusMax = 16;
constexpr double kAmbient = 0.35;  // of the light, from all sides
constexpr int kNormalStepPx = 3;
constexpr double kShadeMax = 4;
constexpr int kRimPx = 128;  // around the ROI, beyond what the detector looks at

// The same on every machine, which std::normal_distribution is not.
class Random {
 public:
  explicit Random(std::uint64_t seed) : bits_(seed * 0x9e3779b97f4a7c15 + 1) {}
  double uniform() { return (static_cast<double>(bits_() >> 11) + 0.5) / 9007199254740992.0; }
  double gauss() { return std::sqrt(-2 * std::log(uniform())) * std::cos(2 * kPi * uniform()); }
  int between(int first, int last) {
    return first + static_cast<int>(uniform() * (last - first + 1));
  }

 private:
  std::mt19937_64 bits_;
};

PixelRange region_of(const LoadedFrame& frame) {
  return pixels_of(frame.roi, frame.camera.width, frame.camera.height);
}

float& depth_at(LoadedFrame& frame, int x, int y) {
  return frame.depth_mm[static_cast<std::size_t>(y) * static_cast<std::size_t>(frame.camera.width) +
                        static_cast<std::size_t>(x)];
}

void add_noise(LoadedFrame& frame, double level, std::uint64_t seed) {
  if (frame.depth_mm.empty()) return;
  const double share = depth_noise_share(frame) * std::sqrt(std::max(0.0, level * level - 1));
  Random random(seed);
  for (int y = 0; y < frame.camera.height; y += kNoiseBlockPx) {
    for (int x = 0; x < frame.camera.width; x += kNoiseBlockPx) {
      const double value = share * random.gauss();
      for (int v = y; v < std::min(y + kNoiseBlockPx, frame.camera.height); ++v) {
        for (int u = x; u < std::min(x + kNoiseBlockPx, frame.camera.width); ++u) {
          float& z = depth_at(frame, u, v);
          const double mm = static_cast<double>(z);
          if (is_measured(z)) z = static_cast<float>(std::max(1.0, mm + value * mm * mm));
        }
      }
    }
  }
  frame.depth_scale_mm = 0;  // no longer whole numbers of steps
}

void lose_depth(LoadedFrame& frame, double share, std::uint64_t seed) {
  const PixelRange roi = region_of(frame);
  if (roi.empty() || frame.depth_mm.empty()) return;
  long long left = 0;
  for (int y = roi.y0; y < roi.y1; ++y) {
    for (int x = roi.x0; x < roi.x1; ++x) left += is_measured(depth_at(frame, x, y));
  }
  left = static_cast<long long>(static_cast<double>(left) * std::min(share, 1.0));
  Random random(seed);
  while (left > 0) {
    const int cx = random.between(roi.x0, roi.x1 - 1), cy = random.between(roi.y0, roi.y1 - 1);
    const int radius = random.between(kBlobRadiusMin, kBlobRadiusMax);
    for (int y = std::max(roi.y0, cy - radius); y <= std::min(roi.y1 - 1, cy + radius); ++y) {
      for (int x = std::max(roi.x0, cx - radius); x <= std::min(roi.x1 - 1, cx + radius); ++x) {
        if ((x - cx) * (x - cx) + (y - cy) * (y - cy) > radius * radius) continue;
        float& z = depth_at(frame, x, y);
        if (left == 0 || !is_measured(z)) continue;
        z = 0;
        --left;
      }
    }
  }
}

void flatten(LoadedFrame& frame, double factor) {
  if (frame.intensity.empty()) return;
  double sum = 0;
  for (const std::uint8_t g : frame.intensity) sum += g;
  const double mean = sum / static_cast<double>(frame.intensity.size());
  for (std::uint8_t& g : frame.intensity)
    g = static_cast<std::uint8_t>(std::clamp(std::lround(mean + factor * (g - mean)), 0L, 255L));
}

// Towards the camera; nothing where a neighbour is missing or lies across an edge.
bool normal_at(LoadedFrame& frame, int x, int y, Vec3& normal) {
  const int s = kNormalStepPx;
  if (x < s || y < s || x + s >= frame.camera.width || y + s >= frame.camera.height) return false;
  const auto point = [&](int u, int v) -> Vec3 {
    return frame.camera.unproject(u, v, static_cast<double>(depth_at(frame, u, v)));
  };
  const float z[4] = {depth_at(frame, x - s, y), depth_at(frame, x + s, y),
                      depth_at(frame, x, y - s), depth_at(frame, x, y + s)};
  if (!std::all_of(z, z + 4, is_measured)) return false;
  const auto [near, far] = std::minmax_element(z, z + 4);
  if (*far - *near > 0.02f * *near) return false;
  const Vec3 along = point(x + s, y) - point(x - s, y), down = point(x, y + s) - point(x, y - s);
  normal = down.cross(along).normalized();
  if (normal.z() > 0) normal = -normal;
  return normal.allFinite();
}

void relight(LoadedFrame& frame, double angle_deg, std::uint64_t seed) {
  // What is lit how is told by the depth.
  if (frame.intensity.empty() || frame.depth_mm.empty() || angle_deg == 0) return;
  Random random(seed);
  const double azimuth = 2 * kPi * random.uniform(), angle = angle_deg * kDegree;
  const Vec3 light(std::sin(angle) * std::cos(azimuth), std::sin(angle) * std::sin(azimuth),
                   -std::cos(angle));
  const auto shade = [](const Vec3& n, const Vec3& from) {
    return kAmbient + (1 - kAmbient) * std::max(0.0, n.dot(from));
  };
  const Vec3 facing = -Vec3::UnitZ();
  const PixelRange roi = region_of(frame);
  const int right = std::min(frame.camera.width, roi.x1 + kRimPx),
            bottom = std::min(frame.camera.height, roi.y1 + kRimPx);
  for (int y = std::max(0, roi.y0 - kRimPx); y < bottom; ++y) {
    for (int x = std::max(0, roi.x0 - kRimPx); x < right; ++x) {
      Vec3 n = facing;
      normal_at(frame, x, y, n);
      const double factor = std::min(kShadeMax, shade(n, light) / shade(n, facing));
      std::uint8_t& g = frame.intensity[static_cast<std::size_t>(y) *
                                            static_cast<std::size_t>(frame.camera.width) +
                                        static_cast<std::size_t>(x)];
      g = static_cast<std::uint8_t>(std::min(255L, std::lround(factor * g)));
    }
  }
}

}  // namespace

const char* disturbance_name(Disturbance d) {
  static constexpr const char* kNames[kDisturbanceCount] = {"noise", "missing", "contrast",
                                                            "light", "focal",   "centre"};
  return kNames[static_cast<std::size_t>(d)];
}

const char* disturbance_unit(Disturbance d) {
  static constexpr const char* kUnits[kDisturbanceCount] = {
      "depth noise, times the frame's own", "share of the depth that is missing",
      "contrast of the intensity image",    "light off the optical axis, degrees",
      "error of the focal length, percent", "error of the principal point, px"};
  return kUnits[static_cast<std::size_t>(d)];
}

double depth_noise_share(const LoadedFrame& frame) {
  if (frame.depth_mm.empty()) return 0;
  const PixelRange roi = region_of(frame);
  std::vector<double> seconds;
  const auto at = [&](int x, int y) {
    return frame
        .depth_mm[static_cast<std::size_t>(y) * static_cast<std::size_t>(frame.camera.width) +
                  static_cast<std::size_t>(x)];
  };
  double distance = 0;
  for (int y = roi.y0; y < roi.y1; y += 2) {
    for (int x = roi.x0 + kStepPx; x + kStepPx < roi.x1; x += 2) {
      const float l = at(x - kStepPx, y), c = at(x, y), r = at(x + kStepPx, y);
      if (!is_measured(l) || !is_measured(c) || !is_measured(r)) continue;
      const double z = static_cast<double>(c);
      const double second = std::abs(static_cast<double>(l) - 2 * z + static_cast<double>(r));
      if (second > kSmoothShare * z) continue;
      seconds.push_back(second / (z * z));
      distance += z;
    }
  }
  if (seconds.empty()) return 0;
  distance /= static_cast<double>(seconds.size());
  const auto middle = seconds.begin() + static_cast<std::ptrdiff_t>(seconds.size() / 2);
  std::nth_element(seconds.begin(), middle, seconds.end());
  // The second difference of three independent values has sqrt(6) times their deviation; a step of
  // the image, rounded, has 1/sqrt(12) of it.
  const double rounding = frame.depth_scale_mm / std::sqrt(12.0) / (distance * distance);
  return std::max(1.4826 * *middle / std::sqrt(6.0), rounding);
}

void disturb(LoadedFrame& frame, Disturbance what, double level, std::uint64_t seed) {
  switch (what) {
    case Disturbance::kNoise:
      return add_noise(frame, level, seed);
    case Disturbance::kMissing:
      return lose_depth(frame, level, seed);
    case Disturbance::kContrast:
      return flatten(frame, level);
    case Disturbance::kLight:
      return relight(frame, level, seed);
    case Disturbance::kFocal:
      frame.camera.fx *= 1 + level / 100;
      frame.camera.fy *= 1 + level / 100;
      return;
    case Disturbance::kCentre: {
      const double angle = 2 * kPi * Random(seed).uniform();
      frame.camera.cx += level * std::cos(angle);
      frame.camera.cy += level * std::sin(angle);
      return;
    }
  }
}

}  // namespace binpick::app
