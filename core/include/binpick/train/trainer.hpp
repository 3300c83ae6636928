// CAD to model file: renders the part from all around, accumulates orientation histograms
// (PCOF-MOD, paper section III-A), builds the balanced pose tree bottom-up (section III-B,
// Algorithm 1) and the per-viewpoint surface and contour samples that refinement and verification
// use. The defaults are the paper's. Same mesh, options and seed give the same bytes on any number
// of threads.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "binpick/base/worker_pool.hpp"
#include "binpick/geometry/camera_model.hpp"
#include "binpick/model/model_trials.hpp"
#include "binpick/model/normal_codebook.hpp"
#include "binpick/train/mesh.hpp"

namespace binpick::train {

struct TrainOptions {
  CameraIntrinsics camera;       // of the sensor that will be used
  double distance_min_mm = 500;  // camera to object origin
  double distance_max_mm = 700;
  double tilt_max_deg =
      180;  // viewpoints within this angle of the object's +z axis; 180: all around
  // PCOF-MOD (section III-A)
  int samples = 1000;  // N, randomized renderings per template
  // Th of the gradient and the normal histograms: the share of the samples that has to vote for a
  // bin. The paper's 100 and 200 of 1000.
  double gradient_threshold = 0.1, normal_threshold = 0.2;
  double tilt_jitter_deg = 10;     // +- around x and y
  double roll_jitter_deg = 7.5;    // +- around the optical axis
  double distance_jitter_mm = 90;  // +-
  // Balanced pose tree (section III-B)
  double roll_interval_deg = 6;  // at the leaves; rounded so that it halves evenly to the roots
  // At the leaves, in the (geometric) middle of the range; in proportion to the distance elsewhere,
  // and wider where 64 steps do not span the range.
  double distance_interval_mm = 70;
  int tree_depths = 4;  // 12, 42, 162, 642 viewpoints
  // Ours
  NormalCodebook normal_codebook = NormalCodebook::kHemisphere;
  int contour_features = 56;  // pixels of a template with a gradient orientation, at most
  int surface_features = 40;  // further pixels with a normal orientation only, at most
  std::uint64_t seed = 1;
};

// Called with the share of the work done, 0..1, from one thread at a time.
using TrainProgress = std::function<void(double)>;

// The bytes of the model file. Throws TrainError (options out of range, part does not fit the
// camera) or RenderError.
std::vector<std::uint8_t> train_model(const ImportedMesh& part, const TrainOptions& options,
                                      WorkerPool& pool, const TrainProgress& progress);

// Of each near symmetry of a model, in its order: whether detection cannot tell it.
struct NearSymmetries {
  std::vector<bool> turns, axes;
  bool any() const;
};

// Both put into the bytes of a model what trying it on simulated piles told.
void set_indistinguishable(std::vector<std::uint8_t>& model, const NearSymmetries& which);
void set_trials(std::vector<std::uint8_t>& model, const ModelTrials& trials);

}  // namespace binpick::train
