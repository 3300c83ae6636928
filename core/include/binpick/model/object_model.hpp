// A trained part, read in place from the bytes of a model file. ObjectModel borrows: whoever loaded
// the bytes keeps them alive and unchanged. parse() checks everything (magic, version, checksum,
// bounds of each table, each index), so that afterwards every access is valid whatever the file's
// origin. Thread-safe: immutable.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "binpick/base/result.hpp"
#include "binpick/geometry/camera_model.hpp"
#include "binpick/model/model_trials.hpp"
#include "binpick/model/normal_codebook.hpp"
#include "binpick/model/part_symmetry.hpp"

namespace binpick {

struct ModelHeader;

inline constexpr int kModelDepthsMax = 4;
inline constexpr int kModelDistancesMax = 64;                 // at one depth
inline constexpr std::size_t kModelScanTemplatesMax = 65536;  // at the scan depth

// What the model was trained for; written to the file as it stands here, little-endian.
struct ModelInfo {
  std::uint64_t source_hash;  // FNV-1a 64 of the CAD file
  std::uint64_t seed;
  CameraIntrinsics camera;
  double distance_min_mm, distance_max_mm;
  double reference_distance_mm;  // templates are stored as seen from here
  double tilt_max_deg;
  double diameter_mm;
  double bounds_min_mm[3], bounds_max_mm[3];
  double tilt_jitter_deg, roll_jitter_deg, distance_jitter_mm;
  std::int32_t samples, gradient_threshold, normal_threshold;
  std::int32_t base_level;  // pyramid level (1/2^base_level of the image) of the leaves at
                            // reference distance
  std::int32_t scan_depth;  // the tree depth whose templates are scanned exhaustively
  std::int32_t depth_count;
  std::int32_t triangle_count;
  std::int32_t source_unit;  // a train::LengthUnit
  NormalCodebook normal_codebook;
  std::uint8_t reserved[7];
};

// One pixel of a template, both modalities (paper eq. 1): offset from the projection of the
// object's origin in pixels of its pyramid level, bits of the accepted orientations and their
// weights. A modality that says nothing here has weight 0 and no bits. At depths below the scan
// depth x and y are even: the rearranged maps hold a block for every second pixel.
struct Feature {
  std::int8_t x, y;
  std::uint8_t gradient_bits, gradient_weight;
  std::uint8_t normal_bits, normal_weight;
};
inline constexpr int kFeatureWeightMax = 31;

// The features of one (viewpoint, roll).
struct TemplateRange {
  std::uint32_t first;  // index into the table of features
  std::uint16_t count;
  std::uint16_t gradient_weight_sum;
  std::uint16_t normal_weight_sum;
  std::uint16_t reserved;
};

// A viewpoint of the subdivided icosahedron. R_view_obj at roll 0 takes object axes to the axes of
// a camera that looks at the object from here.
struct Viewpoint {
  float R_view_obj[9];       // row-major
  std::int32_t parent;       // index at the depth above; -1 at depth 0
  std::int32_t child_first;  // children at the depth below are consecutive
  std::int32_t child_count;
  // Leaves only: samples seen from here. `first` is the place of x[0] in the table of samples.
  std::uint32_t surface_first, surface_count;
  std::uint32_t contour_first, contour_count;
  std::uint32_t outline_count;  // of the contour samples; the rest are on creases
  float sample_area_mm2;        // leaves only: projected area, at the reference distance, that one
                                // surface sample stands for
};

// One depth of the balanced pose tree: the product of viewpoints, rolls and distances.
struct TreeDepth {
  std::span<const Viewpoint> viewpoints;
  int roll_count = 0;
  int distance_count = 0;
  std::span<const TemplateRange> templates;  // viewpoint-major: [viewpoint * roll_count + roll]
};

// Points that a leaf viewpoint shows, as a structure of arrays in object coordinates: positions in
// mm, and unit directions. Each array is padded with zeros to a multiple of kSampleLanes, so that
// vector code needs no special end.
inline constexpr int kSampleLanes = 8;
inline constexpr int kSurfaceSamplesMax = 320;
inline constexpr int kContourSamplesMax = 192;

struct SampleArrays {
  int count = 0;
  const float *x = nullptr, *y = nullptr, *z = nullptr;
  const float *dx = nullptr, *dy = nullptr, *dz = nullptr;

  // The first `n`.
  SampleArrays first(int n) const {
    SampleArrays out = *this;
    out.count = n;
    return out;
  }
};
inline std::uint64_t padded_samples(std::uint64_t count) {
  return (count + kSampleLanes - 1) / kSampleLanes * kSampleLanes;
}

class ObjectModel {
 public:
  static Result<ObjectModel> parse(std::span<const std::uint8_t> bytes);

  const ModelInfo& info() const { return *info_; }
  Vec3 centre_mm() const;  // of the bounding box, in the CAD's coordinates
  const ModelTrials& trials() const { return *trials_; }
  int depth_count() const { return info_->depth_count; }
  const TreeDepth& depth(int d) const { return depths_[d]; }
  std::span<const Feature> features(const TemplateRange& t) const {
    return features_.subspan(t.first, t.count);
  }
  // The visible surface; directions are outward normals. Any prefix is spread over all of it.
  SampleArrays surface(const Viewpoint& v) const {
    return arrays(v.surface_first, v.surface_count);
  }
  // The outline, where depth jumps, and then sharp creases; directions are along the edge.
  SampleArrays contour(const Viewpoint& v) const {
    return arrays(v.contour_first, v.contour_count);
  }
  // Of the leaf viewpoints, in their order: where each looks, in object axes. Positions only.
  SampleArrays viewing_directions() const { return viewing_directions_; }

  // Of the part's shape, in the coordinates of its samples.
  const PartSymmetry& symmetry() const { return symmetry_; }

  // Rotation of (viewpoint, roll) at depth d: object axes to camera axes, on the optical axis.
  Mat3 rotation(int d, int viewpoint, int roll) const;
  double roll_rad(int d, int roll) const;
  // From the camera to the object's origin, at the middle of what a node stands for, and how much
  // that is.
  double distance_mm(int d, int distance_index) const {
    return distances_[d][distance_index].middle_mm;
  }
  double distance_interval_mm(int d, int distance_index) const {
    return distances_[d][distance_index].interval_mm;
  }
  std::size_t bytes_total() const { return bytes_total_; }

 private:
  ObjectModel() = default;
  Error read_depth(std::span<const std::uint8_t> bytes, const ModelHeader& header, int d);
  Error read_symmetry(std::span<const std::uint8_t> bytes, const ModelHeader& header);
  Error check_viewpoints(int d) const;
  SampleArrays arrays(std::uint64_t first, std::uint64_t count) const;
  void place_distances();

  struct DistanceNode {
    double middle_mm = 0, interval_mm = 0;
  };

  const ModelInfo* info_ = nullptr;
  const ModelTrials* trials_ = nullptr;
  TreeDepth depths_[kModelDepthsMax];
  DistanceNode distances_[kModelDepthsMax][kModelDistancesMax];
  std::span<const Feature> features_;
  std::span<const float> samples_;
  SampleArrays viewing_directions_;
  PartSymmetry symmetry_;
  std::size_t bytes_total_ = 0;
};

}  // namespace binpick
