// What an opened sensor lacks of the features that its profile names and the usual commands use.
#pragma once

#include <string>
#include <vector>

#include "aravis/features.hpp"

namespace binpick::drivers {

std::vector<std::string> missing_features(const Features& features, const CameraSpec& spec);

}  // namespace binpick::drivers
