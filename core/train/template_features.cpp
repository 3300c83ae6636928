#include "train/template_features.hpp"

#include <algorithm>
#include <cmath>

namespace binpick::train {
namespace {

std::uint8_t quantized_weight(float frequency) {
  return static_cast<std::uint8_t>(std::clamp(
      static_cast<int>(std::lround(frequency * kFeatureWeightMax)), 1, kFeatureWeightMax));
}

// Takes candidates in order while they keep a distance from those taken before; the distance
// shrinks until the budget is full or everything was taken.
void take_spread(const std::vector<const FeatureCandidate*>& ordered, int budget,
                 std::vector<const FeatureCandidate*>& taken) {
  const std::size_t wanted = std::min<std::size_t>(budget, ordered.size());
  std::vector<char> used(ordered.size(), 0);
  const std::size_t before = taken.size();
  // First guess: what would fill the budget if the candidates, every second pixel, covered an area
  // evenly.
  const double area_px = 4.0 * static_cast<double>(ordered.size());
  const int first_guess =
      wanted > 0 ? static_cast<int>(1.2 * std::sqrt(area_px / static_cast<double>(wanted))) : 0;
  for (int distance = first_guess; taken.size() - before < wanted; distance = distance * 3 / 4) {
    for (std::size_t i = 0; i < ordered.size() && taken.size() - before < wanted; ++i) {
      if (used[i]) continue;
      const FeatureCandidate& c = *ordered[i];
      bool clear = true;
      for (std::size_t k = before; k < taken.size() && clear; ++k) {
        const int dx = c.x - taken[k]->x, dy = c.y - taken[k]->y;
        clear = dx * dx + dy * dy >= distance * distance;
      }
      if (!clear) continue;
      used[i] = 1;
      taken.push_back(&c);
    }
  }
}

}  // namespace

std::vector<Feature> select_features(const std::vector<FeatureCandidate>& candidates,
                                     const FeatureBudget& budget) {
  std::vector<const FeatureCandidate*> contour, surface, taken;
  for (const FeatureCandidate& c : candidates) {
    if (c.gradient.bits != 0) {
      contour.push_back(&c);
    } else if (c.normal.bits != 0) {
      surface.push_back(&c);
    }
  }
  auto by = [](auto frequency) {
    return [frequency](const FeatureCandidate* a, const FeatureCandidate* b) {
      const float fa = frequency(*a), fb = frequency(*b);
      if (fa != fb) return fa > fb;
      return a->y != b->y ? a->y < b->y : a->x < b->x;
    };
  };
  std::sort(contour.begin(), contour.end(),
            by([](const FeatureCandidate& c) { return c.gradient.frequency; }));
  std::sort(surface.begin(), surface.end(),
            by([](const FeatureCandidate& c) { return c.normal.frequency; }));
  take_spread(contour, budget.contour, taken);
  take_spread(surface, budget.surface, taken);

  std::vector<Feature> features;
  features.reserve(taken.size());
  for (const FeatureCandidate* c : taken) {
    Feature f{};
    f.x = static_cast<std::int8_t>(c->x);
    f.y = static_cast<std::int8_t>(c->y);
    f.gradient_bits = c->gradient.bits;
    f.gradient_weight =
        c->gradient.bits ? quantized_weight(c->gradient.frequency) : std::uint8_t{0};
    f.normal_bits = c->normal.bits;
    f.normal_weight = c->normal.bits ? quantized_weight(c->normal.frequency) : std::uint8_t{0};
    features.push_back(f);
  }
  return features;
}

}  // namespace binpick::train
