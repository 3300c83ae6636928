// From a matched template to a pose. A template shows the part on the optical axis; seen at pixel
// (u, v) the part looks the same when it is turned by the rotation that takes the optical axis to
// that pixel's ray.
#pragma once

#include "binpick/model/object_model.hpp"
#include "features/pyramid.hpp"
#include "search/candidate.hpp"

namespace binpick {

// Pose of the part's centre (the middle of its bounding box), in the frame's camera.
Pose candidate_pose(const ObjectModel& model, int depth, const Candidate& candidate,
                    const FeaturePyramid& pyramid);

// The same with another distance along the ray.
Pose on_ray(const Mat3& R_template, const Vec3& ray, double distance_mm);

}  // namespace binpick
