// Option values that are more than one number or word. Each throws CLI::ValidationError, naming the
// option and what it expects.
#pragma once

#include <string>
#include <utility>

#include "binpick/drivers/bop_dataset.hpp"
#include "binpick/frame/modality.hpp"
#include "binpick/model/part_symmetry.hpp"
#include "binpick/simd/isa.hpp"
#include "binpick/train/mesh.hpp"

namespace binpick::app {

// "MIN:MAX", both finite and positive, MIN < MAX.
std::pair<double, double> parse_range(const std::string& option, const std::string& text);

// "x,y,width,height" in pixels, width and height positive.
Roi parse_roi(const std::string& option, const std::string& text);

// "SCENE/IMAGE", with or without leading zeros.
drivers::FrameId parse_frame_id(const std::string& option, const std::string& text);

// A name that this machine can run.
Isa parse_isa(const std::string& option, const std::string& text);

// One of kModalityNames.
Modality parse_modality(const std::string& option, const std::string& text);
NearSymmetry parse_near_symmetry(const std::string& option, const std::string& text);
// "automatic, depth_and_intensity, depth or intensity".
std::string modality_list();
std::string near_symmetry_list();

// "mm", "m", "inch"; "" lets the import guess.
train::LengthUnit parse_unit(const std::string& option, const std::string& text);

// "1280x1024", for messages.
std::string size_text(int width, int height);

}  // namespace binpick::app
