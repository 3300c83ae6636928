// From sums of weights to the score of a template.
#pragma once

#include <cstdint>

namespace binpick {

// Template scores are fixed-point: each modality gives 0 .. kScoreOne.
inline constexpr int kScoreOne = 8192;

// score = gradient_sum / gradient_weight_sum + normal_sum / normal_weight_sum (paper eq. 2, both
// modalities added) in fixed-point; a modality without features gives 0.
struct ScoreScale {
  std::uint32_t gradient = 0, normal = 0;

  ScoreScale() = default;
  ScoreScale(int gradient_weight_sum, int normal_weight_sum) {
    if (gradient_weight_sum > 0)
      gradient = (static_cast<std::uint32_t>(kScoreOne) << 16) /
                 static_cast<std::uint32_t>(gradient_weight_sum);
    if (normal_weight_sum > 0)
      normal = (static_cast<std::uint32_t>(kScoreOne) << 16) /
               static_cast<std::uint32_t>(normal_weight_sum);
  }
  std::uint16_t score(std::uint32_t gradient_sum, std::uint32_t normal_sum) const {
    return static_cast<std::uint16_t>((gradient_sum * gradient + normal_sum * normal) >> 16);
  }
};

}  // namespace binpick
