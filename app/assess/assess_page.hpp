// An assessment as one HTML page that carries everything it shows.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "assess/assessment.hpp"

namespace binpick::app {

struct AssessPage {
  std::string title;
  std::vector<std::pair<std::string, std::string>> facts;  // of the run: name, value
  std::vector<std::uint8_t> picture_png;
};

std::string assessment_html(const Assessment& assessment, const AssessPage& page);

// The reference frame with the parts at their mean poses, numbered.
Picture numbered_picture(Picture picture, const CameraIntrinsics& camera,
                         const Assessment& assessment, std::span<const ObjectModel> models);

}  // namespace binpick::app
