// What the depth images say beside the poses: how much of a part they lack, and how far a pixel
// scatters from frame to frame.
#pragma once

#include <vector>

#include "binpick/frame/frame.hpp"
#include "binpick/model/object_model.hpp"

namespace binpick::app {

// The share of the part's visible surface, without what something in front hides, that has no
// depth. 0 where the frame has no depth image.
double missing_share(const ObjectModel& model, const Frame& frame, const Pose& T_cam_centre);

// Of a scene that stands still.
class DepthScatter {
 public:
  void add(const Frame& frame);
  // Median over the pixels of the standard deviation; 0 where too few pixels have depth in most
  // frames.
  double median_mm() const;

 private:
  struct Pixel {
    int count = 0;
    float mean = 0, squares = 0;  // squares: of the differences from the mean, summed
  };
  int frames_ = 0;
  std::vector<Pixel> pixels_;
};

}  // namespace binpick::app
