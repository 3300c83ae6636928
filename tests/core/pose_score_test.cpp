// The score: from evidence to a probability.
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

#include "pose/score.hpp"

namespace binpick {
namespace {

// A part of which everything fits.
Evidence good_evidence() {
  Evidence e;
  e.samples = 200;
  e.measured = 190;
  e.supported = 186;
  e.hidden = 6;
  e.contours = 100;
  e.contours_supported = 97;
  e.outline_steps = 80;
  e.outline_matches = 15;
  e.outline_offset_px = 7;
  e.creases = 40;
  e.creases_supported = 30;
  e.explained_mm2 = 700;
  e.px2_per_mm2 = 7;
  return e;
}

double score_of(const Evidence& e) {
  return probability(score_terms(e, 1.6), Modality::kDepthAndIntensity, ModelTrials{});
}

TEST(PoseScore, IsAProbability) {
  EXPECT_GT(score_of(good_evidence()), 0.9);
  EXPECT_LT(score_of(good_evidence()), 1);
}

TEST(PoseScore, NoEvidenceIsNoNumberTrouble) {
  const double nothing = score_of(Evidence{});
  EXPECT_TRUE(std::isfinite(nothing));
  EXPECT_LT(nothing, 0.01);
}

// Each kind of evidence against a pose lowers its score.
TEST(PoseScore, EveryContradictionCounts) {
  const double best = score_of(good_evidence());
  const auto worse = [&](auto&& change) {
    Evidence e = good_evidence();
    change(e);
    return score_of(e);
  };
  EXPECT_LT(worse([](Evidence& e) { e.supported = 120; }), best) << "surface beside the measured";
  EXPECT_LT(worse([](Evidence& e) { e.contours_supported = 60; }), best) << "outline on no edge";
  EXPECT_LT(worse([](Evidence& e) { e.contradicted = 20; }), best) << "free space violated";
  EXPECT_LT(worse([](Evidence& e) { e.creases_supported = 4; }), best) << "creases on no edge";
  EXPECT_LT(worse([](Evidence& e) { e.explained_mm2 = 60; }), best) << "hardly anything is seen";
  EXPECT_LT(worse([](Evidence& e) { e.hidden = 150; }), best) << "most of it is hidden";
}

// A part with as much depth as a dull one has, and a shiny one with 0.6 of that, which fits as
// well.
TEST(PoseScore, MissingDepthSpeaksNeitherWay) {
  Evidence dull = good_evidence();
  dull.seen = Modality::kDepthAndIntensity;
  dull.samples = 200;
  dull.hidden = 0;
  dull.measured = 150;
  dull.supported = 147;
  Evidence shiny = dull;
  shiny.measured = 90;
  shiny.supported = 88.2;
  shiny.explained_mm2 *= 0.6;
  EXPECT_NEAR(score_of(shiny), score_of(dull), 1e-3);
  shiny.seen = dull.seen = Modality::kDepth;
  EXPECT_LT(log_odds(score_terms(shiny, 1.6), Modality::kDepth),
            log_odds(score_terms(dull, 1.6), Modality::kDepth) - 1)
      << "nothing stands in for depth";
}

// The same part seen by a camera with twice the focal length from twice as far is the same image.
TEST(PoseScore, DependsOnTheImageNotOnMillimetres) {
  Evidence scaled = good_evidence();
  scaled.explained_mm2 *= 9;  // a part three times as large, three times as far away
  scaled.px2_per_mm2 /= 9;
  EXPECT_NEAR(score_of(scaled), score_of(good_evidence()), 1e-12);
}

// What a frame without intensity cannot show is not held against a pose.
TEST(PoseScore, DepthAloneIsEnough) {
  const auto score_of = [](const Evidence& e) {
    return probability(score_terms(e, 1.6), Modality::kDepth, ModelTrials{});
  };
  Evidence e = good_evidence();
  e.creases = 0;
  e.creases_supported = 0;
  e.outline_matches = 0;
  e.outline_offset_px = 0;
  e.contours_supported = e.outline_steps;
  EXPECT_GT(score_of(e), 0.8);
  e.outline_steps = 30;  // the outline lies where nothing ends
  e.contours_supported = 30;
  EXPECT_LT(score_of(e), 0.8);
}

// Of a part of which only the intensity is seen.
Evidence good_contours() {
  Evidence e;
  e.seen = Modality::kIntensity;
  e.samples = 200;
  e.contours = 100;
  e.contours_supported = 92;
  e.outline_matches = 97;
  e.outline_offset_px = 30;
  e.creases = 40;
  e.creases_supported = 34;
  e.explained_mm2 = 900;
  e.px2_per_mm2 = 7;
  return e;
}

TEST(PoseScore, IntensityAloneIsEnough) {
  const auto score_of = [](const Evidence& e) {
    return probability(score_terms(e, 0.85), Modality::kIntensity, ModelTrials{});
  };
  const double best = score_of(good_contours());
  EXPECT_GT(best, 0.5) << "more likely right than not";
  const auto worse = [&](auto&& change) {
    Evidence e = good_contours();
    change(e);
    return score_of(e);
  };
  EXPECT_LT(worse([](Evidence& e) { e.outline_bare = 40; }), 0.5 * best) << "no edge there";
  EXPECT_LT(worse([](Evidence& e) { e.creases_supported = 4; }), best) << "creases on no edge";
  EXPECT_EQ(worse([](Evidence& e) { e.hidden = 100; }), best) << "cannot be known";
  EXPECT_EQ(worse([](Evidence& e) { e.contradicted = 100; }), best) << "cannot be known";
}

TEST(PoseScore, TermsHaveNames) {
  std::set<std::string> names;
  for (int i = 0; i < kScoreTermCount; ++i)
    names.insert(score_term_name(static_cast<ScoreTerm>(i)));
  EXPECT_EQ(names.size(), static_cast<std::size_t>(kScoreTermCount));
  EXPECT_EQ(names.count("unknown"), 0u);
}

}  // namespace
}  // namespace binpick
