#include "train/sample_votes.hpp"

#include <cmath>
#include <numbers>

namespace binpick::train {
namespace {

static_assert(kContourVote == kSurfaceVote, "the tables have one size");
constexpr int kUnits = kSurfaceVote;
constexpr int kShares = kUnits + 1;  // of a vote that a bin can get: none to all
// Turns are at least minus one full turn.
constexpr int kTurnsBelow = 2;

int units_of(float share) {
  return static_cast<int>(share * static_cast<float>(kUnits) + 0.5f);
}

int facing_bins(NormalCodebook codebook) {
  return codebook == NormalCodebook::kHemisphere ? 1 : 0;
}

}  // namespace

VoteTables::VoteTables(NormalCodebook codebook) {
  for (int bin = 0; bin < kOrientationBins; ++bin) {
    for (int upper = 0; upper < kShares; ++upper) {
      CellVote& vote = contour_.emplace_back();
      vote[static_cast<std::size_t>(bin)] = static_cast<std::uint16_t>(kUnits - upper);
      vote[static_cast<std::size_t>((bin + 1) % kOrientationBins)] =
          static_cast<std::uint16_t>(upper);
    }
  }
  const int first = facing_bins(codebook);
  const int ring = kOrientationBins - first;
  for (int facing = 0; facing < kShares; ++facing) {
    for (int bin = 0; bin < ring; ++bin) {
      for (int split = 0; split < kShares * kShares; ++split) {
        CellVote& vote = surface_.emplace_back();
        vote[0] = static_cast<std::uint16_t>(facing);
        const auto add = [&](int to, int units) {
          auto& sum = vote[static_cast<std::size_t>(first + to % ring)];
          sum = static_cast<std::uint16_t>(sum + units);
        };
        add(bin, split / kShares);
        add(bin + 1, split % kShares);
      }
    }
  }
}

SampleVotes::SampleVotes(const RenderedSample& sample, NormalCodebook codebook)
    : ring_bins_(kOrientationBins - facing_bins(codebook)) {
  for (std::size_t i = 0; i < sample.contour.size(); ++i) {
    const ContourPoint& p = sample.contour[i];
    ContourList& list = contour_[i % kContourStride];
    list.x.push_back(p.x);
    list.y.push_back(p.y);
    list.angle_rad.push_back(p.angle_rad);
  }
  for (std::size_t i = 0; i < sample.surface.size(); ++i) {
    const SurfacePoint& p = sample.surface[i];
    SurfaceList& list = surface_[i % kSurfaceStride];
    list.x.push_back(p.x);
    list.y.push_back(p.y);
    list.azimuth_rad.push_back(p.azimuth_rad);
    // At azimuth 0 the ring's whole share is in its first bin.
    const SoftBins soft = soft_normal_bins(codebook, p.tilt_sin, 0);
    std::array<float, kOrientationBins> share{};
    for (int k = 0; k < soft.count; ++k) share[soft.bin[k]] += soft.weight[k];
    const int first = facing_bins(codebook);
    list.ring.push_back(share[static_cast<std::size_t>(first)]);
  }
}

void SampleVotes::turn_contour(int start, float turn_rad, float centre, TurnedPoints& out) const {
  const ContourList& list = contour_[static_cast<std::size_t>(start % kContourStride)];
  const std::size_t count = list.x.size();
  out.x.resize(count), out.y.resize(count), out.vote.resize(count);
  const float c = std::cos(turn_rad), s = std::sin(turn_rad);
  for (std::size_t i = 0; i < count; ++i) {
    const float x = list.x[i], y = list.y[i];
    out.x[i] = static_cast<int>(c * x - s * y + centre);
    out.y[i] = static_cast<int>(s * x + c * y + centre);
  }
  for (std::size_t i = 0; i < count; ++i) {
    const float position = (list.angle_rad[i] + turn_rad) * kBinsPerRad + 64;
    const int bin = static_cast<int>(position);
    const int upper = units_of(position - static_cast<float>(bin));
    out.vote[i] = (bin & 7) * kShares + upper;
  }
}

// The bins are those of soft_normal_bins, of which kRing are for azimuths.
template <int kRing>
void SampleVotes::choose_votes(const SurfaceList& list, float turn_rad, std::vector<int>& votes) {
  const float* azimuth_rad = list.azimuth_rad.data();
  const float* ring = list.ring.data();
  int* out = votes.data();
  const std::size_t count = votes.size();
  for (std::size_t i = 0; i < count; ++i) {
    const float position = (azimuth_rad[i] + turn_rad) / (2 * std::numbers::pi_v<float>)*kRing;
    // Rounded down without a call.
    const int towards_zero = static_cast<int>(position);
    const int whole = towards_zero - (static_cast<float>(towards_zero) > position ? 1 : 0);
    const float fraction = position - static_cast<float>(whole);
    const unsigned bin = static_cast<unsigned>(whole + kTurnsBelow * kRing) % kRing;
    const int lower = units_of((1 - fraction) * ring[i]);
    const int upper = units_of(fraction * ring[i]);
    const int facing = kRing < kOrientationBins ? units_of(1 - ring[i]) : 0;
    out[i] = ((facing * kRing + static_cast<int>(bin)) * kShares + lower) * kShares + upper;
  }
}

void SampleVotes::turn_surface(int start, float turn_rad, float centre, TurnedPoints& out) const {
  const SurfaceList& list = surface_[static_cast<std::size_t>(start)];
  const std::size_t count = list.x.size();
  out.x.resize(count), out.y.resize(count), out.vote.resize(count);
  const float c = std::cos(turn_rad), s = std::sin(turn_rad);
  for (std::size_t i = 0; i < count; ++i) {
    const float x = list.x[i], y = list.y[i];
    out.x[i] = static_cast<int>((c * x - s * y) * 0.5f + centre);
    out.y[i] = static_cast<int>((s * x + c * y) * 0.5f + centre);
  }
  if (ring_bins_ == kOrientationBins) {
    choose_votes<kOrientationBins>(list, turn_rad, out.vote);
  } else {
    choose_votes<kOrientationBins - 1>(list, turn_rad, out.vote);
  }
}

}  // namespace binpick::train
