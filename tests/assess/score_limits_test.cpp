// The cause that is named for a low score.
#include "assess/score_limits.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace binpick::app {
namespace {

using ::testing::HasSubstr;

void set(ScoreTerms& terms, ScoreTerm which, double value) {
  terms[static_cast<std::size_t>(which)] = value;
}

// A part that nothing is amiss with.
ScoreTerms good() {
  ScoreTerms terms{};
  set(terms, ScoreTerm::kSupportedArea, std::log(9000.0));
  set(terms, ScoreTerm::kOutlineSteps, 0.95);
  set(terms, ScoreTerm::kCreases, 0.9);
  set(terms, ScoreTerm::kTemplate, 1.7);
  return terms;
}

LimitContext context() {
  LimitContext c;
  const ScoreTerms terms = good();
  c.best = best_terms({&terms, 1});
  c.noise_mm = 0.1;
  c.threshold = 0.85;
  return c;
}

LimitFinding first_of(const PartEvidence& part, const LimitContext& c = context()) {
  const std::vector<LimitFinding> found = find_limits({&part, 1}, c);
  return found.empty() ? LimitFinding{ScoreLimit::kCalibration, {}, 0, "nothing"} : found.front();
}

TEST(ScoreLimits, NothingIsNamedWhereNothingIsAmiss) {
  const PartEvidence part{1, true, good(), 0.02, 0.06};
  EXPECT_TRUE(find_limits({&part, 1}, context()).empty());
}

TEST(ScoreLimits, NameTheCostliestTermByWhatIsBehindIt) {
  PartEvidence part{3, true, good(), 0.05, 0.06};
  set(part.terms, ScoreTerm::kHidden, 0.6);
  set(part.terms, ScoreTerm::kSupportedArea, std::log(3500.0));
  LimitFinding found = first_of(part);
  EXPECT_EQ(found.limit, ScoreLimit::kHidden);
  EXPECT_EQ(found.parts, std::vector<int>{3});
  EXPECT_THAT(found.text, HasSubstr("60 %"));

  set(part.terms, ScoreTerm::kHidden, 0.1);
  part.missing_share = 0.7;
  found = first_of(part);
  EXPECT_EQ(found.limit, ScoreLimit::kMissingDepth);
  EXPECT_THAT(found.text, HasSubstr("70 %"));

  part.missing_share = 0.05;
  set(part.terms, ScoreTerm::kHidden, 0);
  found = first_of(part);
  EXPECT_EQ(found.limit, ScoreLimit::kSmall);
  EXPECT_THAT(found.text, HasSubstr("3500 pixels"));

  part.terms = good();
  set(part.terms, ScoreTerm::kContourSupport, std::log(0.3));
  EXPECT_EQ(first_of(part).limit, ScoreLimit::kOutline);

  part.terms = good();
  set(part.terms, ScoreTerm::kConflicts, 3);
  found = first_of(part);
  EXPECT_EQ(found.limit, ScoreLimit::kConflicts);
  EXPECT_GT(found.cost, 1);
}

TEST(ScoreLimits, TellsWhatLiesOffTheCadFromNoise) {
  PartEvidence part{1, true, good(), 0.05, 0.6};
  set(part.terms, ScoreTerm::kDepthSupport, std::log(0.3));
  LimitContext c = context();
  EXPECT_EQ(first_of(part, c).limit, ScoreLimit::kOffSurface);
  EXPECT_THAT(first_of(part, c).text, HasSubstr("use the CAD of the part as it is made"));
  c.noise_mm = 0.8;
  EXPECT_THAT(first_of(part, c).text, HasSubstr("depth noise"));
}

TEST(ScoreLimits, NameTheCalibrationWhereNoEvidenceWouldDo) {
  PartEvidence part{1, true, good(), 0.02, 0.06};
  LimitContext c = context();
  c.trials.with_intensity = {0.23, -3.3};
  const std::vector<LimitFinding> found = find_limits({&part, 1}, c);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found.front().limit, ScoreLimit::kCalibration);
}

TEST(ScoreLimits, NameTheSearchWhereNoScoreIsLow) {
  const PartEvidence part{4, false, {}, 0, 0};
  const LimitFinding found = first_of(part);
  EXPECT_EQ(found.limit, ScoreLimit::kSearch);
  EXPECT_EQ(found.parts, std::vector<int>{4});
}

TEST(ScoreLimits, WhatMostPartsSufferFromComesFirst) {
  std::vector<PartEvidence> parts(3, PartEvidence{1, true, good(), 0.05, 0.06});
  set(parts[0].terms, ScoreTerm::kContourSupport, std::log(0.1));
  for (int i : {1, 2}) {
    parts[static_cast<std::size_t>(i)].number = i + 1;
    set(parts[static_cast<std::size_t>(i)].terms, ScoreTerm::kHidden, 0.7);
  }
  const std::vector<LimitFinding> found = find_limits(parts, context());
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].limit, ScoreLimit::kHidden);
  EXPECT_EQ(found[0].parts, (std::vector<int>{2, 3}));
  EXPECT_EQ(found[1].limit, ScoreLimit::kOutline);
}

}  // namespace
}  // namespace binpick::app
