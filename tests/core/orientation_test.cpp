#include "features/orientation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <map>

#include "binpick/geometry/angle.hpp"

namespace binpick {
namespace {

constexpr NormalCodebook kCodebooks[] = {NormalCodebook::kAzimuth, NormalCodebook::kHemisphere};

int bin_of(std::uint8_t bit) {
  EXPECT_EQ(1, std::popcount(bit));
  return std::countr_zero(bit);
}

float radians(double degrees) {
  return static_cast<float>(degrees * kDegree);
}

std::uint8_t gradient_bit_at(double degrees) {
  const double a = degrees * kDegree;
  return gradient_bit(static_cast<std::int32_t>(std::lround(60000 * std::cos(a))),
                      static_cast<std::int32_t>(std::lround(60000 * std::sin(a))));
}

// Weight by bin; a bin that is named twice counts twice.
std::map<int, float> weights(const SoftBins& bins) {
  std::map<int, float> out;
  for (int i = 0; i < bins.count; ++i) out[bins.bin[i]] += bins.weight[i];
  return out;
}

float total(const SoftBins& bins) {
  float sum = 0;
  for (int i = 0; i < bins.count; ++i) sum += bins.weight[i];
  return sum;
}

int strongest(const SoftBins& bins) {
  return bins.bin[std::max_element(bins.weight, bins.weight + bins.count) - bins.weight];
}

TEST(GradientBit, KnowsTheEightDirections) {
  EXPECT_EQ(1u << 0, gradient_bit(5, 0));
  EXPECT_EQ(1u << 1, gradient_bit(12, 5));  // 22.6 degrees
  EXPECT_EQ(1u << 2, gradient_bit(7, 7));
  EXPECT_EQ(1u << 3, gradient_bit(5, 12));  // 67.4
  EXPECT_EQ(1u << 4, gradient_bit(0, 9));
  EXPECT_EQ(1u << 5, gradient_bit(-5, 12));  // 112.6
  EXPECT_EQ(1u << 6, gradient_bit(-7, 7));
  EXPECT_EQ(1u << 7, gradient_bit(-12, 5));  // 157.4
  EXPECT_EQ(0, gradient_bit(0, 0));
}

TEST(GradientBit, ChangesAtTheSectorBoundaries) {
  for (int k = 0; k < 8; ++k) {
    const double boundary_deg = 11.25 + 22.5 * k;
    EXPECT_EQ(1u << k, gradient_bit_at(boundary_deg - 0.02)) << boundary_deg;
    EXPECT_EQ(1u << ((k + 1) % 8), gradient_bit_at(boundary_deg + 0.02)) << boundary_deg;
  }
  // tan 11.25 = 0.19891: 198 / 1000 lies below it, 199 / 1000 above.
  EXPECT_EQ(1u << 0, gradient_bit(1000, 198));
  EXPECT_EQ(1u << 1, gradient_bit(1000, 199));
  // tan 78.75 = 5.02734
  EXPECT_EQ(1u << 3, gradient_bit(1000, 5027));
  EXPECT_EQ(1u << 4, gradient_bit(1000, 5028));
}

TEST(GradientBit, IsTheSameForOppositeDirections) {
  for (int gx = -40; gx <= 40; ++gx) {
    for (int gy = -40; gy <= 40; ++gy) {
      EXPECT_EQ(gradient_bit(gx, gy), gradient_bit(-gx, -gy)) << gx << ' ' << gy;
    }
  }
}

TEST(GradientBit, HoldsAtTheLargestComponents) {
  constexpr std::int32_t kLargest = (1 << 16) - 1;
  EXPECT_EQ(1u << 2, gradient_bit(kLargest, kLargest));
  EXPECT_EQ(1u << 6, gradient_bit(-kLargest, kLargest));
  EXPECT_EQ(1u << 0, gradient_bit(-kLargest, 1));
  EXPECT_EQ(1u << 4, gradient_bit(1, -kLargest));
}

TEST(SoftGradientBins, InterpolateLinearlyBetweenNeighbours) {
  for (int k = 0; k < 8; ++k) {
    for (const double share : {0.0, 0.25, 0.5, 0.9}) {
      const auto w = weights(soft_gradient_bins(radians((k + share) * 22.5)));
      const auto at = [&](int bin) { return w.count(bin) ? w.at(bin) : 0.0f; };
      EXPECT_NEAR(1 - share, at(k), 1e-4) << k << ' ' << share;
      EXPECT_NEAR(share, at((k + 1) % 8), 1e-4) << k << ' ' << share;
    }
  }
}

TEST(SoftGradientBins, SumToOneAndRepeatAfterHalfATurn) {
  for (double degrees = -360; degrees <= 360; degrees += 3.7) {
    const SoftBins bins = soft_gradient_bins(radians(degrees));
    EXPECT_NEAR(1, total(bins), 1e-6);
    const auto here = weights(bins), opposite = weights(soft_gradient_bins(radians(degrees + 180)));
    for (const auto& [bin, weight] : here) {
      EXPECT_NEAR(weight, opposite.count(bin) ? opposite.at(bin) : 0.0f, 1e-4) << degrees;
    }
  }
}

TEST(SoftGradientBins, AgreeWithTheBitAwayFromBoundaries) {
  for (double degrees = -180; degrees < 180; degrees += 0.7) {
    const double from_centre = std::remainder(degrees, 22.5);
    if (std::abs(std::abs(from_centre) - 11.25) < 0.1) continue;
    EXPECT_EQ(strongest(soft_gradient_bins(radians(degrees))), bin_of(gradient_bit_at(degrees)))
        << degrees;
  }
}

TEST(NormalBit, AzimuthCodebookHasEightSectorsAndNoneFacing) {
  EXPECT_EQ(1u << 0, normal_bit(NormalCodebook::kAzimuth, 0.5f, 0));
  EXPECT_EQ(1u << 2, normal_bit(NormalCodebook::kAzimuth, 0, 0.5f));
  EXPECT_EQ(1u << 4, normal_bit(NormalCodebook::kAzimuth, -0.5f, 0));
  EXPECT_EQ(1u << 6, normal_bit(NormalCodebook::kAzimuth, 0, -0.5f));
  EXPECT_EQ(1u << 7, normal_bit(NormalCodebook::kAzimuth, 0.4f, -0.4f));
  EXPECT_EQ(0, normal_bit(NormalCodebook::kAzimuth, 0.01f, -0.02f));
  EXPECT_EQ(0, soft_normal_bins(NormalCodebook::kAzimuth, 0.02f, 1.0f).count);
}

TEST(NormalBit, HemisphereCodebookHasOneFacingCellAndSevenAround) {
  EXPECT_EQ(1u << 0, normal_bit(NormalCodebook::kHemisphere, 0, 0));
  EXPECT_EQ(1u << 0, normal_bit(NormalCodebook::kHemisphere, 0.2f, -0.2f));
  for (int k = 0; k < 7; ++k) {
    const float azimuth = radians(k * 360.0 / 7);
    EXPECT_EQ(1u << (1 + k), normal_bit(NormalCodebook::kHemisphere, 0.6f * std::cos(azimuth),
                                        0.6f * std::sin(azimuth)));
  }
}

TEST(SoftNormalBins, SumToOneInBothCodebooks) {
  for (const NormalCodebook codebook : kCodebooks) {
    for (double tilt_sin = 0.06; tilt_sin <= 1; tilt_sin += 0.03) {
      for (double degrees = -180; degrees <= 360; degrees += 7.3) {
        const SoftBins bins =
            soft_normal_bins(codebook, static_cast<float>(tilt_sin), radians(degrees));
        EXPECT_NEAR(1, total(bins), 1e-5) << tilt_sin << ' ' << degrees;
        for (int i = 0; i < bins.count; ++i) {
          EXPECT_LT(bins.bin[i], kOrientationBins);
          EXPECT_GE(bins.weight[i], 0);
        }
      }
    }
  }
}

TEST(SoftNormalBins, PassLinearlyFromTheFacingCellToTheRing) {
  const auto facing = [](float tilt_sin) {
    const auto w = weights(soft_normal_bins(NormalCodebook::kHemisphere, tilt_sin, 0));
    return w.count(0) ? w.at(0) : 0.0f;
  };
  EXPECT_EQ(1, facing(0));
  EXPECT_NEAR(0.5, facing(0.354f), 1e-4);
  EXPECT_NEAR(0.75, facing(0.304f), 1e-4);
  EXPECT_NEAR(0.25, facing(0.404f), 1e-4);
  EXPECT_EQ(0, facing(0.5f));
}

TEST(SoftNormalBins, AgreeWithTheBitAwayFromBoundaries) {
  for (const NormalCodebook codebook : kCodebooks) {
    const int sectors = codebook == NormalCodebook::kAzimuth ? 8 : 7;
    for (const float tilt_sin : {0.1f, 0.2f, 0.6f, 0.9f}) {
      for (double degrees = -179; degrees < 180; degrees += 1.3) {
        const double sector = degrees / (360.0 / sectors);
        if (std::abs(std::abs(sector - std::round(sector)) - 0.5) < 0.01) continue;
        const float a = radians(degrees);
        EXPECT_EQ(strongest(soft_normal_bins(codebook, tilt_sin, a)),
                  bin_of(normal_bit(codebook, tilt_sin * std::cos(a), tilt_sin * std::sin(a))))
            << tilt_sin << ' ' << degrees;
      }
    }
  }
}

}  // namespace
}  // namespace binpick
