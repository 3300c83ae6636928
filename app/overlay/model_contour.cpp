#include "overlay/model_contour.hpp"

namespace binpick::app {

std::vector<Vec2> contour_points_px(const ObjectModel& model, const CameraIntrinsics& camera,
                                    const Pose& T_cam_obj) {
  // Samples are in the coordinates of the middle of the part's bounding box.
  const Pose T_cam_centre = T_cam_obj * Pose{Mat3::Identity(), model.centre_mm()};
  // From the camera to the part, in object axes; for a trained viewpoint that is the third row of
  // its rotation.
  const Vec3 sight = T_cam_centre.R.transpose() * T_cam_centre.t_mm.normalized();
  const TreeDepth& leaves = model.depth(model.depth_count() - 1);
  const Viewpoint* nearest = nullptr;
  double nearest_cos = -2;
  for (const Viewpoint& v : leaves.viewpoints) {
    const Vec3 axis(v.R_view_obj[6], v.R_view_obj[7], v.R_view_obj[8]);
    if (axis.dot(sight) > nearest_cos) {
      nearest_cos = axis.dot(sight);
      nearest = &v;
    }
  }
  std::vector<Vec2> points;
  if (nearest == nullptr) return points;
  const SampleArrays contour = model.contour(*nearest);
  for (int i = 0; i < contour.count; ++i) {
    const Vec3 point_cam =
        T_cam_centre * Eigen::Vector3f(contour.x[i], contour.y[i], contour.z[i]).cast<double>();
    if (point_cam.z() > 0) points.push_back(camera.project(point_cam));
  }
  return points;
}

}  // namespace binpick::app
