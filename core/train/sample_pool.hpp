// The pool of rendered samples that all templates share. A template's samples differ in viewpoint,
// roll and distance. Roll is a rotation of the image, so it needs no rendering; neighbouring
// viewpoints' ranges of tilt overlap, so their samples are the same ones. What is rendered is one
// set of viewpoints, spread evenly over the sphere, each at a random distance; what is kept of a
// rendering is its list of features.
#pragma once

#include <cstdint>
#include <vector>

#include "binpick/train/renderer.hpp"
#include "train/pose_tree.hpp"

namespace binpick::train {

// Positions in px from the projection of the object's centre, at the pyramid level of the leaves.
struct ContourPoint {
  float x, y;
  float angle_rad;  // of the gradient
};
struct SurfacePoint {
  float x, y;
  float tilt_sin, azimuth_rad;  // of the normal, in the frame of its viewing ray
};

struct RenderedSample {
  Vec3 direction_obj;
  Mat3 R_view_obj;
  double distance_mm = 0;
  std::vector<ContourPoint> contour;
  std::vector<SurfacePoint> surface;
};

// How a part is rendered for its templates: a square image around the object's centre.
struct TemplateCamera {
  CameraIntrinsics
      intrinsics;  // at the leaves' pyramid level; the centre projects onto pixel (radius, radius)
  int radius = 0;  // px; the part never reaches further; a multiple of 8: the grid halves evenly
  int base_level = 0;
  int scan_depth = 0;  // tree depth whose templates are scanned exhaustively
  double reference_distance_mm = 0;
};

// Chooses the pyramid level of the leaves so that the part's diameter spans 50 to 100 px there
// (fewer only where the image itself has fewer), and the depth at which the search starts: the
// coarsest one where the part's middle extent still spans enough pixels to have a shape. Throws
// TrainError when the part would be too small to be seen or the camera inside it.
TemplateCamera make_template_camera(const TrainOptions& options, const MeshBounds& bounds);

// Features of one rendering, as the detector would extract them from a perfect image of it: outline
// (depth steps) and sharp creases as gradients, normals by plane fit.
void extract_features(const RenderedView& view, const CameraIntrinsics& camera,
                      RenderedSample& out);

// Of a pooled rendering's surface points only every fourth is kept: normals vary slowly, and the
// lists of a viewpoint's samples have to stay in the cache while all its rolls are made.
inline constexpr int kPooledSurfaceStride = 4;

// Renders viewpoints, `count` over the whole sphere; those that no leaf of the tree takes are left
// out.
std::vector<RenderedSample> make_sample_pool(const Mesh& centred_mesh, const TrainOptions& options,
                                             const PoseTree& tree, const TemplateCamera& camera,
                                             int count, WorkerPool& pool,
                                             const TrainProgress& progress);

// Renderings that fall into the tilt jitter of a viewpoint, each with the turn that carries it into
// that viewpoint's frame: image of the sample, rotated by `turn_rad`, is the image at roll 0.
struct AlignedSample {
  int index;
  float turn_rad;
};
std::vector<AlignedSample> samples_near(const TreeViewpoint& view,
                                        const std::vector<RenderedSample>& pool,
                                        double tilt_jitter_deg);

}  // namespace binpick::train
