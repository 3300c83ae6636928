// Each kind of sensor has the faults that it is known for, on a block that stands in a bin.
#include "simulation/sensor_kind.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace binpick::simulation {
namespace {

constexpr double kSide_mm = 40;

Part block() {
  Part part;
  part.obj_id = 1;
  const double h = kSide_mm / 2;
  for (int i = 0; i < 8; ++i)
    part.mesh.add_vertex({(i & 1) != 0 ? h : -h, (i & 2) != 0 ? h : -h, (i & 4) != 0 ? h : -h});
  constexpr int kFaces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& f : kFaces) {
    part.mesh.add_triangle(f[0], f[1], f[2]);
    part.mesh.add_triangle(f[0], f[2], f[3]);
  }
  return part;
}

struct Sensed {
  View view;
  TrueView truth;
  std::vector<std::uint16_t> depth;
  double unit_mm = 0;

  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width) +
           static_cast<std::size_t>(x);
  }
  double depth_mm(std::size_t i) const { return depth[i] * unit_mm; }
  bool on_block(std::size_t i) const { return truth.body[i] == 2; }  // after bench and bin
  bool beside_block(int x, int y, int reach) const {
    for (int v = y - reach; v <= y + reach; ++v) {
      for (int u = x - reach; u <= x + reach; ++u) {
        if (on_block(at(u, v)) != on_block(at(x, y))) return true;
      }
    }
    return false;
  }
};

Sensed sense(SensorKind kind, Finish finish = Finish::kPlastic) {
  const BinSize bin;
  PlacedPart placed;
  placed.T_world_obj.t_mm = Vec3(0, 0, kSide_mm / 2);
  PartsAsMade as_made;
  as_made.finish = finish;
  const Scene scene = make_scene({block()}, {placed}, bin, as_made, Rng(1));
  CameraParams camera;
  camera.width = 640, camera.height = 512;
  camera.fx = camera.fy = 950, camera.cx = 319.5, camera.cy = 255.5;
  camera.distance_mm = 600;
  camera.tilt_max_rad = 0;
  Sensed out;
  out.view = make_camera(camera, bin, Rng(2));
  out.truth = make_true_view(scene, out.view);
  const Roi window{180, 160, 280, 190};
  const Radiance radiance = Shader(scene, out.view, Rng(3)).render(window);
  const DepthSensorParams params = sensor_params(kind);
  out.unit_mm = params.unit_mm;
  out.depth = sense_depth(scene, out.view, out.truth, radiance, 1, window, params, Rng(4));
  return out;
}

// Counts the pixels of a region of the image, well inside the window, that hold.
template <class Holds>
double share_of(const Sensed& sensed, const auto& region, Holds&& holds) {
  int all = 0, held = 0;
  for (int y = 175; y < 335; ++y) {
    for (int x = 195; x < 445; ++x) {
      if (!region(x, y)) continue;
      ++all;
      held += holds(sensed.at(x, y));
    }
  }
  return all > 0 ? static_cast<double>(held) / all : 0;
}

double missing_share(const Sensed& s, const auto& region) {
  return share_of(s, region, [&](std::size_t i) { return s.depth[i] == 0; });
}

class EveryKind : public testing::TestWithParam<SensorKind> {};

TEST_P(EveryKind, MeasuresTheTopOfTheBlock) {
  const Sensed s = sense(GetParam());
  const auto top = [&](int x, int y) {
    return s.on_block(s.at(x, y)) && s.truth.facing[s.at(x, y)] > 0.9f && !s.beside_block(x, y, 8);
  };
  EXPECT_GT(share_of(s, top,
                     [&](std::size_t i) {
                       return std::abs(s.depth_mm(i) - static_cast<double>(s.truth.z_mm[i])) < 2;
                     }),
            0.95);
}

TEST_P(EveryKind, IsReadByItsName) {
  EXPECT_EQ(sensor_kind_of(sensor_kind_name(GetParam())), GetParam());
  EXPECT_EQ(sensor_kind_of("a camera"), std::nullopt);
}

INSTANTIATE_TEST_SUITE_P(Sensors, EveryKind, testing::ValuesIn(kSensorKinds), [](const auto& kind) {
  return std::string(sensor_kind_name(kind.param));
});

// Of the floor about the block, what the second ray does not see.
TEST(SensorKind, OnlyPassiveStereoAndTimeOfFlightHaveDepthInTheShadow) {
  const auto missing = [](SensorKind kind) {
    const Sensed s = sense(kind);
    return missing_share(
        s, [&](int x, int y) { return !s.on_block(s.at(x, y)) && s.beside_block(x, y, 6); });
  };
  EXPECT_GT(missing(SensorKind::kActiveStereo), 0.1);
  EXPECT_GT(missing(SensorKind::kStructuredLight), 0.2);
  EXPECT_LT(missing(SensorKind::kPassiveStereo), 0.01);
  EXPECT_LT(missing(SensorKind::kTimeOfFlight), 0.05);
}

TEST(SensorKind, TimeOfFlightHasFlyingPixels) {
  const auto flying = [](SensorKind kind) {
    const Sensed s = sense(kind);
    const double top_mm = static_cast<double>(s.truth.z_mm[s.at(320, 256)]);
    return share_of(
        s, [&](int x, int y) { return s.beside_block(x, y, 1); },
        [&](std::size_t i) {
          return s.depth_mm(i) > top_mm + kSide_mm / 5 && s.depth_mm(i) < top_mm + 4 * kSide_mm / 5;
        });
  };
  EXPECT_GT(flying(SensorKind::kTimeOfFlight), 0.3);
  EXPECT_LT(flying(SensorKind::kActiveStereo), 0.1);
  EXPECT_LT(flying(SensorKind::kStructuredLight), 0.1);
}

TEST(SensorKind, StructuredLightLosesMetal) {
  const auto lost = [](SensorKind kind, Finish finish) {
    const Sensed s = sense(kind, finish);
    return missing_share(
        s, [&](int x, int y) { return s.on_block(s.at(x, y)) && !s.beside_block(x, y, 4); });
  };
  EXPECT_GT(lost(SensorKind::kStructuredLight, Finish::kPolished),
            lost(SensorKind::kStructuredLight, Finish::kPlastic) + 0.1);
}

TEST(PartsAsMade, AreAsLargeAsTheyAreMade) {
  const auto width = [](double scale) {
    PartsAsMade as_made;
    as_made.scale = scale;
    const Scene scene = make_scene({block()}, {PlacedPart{}}, BinSize{}, as_made, Rng(1));
    float low = 0, high = 0;
    for (int t = scene.bodies[2].first; t < scene.bodies[2].last; ++t) {
      for (const auto& corner : scene.soup.corners[static_cast<std::size_t>(t)]) {
        low = std::min(low, corner.x());
        high = std::max(high, corner.x());
      }
    }
    return static_cast<double>(high - low);
  };
  EXPECT_NEAR(width(1), kSide_mm, 1e-4);
  EXPECT_NEAR(width(1.005), 1.005 * kSide_mm, 1e-4);
}

}  // namespace
}  // namespace binpick::simulation
