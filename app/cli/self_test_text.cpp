#include "cli/self_test_text.hpp"

#include <algorithm>
#include <cstdio>

namespace binpick::app {
namespace {

constexpr std::size_t kConfusionsMax = 5;

void print_reliability(const Reliability& r) {
  const RightShare& accepted = r.accepted;
  if (accepted.count == 0) {
    std::printf("  no pose has a probability of %.2f or more\n", r.threshold);
  } else {
    std::printf(
        "  probabilities %.2f and more: %.1f %% of %d poses right (95 %% interval %.1f .. %.1f "
        "%%)\n",
        r.threshold, 100 * accepted.share(), accepted.count, 100 * accepted.low(),
        100 * accepted.high());
  }
  std::printf("  probability against share that is right: off by %.3f on average, %d poses\n",
              r.calibration_error, r.count);
}

}  // namespace

void print_self_test(const SelfTest& test, const std::vector<std::string>& advice) {
  const SelfTestRecord& r = test.record;
  std::printf("\nself-test on %d simulated piles, score >= %.2f:\n", r.piles, test.threshold);
  std::printf("  recall %.3f, precision %.3f, F1 %.3f of %d mostly visible parts\n", r.recall,
              r.precision, test.f1, r.instances);
  print_reliability(test.reliability);
  std::printf("  errors %.2f mm and %.2f deg a direction, on average\n", test.position_error_mm,
              test.angle_error_deg);
  std::printf("  found by visible share:");
  for (const VisibilityBand& band : test.bands) {
    if (band.instances == 0) continue;
    std::printf("  %.1f..%.1f %d/%d", band.from, band.to, band.found, band.instances);
  }
  if (r.visible_fraction_min < 1) {
    std::printf("\n  half of the parts are found that show %.0f %% or more\n",
                100 * r.visible_fraction_min);
  } else {
    std::printf("\n  at no visible share half of the parts are found\n");
  }
  std::printf("  wrong poses: %d\n", test.wrong);
  for (std::size_t i = 0; i < std::min(test.confusions.size(), kConfusionsMax); ++i) {
    const Confusion& c = test.confusions[i];
    std::printf("    %d turned by about %.0f deg about (%.2f %.2f %.2f)\n", c.count, c.angle_deg,
                c.axis.x(), c.axis.y(), c.axis.z());
  }
  for (const std::string& sentence : advice) std::printf("  advice: %s\n", sentence.c_str());
}

}  // namespace binpick::app
