// Puts a trained part into the bytes of a model file (core/model/model_format.hpp).
#pragma once

#include <cstdint>
#include <vector>

#include "train/symmetry.hpp"
#include "train/template_builder.hpp"
#include "train/view_samples.hpp"

namespace binpick::train {

std::vector<std::uint8_t> write_model(const ModelInfo& info, const PoseTree& tree,
                                      const TemplateSet& templates,
                                      const std::vector<ViewSamples>& views,
                                      const FoundSymmetry& symmetry);

}  // namespace binpick::train
