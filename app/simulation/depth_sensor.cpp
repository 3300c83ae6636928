#include "simulation/depth_sensor.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "binpick/geometry/angle.hpp"

namespace binpick::simulation {
namespace {

const Vec3 kProjectorInEye(50, -36, 4);  // mm, axes of the left eye

// The steps of one measurement; each pixel is looked at on its own, noise depends on its position.
class Matcher {
 public:
  Matcher(const Scene& scene, const View& view, const TrueView& truth, const Radiance& radiance,
          float exposure, const Roi& window, const DepthSensorParams& params, Rng rng)
      : scene_(scene),
        view_(view),
        truth_(truth),
        radiance_(radiance),
        exposure_(exposure),
        window_(window),
        params_(params),
        seed_(static_cast<std::uint32_t>(rng.next())),
        rng_(rng.fork(1)) {
    if (params.second_ray)
      second_ray_.emplace(scene.soup, shifted(view, Vec3(params.baseline_mm, 0, 0)));
    if (params.shadow_of_pattern) projector_.emplace(scene.soup, shifted(view, kProjectorInEye));
  }

  std::vector<std::uint16_t> run() {
    std::vector<std::uint16_t> depth(truth_.z_mm.size(), 0);
    for (int y = window_.y; y < window_.y + window_.height; ++y) {
      for (int x = window_.x; x < window_.x + window_.width; ++x) {
        // The same number of draws for every pixel keeps them in step.
        const double white = rng_.normal();
        const double luck = rng_.uniform();
        const std::size_t source = matched_surface(x, y);
        if (truth_.z_mm[source] <= 0 || !is_measured(source, x, y, luck)) continue;
        const double z = measured(smoothed(source) - echo_mm(source), x, y, white);
        depth[at(x, y)] =
            static_cast<std::uint16_t>(std::clamp(std::lround(z / params_.unit_mm), 0L, 65535L));
      }
    }
    if (params_.filled_gap_px > 0) fill_gaps(depth);
    add_outliers(depth);
    return depth;
  }

 private:
  static View shifted(const View& view, const Vec3& by) {
    View out = view;
    out.T_view_world.t_mm -= by;
    return out;
  }

  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(view_.width) +
           static_cast<std::size_t>(x);
  }

  float noise(int x, int y, double size_px, std::uint32_t which) const {
    return pixel_noise(static_cast<float>(x / size_px), static_cast<float>(y / size_px),
                       seed_ + which);
  }

  // Near an edge the window matches the nearer surface, up to a distance that varies along the
  // edge.
  std::size_t matched_surface(int x, int y) const {
    const double reach = params_.fattening_px * noise(x, y, 7, 1);
    const int steps = static_cast<int>(std::ceil(reach));
    std::size_t best = at(x, y);
    float z_best = truth_.z_mm[best];
    for (int dy = -steps; dy <= steps; ++dy) {
      for (int dx = -steps; dx <= steps; ++dx) {
        if (dx * dx + dy * dy > reach * reach) continue;
        const int u = x + dx;
        const int v = y + dy;
        if (u < 0 || v < 0 || u >= view_.width || v >= view_.height) continue;
        const float z = truth_.z_mm[at(u, v)];
        if (z > 0 && z < z_best - 1.5f) {
          z_best = z;
          best = at(u, v);
        }
      }
    }
    return best;
  }

  // The mean over the matching window, of what lies on the same surface.
  double smoothed(std::size_t source) const {
    const int x = static_cast<int>(source % static_cast<std::size_t>(view_.width));
    const int y = static_cast<int>(source / static_cast<std::size_t>(view_.width));
    const double z = truth_.z_mm[source];
    double sum = 0;
    int count = 0;
    const int reach = params_.window_px;
    for (int v = std::max(0, y - reach); v <= std::min(view_.height - 1, y + reach); ++v) {
      for (int u = std::max(0, x - reach); u <= std::min(view_.width - 1, x + reach); ++u) {
        const double other = truth_.z_mm[at(u, v)];
        if (other <= 0 || std::abs(other - z) > params_.window_mm) continue;
        sum += other;
        ++count;
      }
    }
    return sum / count;
  }

  // Whether a step of depth is so near that the pixel sees both sides.
  bool on_step(int x, int y) const {
    const double reach = params_.edge_px * (0.5 + noise(x, y, 5, 9));
    const auto steps = static_cast<int>(reach);
    const float z = truth_.z_mm[at(x, y)];
    for (int v = std::max(0, y - steps); v <= std::min(view_.height - 1, y + steps); ++v) {
      for (int u = std::max(0, x - steps); u <= std::min(view_.width - 1, x + steps); ++u) {
        if (std::abs(truth_.z_mm[at(u, v)] - z) > 2) return true;
      }
    }
    return false;
  }

  // Light that comes by way of the surroundings: what is nearer, on either side together, draws
  // the depth towards it. Nothing on a plane, whatever its slope.
  double echo_mm(std::size_t source) const {
    const double strength =
        is_metal(finish_at(source)) ? params_.metal_multipath : params_.multipath;
    if (strength <= 0) return 0;
    constexpr double kReach_mm = 14, kNearerMax_mm = 12;
    const double z = truth_.z_mm[source];
    const double reach_px = kReach_mm * view_.fx / z;
    const int x = static_cast<int>(source % static_cast<std::size_t>(view_.width));
    const int y = static_cast<int>(source / static_cast<std::size_t>(view_.width));
    double nearer = 0;
    constexpr int kDirections = 8;
    for (int i = 0; i < kDirections; ++i) {
      const double turn = 2 * kPi * i / kDirections;
      const int u = std::clamp(x + static_cast<int>(std::lround(reach_px * std::cos(turn))), 0,
                               view_.width - 1);
      const int v = std::clamp(y + static_cast<int>(std::lround(reach_px * std::sin(turn))), 0,
                               view_.height - 1);
      nearer += std::clamp(z - truth_.z_mm[at(u, v)], -kNearerMax_mm, kNearerMax_mm) / kDirections;
    }
    return strength * std::max(0.0, nearer);
  }

  Finish finish_at(std::size_t source) const {
    return scene_.bodies[static_cast<std::size_t>(truth_.body[source])].finish;
  }

  bool is_measured(std::size_t source, int x, int y, double luck) const {
    const double u = static_cast<double>(source % static_cast<std::size_t>(view_.width));
    const double v = static_cast<double>(source / static_cast<std::size_t>(view_.width));
    const Vec3 p = view_.position() + view_.ray(u, v) * truth_.z_mm[source];
    constexpr double kBias = 2.2;  // mm; less, and the map's pixels show on steep walls
    if (second_ray_ && second_ray_->visibility(p, kBias) < 0.5f) return false;
    if (params_.edge_px > 0 && on_step(x, y)) return false;
    // In the projector's shadow only stray light helps, in a few places.
    if (projector_ && projector_->visibility(p, kBias) < 0.5f && noise(x, y, 5, 2) < 0.85f)
      return false;
    const double facing = truth_.facing[source];
    const double sure =
        (facing - params_.grazing_cos_min) / (params_.grazing_cos_sure - params_.grazing_cos_min);
    if (sure < 0.15 + 0.7 * noise(x, y, 4, 3)) return false;
    const double level =
        exposure_ * (params_.by_own_light ? radiance_.projected : radiance_.value)[at(x, y)];
    const double blotch = noise(x, y, 4.5, 4) + 0.5 * noise(x, y, 14, 5);
    if (level > params_.glare_level * (0.55 + blotch)) return false;
    if (level < params_.dark_level * (1 + 5.0 / 3 * noise(x, y, 3, 6))) return false;
    return luck > 0.001;
  }

  double measured(double z, int x, int y, double white) const {
    const double to_disparity = view_.fx * params_.baseline_mm;
    const double factor = params_.plain_factor > 1 ? plainness(x, y) : 1;
    double disparity = to_disparity / z;
    disparity += factor * params_.noise_px * 0.25 * white;
    disparity += factor * params_.noise_px * 2.4 * (noise(x, y, 2.6, 7) - 0.5);
    disparity += factor * params_.drift_px * 2.4 * (noise(x, y, 24, 8) - 0.5);
    disparity = std::round(disparity / params_.disparity_step_px) * params_.disparity_step_px;
    return to_disparity / disparity;
  }

  // 1 where there is texture, up to plain_factor where there is none.
  double plainness(int x, int y) const {
    constexpr int kReach = 3;
    constexpr double kTexture = 0.12;  // contrast that matches well
    double sum = 0, squares = 0;
    int count = 0;
    for (int v = std::max(0, y - kReach); v <= std::min(view_.height - 1, y + kReach); ++v) {
      for (int u = std::max(0, x - kReach); u <= std::min(view_.width - 1, x + kReach); ++u) {
        const double value = radiance_.value[at(u, v)];
        sum += value, squares += value * value, ++count;
      }
    }
    const double mean = sum / count;
    const double spread = std::sqrt(std::max(0.0, squares / count - mean * mean));
    const double contrast = spread / std::max(mean, 1e-3);
    return 1 + (params_.plain_factor - 1) * std::max(0.0, 1 - contrast / kTexture);
  }

  // From the farther side, as what is hidden from one eye is mostly behind.
  void fill_gaps(std::vector<std::uint16_t>& depth) const {
    for (int y = window_.y; y < window_.y + window_.height; ++y) {
      int last = -1;  // measured
      for (int x = window_.x; x < window_.x + window_.width; ++x) {
        if (depth[at(x, y)] == 0) continue;
        if (last >= 0 && x - last > 1 && x - last - 1 <= params_.filled_gap_px) {
          const std::uint16_t fill = std::max(depth[at(last, y)], depth[at(x, y)]);
          for (int u = last + 1; u < x; ++u) depth[at(u, y)] = fill;
        }
        last = x;
      }
    }
  }

  // Small patches where the wrong window matched.
  void add_outliers(std::vector<std::uint16_t>& depth) {
    constexpr double kPixelsEach = 14;
    const int count =
        static_cast<int>(params_.outlier_share * window_.width * window_.height / kPixelsEach);
    for (int i = 0; i < count; ++i) {
      const int x0 = window_.x + rng_.below(window_.width);
      const int y0 = window_.y + rng_.below(window_.height);
      const double radius = rng_.uniform(0.6, 3.2);
      const double shift = rng_.normal() * 14;
      for (int y = y0 - 3; y <= y0 + 3; ++y) {
        for (int x = x0 - 3; x <= x0 + 3; ++x) {
          if (x < 0 || y < 0 || x >= view_.width || y >= view_.height) continue;
          if (std::hypot(x - x0, y - y0) > radius || depth[at(x, y)] == 0) continue;
          const double z = depth[at(x, y)] * params_.unit_mm + shift;
          depth[at(x, y)] =
              static_cast<std::uint16_t>(std::max(0L, std::lround(z / params_.unit_mm)));
        }
      }
    }
  }

  const Scene& scene_;
  const View& view_;
  const TrueView& truth_;
  const Radiance& radiance_;
  float exposure_;
  Roi window_;
  DepthSensorParams params_;
  std::optional<ShadowMap> second_ray_, projector_;  // those that this kind of sensor needs
  std::uint32_t seed_;
  Rng rng_;
};

}  // namespace

TrueView make_true_view(const Scene& scene, const View& view) {
  ZBuffer buffer(view.width, view.height);
  rasterise(scene.soup, 0, scene.soup.count(), view, buffer);
  TrueView truth;
  for (int y = 0; y < view.height; ++y) {
    for (int x = 0; x < view.width; ++x) {
      const int triangle = buffer.triangle[buffer.index(x, y)];
      if (triangle < 0) {
        truth.z_mm.push_back(0);
        truth.facing.push_back(0);
        truth.body.push_back(-1);
        continue;
      }
      const auto t = static_cast<std::size_t>(triangle);
      const auto& c = scene.soup.corners[t];
      const Vec3 normal = (c[1] - c[0]).cross(c[2] - c[0]).cast<double>().normalized();
      truth.z_mm.push_back(1 / buffer.inverse_z[buffer.index(x, y)]);
      truth.facing.push_back(static_cast<float>(std::abs(normal.dot(view.ray(x, y).normalized()))));
      truth.body.push_back(scene.soup.body[t]);
    }
  }
  return truth;
}

std::vector<std::uint16_t> sense_depth(const Scene& scene, const View& view, const TrueView& truth,
                                       const Radiance& radiance, float exposure, const Roi& window,
                                       const DepthSensorParams& params, Rng rng) {
  return Matcher(scene, view, truth, radiance, exposure, window, params, rng).run();
}

}  // namespace binpick::simulation
