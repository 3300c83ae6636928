// Searches frames one after the other and keeps of each what an assessment needs.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "assess/depth_look.hpp"
#include "assess/observation.hpp"
#include "binpick/detect/detector.hpp"
#include "overlay/picture.hpp"
#include "sized_detector.hpp"

namespace binpick::app {

struct AssessedFrame {
  std::string name;
  double time_s = 0;  // of the detection
  PixelRange region;  // that was searched
};

struct Collection {
  CameraIntrinsics camera;
  Modality seen = Modality::kDepthAndIntensity;  // the images that were looked at
  std::vector<AssessedFrame> frames;
  std::vector<Observation> observations;  // by frame
  double noise_mm = 0;                    // of the depth from frame to frame; 0: not known
  // The frame whose scores sum up to most, where most is to be seen.
  int reference = 0;
  Picture picture;  // of the reference
};

class FrameCollector {
 public:
  // What they refer to outlives it. `roi` replaces the frames' own, unless it is the whole image.
  FrameCollector(std::span<const ObjectModel> models, const DetectRequest& request, const Roi& roi,
                 WorkerPool& pool);

  // Throws SetupError naming the frame where it cannot be searched, or is of another camera.
  void add(Frame frame, const std::string& name);
  Collection take();

 private:
  Detector& detector_for(const Frame& frame);
  void check_camera(const CameraIntrinsics& camera, const std::string& name);

  std::span<const ObjectModel> models_;
  DetectRequest request_;
  Roi roi_;
  WorkerPool& pool_;
  std::unique_ptr<SizedDetector> detector_;
  int width_ = 0, height_ = 0;  // that the detector is made for
  Collection out_;
  DepthScatter scatter_;
  double best_sum_ = -1;
};

}  // namespace binpick::app
