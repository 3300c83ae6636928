// What the gray camera sees of a scene: the sensor's projector beside the camera, a lamp to one
// side and the dim room, each with shadows; dull or metallic surfaces with texture.
#pragma once

#include <vector>

#include "simulation/scene.hpp"

namespace binpick::simulation {

// Light that leaves the surfaces, before exposure; 1 is what a white dull surface sends back when
// the projector shines straight at it.
struct Radiance {
  std::vector<float> value;      // one per pixel of the view
  std::vector<float> projected;  // the share of it that the sensor's own projector sent
};

class Shader {
 public:
  Shader(const Scene& scene, const View& camera, Rng rng);

  // Two by two samples per pixel where bodies meet or the surface turns, one elsewhere. Dark
  // outside the window.
  Radiance render(const Roi& window) const;

 private:
  struct Light {
    ShadowMap map;
    float power;  // at distance_mm
    double distance_mm;
    bool specular;  // the room only brightens; lamp and projector also make highlights
  };

  struct Shade {
    float all = 0, projected = 0;
  };
  Shade shade(int triangle, const Vec3& p, const Vec3& to_camera) const;

  const Scene& scene_;
  View camera_;
  std::vector<Light> lights_;
  Vec3 lamp_direction_;
};

// Exposes, blurs, adds noise and rounds to 8 bit.
std::vector<unsigned char> expose(const Radiance& radiance, const View& view, float exposure,
                                  Rng rng);

}  // namespace binpick::simulation
