#include "simulation/shading.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "binpick/geometry/angle.hpp"

namespace binpick::simulation {
namespace {

using Eigen::Vector3f;
const Vec3 kProjectorOffset(58, -42, 4);  // beside the gray camera, in its axes
constexpr double kTexelBiasMm = 0.7;

struct SurfaceLook {
  float albedo = 0.3f;
  float reflectance = 0.04f;  // at normal incidence
  float roughness = 0.5f;
};

float stripe(float t) {
  return t - std::floor(t) < 0.5f ? 1.0f : 0.0f;
}

// A bench top with a grid of tapped holes and warning tape beside the bin.
SurfaceLook bench_look(const Vector3f& p, std::uint32_t seed) {
  SurfaceLook look;
  look.albedo =
      0.10f + 0.07f * fractal_noise(p / 35, seed) + 0.03f * value_noise(p / 0.9f, seed + 7);
  look.roughness = 0.55f;
  const float hx = std::remainder(p.x(), 50.0f);
  const float hy = std::remainder(p.y() - 25, 50.0f);
  if (hx * hx + hy * hy < 12) look.albedo = 0.02f;
  const float tape = std::abs(p.y()) - 116;
  if (tape > 0 && tape < 16 && std::abs(p.x()) < 230) {
    const float wear = fractal_noise(p / 6, seed + 3) > 0.68f ? 0.6f : 1.0f;
    look.albedo = wear * (stripe((p.x() + p.y()) / 28) > 0 ? 0.42f : 0.04f);
  }
  return look;
}

SurfaceLook bin_look(const Vector3f& p, std::uint32_t seed) {
  SurfaceLook look;
  look.albedo = 0.20f + 0.08f * fractal_noise(p / 20, seed);
  // Scratches: noise drawn out along two slanting directions.
  const Vector3f along(0.8f * p.x() + 0.6f * p.y(), 0.8f * p.y() - 0.6f * p.x(), p.z());
  const float first = value_noise({along.x() / 40, along.y() / 0.5f, along.z() / 9}, seed + 5);
  const float second = value_noise({p.x() / 0.6f, p.y() / 34, p.z() / 7}, seed + 6);
  const float worn = value_noise(p / 26, seed + 8);
  look.albedo += 0.10f * std::max(0.0f, std::max(first, second) + 0.35f * worn - 0.95f) / 0.2f;
  look.roughness = 0.42f;
  return look;
}

SurfaceLook look_of(const Body& body, const Vector3f& p) {
  SurfaceLook look;
  const std::uint32_t seed = body.seed;
  const float stain = fractal_noise(p / 9, seed + 11);
  switch (body.finish) {
    case Finish::kCastBrass:
      look = {0.26f + 0.14f * fractal_noise(p / 1.6f, seed), 0.34f, 0.46f + 0.1f * stain};
      break;
    case Finish::kGalvanised: {
      const float spangle = cell_noise(p / 3.6f, seed);
      look = {0.22f + 0.14f * spangle, 0.42f, 0.40f + 0.16f * spangle};
      break;
    }
    case Finish::kMachined: {
      const float grooves = value_noise({0.2f, 0.3f, p.z() / 0.35f}, seed);
      look = {0.20f + 0.08f * grooves + 0.05f * value_noise(p / 0.7f, seed + 2), 0.44f,
              0.36f + 0.1f * grooves};
      break;
    }
    case Finish::kPolished:
      look = {0.07f + 0.02f * stain, 0.58f, 0.24f + 0.06f * value_noise(p / 5, seed)};
      break;
    case Finish::kRubber:
      look = {0.05f + 0.02f * value_noise(p / 0.8f, seed), 0.04f, 0.5f};
      break;
    case Finish::kPlastic:
      look = {0.42f + 0.05f * value_noise(p / 0.8f, seed), 0.05f, 0.45f};
      break;
    case Finish::kBench:
      look = bench_look(p, seed);
      break;
    case Finish::kBin:
      look = bin_look(p, seed);
      break;
  }
  if (stain > 0.66f && body.part >= 0) look.albedo *= 0.75f;  // oil and dirt
  look.albedo *= body.brightness;
  return look;
}

// Microfacet highlight (GGX), with the geometry term folded into the constant.
float highlight(const SurfaceLook& look, const Vec3& normal, const Vec3& to_light,
                const Vec3& to_camera) {
  const Vec3 half = (to_light + to_camera).normalized();
  const double alpha = look.roughness * look.roughness;
  const double c = std::max(0.0, normal.dot(half));
  const double d = c * c * (alpha * alpha - 1) + 1;
  return static_cast<float>(look.reflectance * alpha * alpha / (kPi * d * d) / 4);
}

}  // namespace

Shader::Shader(const Scene& scene, const View& camera, Rng rng) : scene_(scene), camera_(camera) {
  const Vec3 middle(0, 0, scene.bin.height / 2);
  const Vec3 projector = camera.T_view_world.inverse() * kProjectorOffset;
  lights_.push_back({ShadowMap(scene.soup, View::looking(projector, middle, 0.62, 1400)), 0.95f,
                     (projector - middle).norm(), true});
  const double side = rng.uniform(0, 2 * kPi);
  const Vec3 lamp(620 * std::cos(side), 620 * std::sin(side), rng.uniform(750, 1050));
  lamp_direction_ = (lamp - middle).normalized();
  constexpr int kLampSamples = 7;
  for (int i = 0; i < kLampSamples; ++i) {
    const double dx = rng.uniform(-110, 110);
    const double dy = rng.uniform(-110, 110);
    const Vec3 at = lamp + Vec3(dx, dy, 0);
    lights_.push_back({ShadowMap(scene.soup, View::looking(at, middle, 0.34, 900)),
                       0.42f / kLampSamples, (at - middle).norm(), true});
  }
  constexpr int kRoomSamples = 20;
  for (int i = 0; i < kRoomSamples; ++i) {  // evenly over the sky, more from above
    const double z = std::sqrt(0.12 + 0.88 * (i + 0.5) / kRoomSamples);
    const double turn = kPi * (1 + std::sqrt(5.0)) * i + side;
    const double r = std::sqrt(1 - z * z);
    const Vec3 at = middle + 1800 * Vec3(r * std::cos(turn), r * std::sin(turn), z);
    lights_.push_back({ShadowMap(scene.soup, View::looking(at, middle, 0.2, 560)),
                       0.34f / kRoomSamples, 1800, false});
  }
}

Shader::Shade Shader::shade(int triangle, const Vec3& p, const Vec3& to_camera) const {
  const auto t = static_cast<std::size_t>(triangle);
  const Body& body = scene_.bodies[static_cast<std::size_t>(scene_.soup.body[t])];
  const auto& c = scene_.soup.corners[t];
  const auto& n = scene_.soup.normals[t];
  // Barycentric weights of the point in its triangle.
  const Vec3 a = c[0].cast<double>();
  const Vec3 e1 = c[1].cast<double>() - a;
  const Vec3 e2 = c[2].cast<double>() - a;
  const Vec3 face = e1.cross(e2);
  const double w1 = (p - a).cross(e2).dot(face) / face.squaredNorm();
  const double w2 = e1.cross(p - a).dot(face) / face.squaredNorm();
  Vec3 normal =
      ((1 - w1 - w2) * n[0].cast<double>() + w1 * n[1].cast<double>() + w2 * n[2].cast<double>());
  normal.normalize();
  if (normal.dot(to_camera) < 0) normal = -normal;

  const Vec3 p_obj = body.T_world_obj.inverse() * p;
  const SurfaceLook look = look_of(body, p_obj.cast<float>());
  const Vec3 lifted = p + 0.5 * normal;  // off the surface, against shadows of itself
  float sum = 0;
  float projected = 0;
  float room_seen = 0;
  float room_all = 1e-6f;
  for (const auto& light : lights_) {
    const Vec3 away = light.map.view().position() - p;
    const double distance = away.norm();
    const Vec3 to_light = away / distance;
    const auto facing = static_cast<float>(normal.dot(to_light));
    if (!light.specular) room_all += 1;
    if (facing <= 0) continue;
    const float seen = light.map.visibility(lifted, kTexelBiasMm);
    if (seen <= 0) continue;
    if (!light.specular) room_seen += seen;
    const double reach = light.distance_mm / distance;
    const float power = seen * light.power * static_cast<float>(reach * reach) * facing;
    sum += power * look.albedo;
    if (light.specular) sum += power * highlight(look, normal, to_light, to_camera);
    if (&light == &lights_.front()) projected = sum;
  }
  // Metal mirrors the room: bright ceiling, brighter towards the lamp, dark near the horizon.
  const Vec3 mirrored = 2 * normal.dot(to_camera) * normal - to_camera;
  const double towards_lamp = std::max(0.0, mirrored.dot(lamp_direction_));
  const double room =
      0.05 + 0.22 * std::max(0.0, mirrored.z()) + 0.5 * std::pow(towards_lamp, 12.0);
  return {sum + look.reflectance * static_cast<float>(room) * room_seen / room_all, projected};
}

Radiance Shader::render(const Roi& window) const {
  const View fine = camera_.doubled();
  ZBuffer buffer(fine.width, fine.height);
  rasterise(scene_.soup, 0, scene_.soup.count(), fine, buffer);
  const Vec3 eye = camera_.position();
  const auto sample = [&](int x, int y) {
    const std::size_t at = buffer.index(x, y);
    if (buffer.triangle[at] < 0) return Shade{};
    const Vec3 ray = fine.ray(x, y);
    return shade(buffer.triangle[at], eye + ray / buffer.inverse_z[at], -ray.normalized());
  };
  const auto face = [&](int triangle) {
    const auto& c = scene_.soup.corners[static_cast<std::size_t>(triangle)];
    return Vector3f((c[1] - c[0]).cross(c[2] - c[0]).normalized());
  };
  Radiance out;
  out.value.resize(static_cast<std::size_t>(camera_.width) *
                   static_cast<std::size_t>(camera_.height));
  out.projected.resize(out.value.size());
  for (int y = window.y; y < window.y + window.height; ++y) {
    for (int x = window.x; x < window.x + window.width; ++x) {
      const int first = buffer.triangle[buffer.index(2 * x, 2 * y)];
      bool plain = first >= 0;
      for (int k = 1; k < 4 && plain; ++k) {
        const int other = buffer.triangle[buffer.index(2 * x + k % 2, 2 * y + k / 2)];
        if (other == first) continue;
        plain = other >= 0 &&
                scene_.soup.body[static_cast<std::size_t>(other)] ==
                    scene_.soup.body[static_cast<std::size_t>(first)] &&
                face(other).dot(face(first)) > 0.95f;
      }
      Shade value = sample(2 * x, 2 * y);
      if (!plain) {
        const Shade right = sample(2 * x + 1, 2 * y), below = sample(2 * x, 2 * y + 1),
                    across = sample(2 * x + 1, 2 * y + 1);
        value.all += right.all + below.all + across.all;
        value.projected += right.projected + below.projected + across.projected;
        value.all /= 4;
        value.projected /= 4;
      }
      const std::size_t at = static_cast<std::size_t>(y) * static_cast<std::size_t>(camera_.width) +
                             static_cast<std::size_t>(x);
      out.value[at] = value.all;
      out.projected[at] = value.projected;
    }
  }
  return out;
}

std::vector<unsigned char> expose(const Radiance& radiance, const View& view, float exposure,
                                  Rng rng) {
  cv::Mat image(view.height, view.width, CV_32F);
  for (int y = 0; y < view.height; ++y) {
    for (int x = 0; x < view.width; ++x) {
      const std::size_t at = static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width) +
                             static_cast<std::size_t>(x);
      const double du = (x - view.cx) / view.fx;
      const double dv = (y - view.cy) / view.fy;
      const auto vignette = static_cast<float>(1 / std::pow(1 + du * du + dv * dv, 2.0));
      image.at<float>(y, x) = std::min(255 * exposure * vignette * radiance.value[at], 1500.0f);
    }
  }
  cv::GaussianBlur(image, image, cv::Size(5, 5), 0.6);
  std::vector<unsigned char> gray;
  gray.reserve(radiance.value.size());
  for (int y = 0; y < view.height; ++y) {
    for (int x = 0; x < view.width; ++x) {
      const double level = image.at<float>(y, x);
      const double noise = std::sqrt(0.8 + 0.012 * level) * rng.normal();
      gray.push_back(
          static_cast<unsigned char>(std::clamp(std::lround(level + noise + 3), 0L, 255L)));
    }
  }
  return gray;
}

}  // namespace binpick::simulation
