// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/attempt/figure_text.h"

#include <gtest/gtest.h>

#include "analytics/checkpoints/checkpoint.h"
#include "tests/support/message.h"

namespace calot::gui {
namespace {

using analytics::Verdict;

const analytics::CheckpointDefinition& pathLength() { return *analytics::findCheckpoint("path-length"); }

analytics::AttemptRow verifiedAttempt() {
  analytics::AttemptRow attempt;
  attempt.uuid = "00001000-0000-4000-8000-000000000001";
  attempt.comparabilityKey = std::string("k");
  attempt.complete = true;
  attempt.outcome = recorder::Outcome::completed;
  attempt.verification.verdict = Verdict::verified;
  return attempt;
}

/// Competent members with left paths of 1 to `count` m, one other member far off, and a cut.
analytics::Norm normOf(int count, double cut) {
  analytics::Norm norm;
  norm.name = "residents";
  norm.version = 2;
  norm.comparabilityKey = "k";
  analytics::NormCheckpoint mark;
  mark.checkpoint = "path-length";
  mark.subject = "left";
  mark.version = pathLength().version;
  mark.direction = analytics::Direction::lower;
  mark.inRule = true;
  mark.cut = cut;
  mark.lower = cut - 0.4;
  mark.upper = cut + 0.4;
  norm.checkpoints = {mark};
  for (int i = 1; i <= count; ++i)
    norm.members.push_back({std::string("m").append(std::to_string(i)), true, {static_cast<double>(i)}});
  norm.members.push_back({"far", false, {1000.0}});
  return norm;
}

std::vector<analytics::CheckpointValue> path(double metres) {
  return {analytics::makeValue(pathLength(), "left", analytics::Origin::samples, metres)};
}

// Quantiles of type 7 of 1, ..., 9 at p: 1 + 8 p.
TEST(FigureStanding, TheBandIsOfTheCompetentMembers) {
  const AttemptStanding standing = standingOf(verifiedAttempt(), path(3.0), normOf(9, 6.0));
  ASSERT_EQ(standing.figures.size(), 1U);
  const FigureStanding& figure = standing.figures[0];
  ASSERT_TRUE(figure.band);
  const double factor = pathLength().displayFactor;
  EXPECT_DOUBLE_EQ(figure.band->p10, 1.8 * factor);
  EXPECT_DOUBLE_EQ(figure.band->p25, 3.0 * factor);
  EXPECT_DOUBLE_EQ(figure.band->p50, 5.0 * factor);
  EXPECT_DOUBLE_EQ(figure.band->p75, 7.0 * factor);
  EXPECT_DOUBLE_EQ(figure.band->p90, 8.2 * factor);
  EXPECT_DOUBLE_EQ(*figure.value, 3.0 * factor);
  EXPECT_DOUBLE_EQ(*figure.cut, 6.0 * factor);
  EXPECT_EQ(standing.norm, "residents version 2");
}

TEST(FigureStanding, ShortPathsPassAndLongOnesFallShort) {
  const FigureStanding good = standingOf(verifiedAttempt(), path(3.0), normOf(9, 6.0)).figures[0];
  EXPECT_EQ(good.passed, true);
  // Six of nine are worse, one is equal: 100 (6 + 1/2 + 1/2) / 10.
  ASSERT_TRUE(good.percentile) << good.explanation;
  EXPECT_DOUBLE_EQ(*good.percentile, 70.0);
  EXPECT_FALSE(good.open);
  EXPECT_EQ(standingOf(verifiedAttempt(), path(8.0), normOf(9, 6.0)).figures[0].passed, false);
  EXPECT_TRUE(standingOf(verifiedAttempt(), path(6.2), normOf(9, 6.0)).figures[0].open)
      << "within the interval of the cut";
}

TEST(FigureStanding, FewMembersGiveNoBand) {
  const FigureStanding figure = standingOf(verifiedAttempt(), path(3.0), normOf(4, 6.0)).figures[0];
  EXPECT_FALSE(figure.band);
  EXPECT_FALSE(figure.percentile);
  expectNames(figure.explanation, {"5"});
}

TEST(FigureStanding, WhatDidNotVerifyIsNotJudged) {
  analytics::AttemptRow attempt = verifiedAttempt();
  attempt.verification.verdict = Verdict::diverged;
  const AttemptStanding standing = standingOf(attempt, path(8.0), normOf(9, 6.0));
  EXPECT_FALSE(standing.judged);
  expectNames(standing.verdict, {"judged: "});
  EXPECT_FALSE(standing.figures[0].passed);
  EXPECT_TRUE(standing.figures[0].band) << "the norm stands all the same";
}

TEST(FigureStanding, ValuesOfAnotherVersionAreNotPlaced) {
  std::vector<analytics::CheckpointValue> older = path(3.0);
  ++older[0].version;
  const FigureStanding figure = standingOf(verifiedAttempt(), older, normOf(9, 6.0)).figures[0];
  EXPECT_FALSE(figure.value);
  EXPECT_FALSE(figure.passed.value_or(false));
}

TEST(FigureStanding, NormsOfTheSameKeyTheNewestOfEachName) {
  std::vector<analytics::Norm> norms{normOf(9, 1.0), normOf(9, 2.0), normOf(9, 3.0), normOf(9, 4.0)};
  norms[0].version = 3;
  norms[2].comparabilityKey = "other";
  norms[3].name = "experts";
  const auto found = normsFor(verifiedAttempt(), norms);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0]->name, "experts");
  EXPECT_EQ(found[1], &norms[0]);
}

}  // namespace
}  // namespace calot::gui
