#include "pose/ray_pose.hpp"

namespace binpick {

Pose on_ray(const Mat3& R_template, const Vec3& ray, double distance_mm) {
  return {rotation_between(Vec3::UnitZ(), ray) * R_template, ray * distance_mm};
}

Pose candidate_pose(const ObjectModel& model, int depth, const Candidate& c,
                    const FeaturePyramid& pyramid) {
  const double u = c.x + c.best_pixel % 2, v = c.y + c.best_pixel / 2;
  const Vec3 ray = pyramid.level(c.level).camera.ray(u, v);
  return on_ray(model.rotation(depth, c.viewpoint, c.roll), ray,
                model.distance_mm(depth, c.distance));
}

}  // namespace binpick
