// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/comparison.h"

#include <gtest/gtest.h>

#include "analytics/checkpoints/checkpoint.h"
#include "gui/dashboard/figure_panel.h"
#include "gui/dashboard/pair_page.h"
#include "tests/support/message.h"

namespace calot::gui::trainee_history_test {
namespace {

using analytics::AttemptRow;
using analytics::AttemptValue;
using analytics::Verdict;

const Figure leftPath{"path-length", "left"};

AttemptRow attempt(const std::string& uuid, const std::string& start, const std::string& key = "k") {
  AttemptRow row;
  row.uuid = uuid;
  row.participant = "P1";
  row.startUtc = start;
  row.comparabilityKey = key;
  row.complete = true;
  row.verification.verdict = Verdict::verified;
  return row;
}

AttemptValue path(const std::string& uuid, double metres, std::uint32_t older = 0) {
  AttemptValue value{uuid, analytics::makeValue(*analytics::findCheckpoint("path-length"), "left",
                                                analytics::Origin::samples, metres)};
  value.value.version -= older;
  return value;
}

TEST(TraineeHistory, IsInTheOrderOfTheStartsAndOfOneKey) {
  const std::vector<AttemptRow> attempts{attempt("b", "2026-02-01T00:00:00Z"), attempt("a", "2026-01-01T00:00:00Z"),
                                         attempt("c", "2026-03-01T00:00:00Z", "other")};
  const TraineeHistory history =
      historyOf(attempts, {path("a", 2.0), path("b", 1.5), path("c", 9.0)}, {}, {"P1", false}, leftPath, "k");
  ASSERT_EQ(history.attempts.size(), 2U);
  EXPECT_EQ(history.attempts[0].attempt->uuid, "a");
  const double factor = analytics::findCheckpoint("path-length")->displayFactor;
  EXPECT_DOUBLE_EQ(*history.attempts[0].value, 2.0 * factor);
  EXPECT_EQ(history.unit, analytics::findCheckpoint("path-length")->displayUnit);
  EXPECT_EQ(history.otherKeys, 1);
  EXPECT_FALSE(history.curve) << "two values cannot carry a curve of two parameters";
}

// Values that lie on a - b / x exactly give a and b back.
TEST(TraineeHistory, FitsTheCurveOfWhatCounts) {
  std::vector<AttemptRow> attempts;
  std::vector<AttemptValue> values;
  for (int i = 1; i <= 6; ++i) {
    const std::string uuid = "u" + std::to_string(i);
    attempts.push_back(attempt(uuid, "2026-01-0" + std::to_string(i) + "T00:00:00Z"));
    values.push_back(path(uuid, 1.0 + 2.0 / i));
  }
  attempts[3].verification.verdict = Verdict::diverged;
  values[3] = path("u4", 50.0);
  const TraineeHistory history = historyOf(attempts, values, {}, {"P1", false}, leftPath, "k");
  ASSERT_TRUE(history.curve) << history.curve.reason();
  const double factor = analytics::findCheckpoint("path-length")->displayFactor;
  EXPECT_NEAR(history.curve->plateau, 1.0 * factor, 1e-6 * factor);
  EXPECT_NEAR(history.curve->gap, -2.0 * factor, 1e-6 * factor);
  EXPECT_EQ(history.attempts[3].why, "diverged");
  EXPECT_TRUE(history.attempts[3].value) << "it is shown, and not in the curve";
}

TEST(TraineeHistory, PerformersDoNotLearn) {
  std::vector<AttemptRow> attempts;
  std::vector<AttemptValue> values;
  for (int i = 1; i <= 6; ++i) {
    attempts.push_back(attempt("u" + std::to_string(i), "2026-01-01T00:00:00Z"));
    attempts.back().participant.clear();
    attempts.back().profile = "skilled";
    attempts.back().synthetic = true;
    values.push_back(path(attempts.back().uuid, 1.0 + 2.0 / i));
  }
  ASSERT_EQ(traineesOf(attempts), (std::vector<Trainee>{{"skilled", true}}));
  const TraineeHistory history = historyOf(attempts, values, {}, {"skilled", true}, leftPath, "k");
  EXPECT_FALSE(history.curve);
  expectNames(history.curve.reason(), {"performer"});
}

TEST(TraineeHistory, TakesTheCutOfTheNewestNormOfItsKey) {
  const std::vector<AttemptRow> attempts{attempt("a", "2026-01-01T00:00:00Z")};
  const auto version = analytics::findCheckpoint("path-length")->version;
  const auto norm = [&](std::uint32_t number, const std::string& key, double cut) {
    analytics::Norm made;
    made.name = "n";
    made.version = number;
    made.comparabilityKey = key;
    analytics::NormCheckpoint mark;
    mark.checkpoint = "path-length";
    mark.subject = "left";
    mark.version = version;
    mark.cut = cut;
    made.checkpoints = {mark};
    return made;
  };
  const TraineeHistory history =
      historyOf(attempts, {path("a", 2.0)}, {norm(1, "k", 3.0), norm(2, "k", 4.0), norm(3, "other", 5.0)},
                {"P1", false}, leftPath, "k");
  ASSERT_TRUE(history.cut);
  EXPECT_DOUBLE_EQ(*history.cut, 4.0 * analytics::findCheckpoint("path-length")->displayFactor);
}

TEST(MomentCycle, BeginsWithTheMomentThatMadeMostAndGoesAround) {
  analytics::FigureMoments figure;
  figure.checkpoint = "path-length";
  figure.moments = {{10.0, 11.0, 0.2}, {20.0, 21.0, 0.5}, {30.0, 31.0, 0.3}};
  MomentCycle cycle;
  std::vector<double> times;
  for (int click = 0; click < 4; ++click) times.push_back(*cycle.next(figure));
  EXPECT_EQ(times, (std::vector<double>{19.5, 29.5, 9.5, 19.5}));
  analytics::FigureMoments other = figure;
  other.subject = "left";
  other.moments = {{0.2, 1.0, 1.0}};
  EXPECT_EQ(cycle.next(other), 0.0) << "not before the attempt";
  EXPECT_EQ(cycle.next(figure), 19.5) << "another figure between: from its worst again";
  EXPECT_FALSE(cycle.next({}));
}

TEST(PairAlignment, FromTheStartsBothRunTillTheLongerEnds) {
  const PairAlignment both({10.0, 25.0}, {0.0, 0.0});
  EXPECT_DOUBLE_EQ(both.begin(), 0.0);
  EXPECT_DOUBLE_EQ(both.end(), 25.0);
  EXPECT_DOUBLE_EQ(both.own(0, 7.0), 7.0);
  EXPECT_DOUBLE_EQ(both.own(0, 20.0), 10.0) << "stands at its end";
  EXPECT_FALSE(both.runs(0, 20.0));
  EXPECT_TRUE(both.runs(1, 20.0));
}

TEST(PairAlignment, FromAPhaseItsBeginsCoincide) {
  const PairAlignment both({10.0, 25.0}, {4.0, 12.0});
  EXPECT_DOUBLE_EQ(both.begin(), -12.0);
  EXPECT_DOUBLE_EQ(both.end(), 13.0);
  EXPECT_DOUBLE_EQ(both.own(0, 0.0), 4.0);
  EXPECT_DOUBLE_EQ(both.own(1, 0.0), 12.0);
  EXPECT_FALSE(both.runs(0, -5.0)) << "waits for its begin";
  for (const std::size_t side : {0U, 1U}) EXPECT_DOUBLE_EQ(both.common(side, both.own(side, 2.5)), 2.5);
}

TEST(PairAlignment, ByPhasesThatBothHave) {
  AttemptTrack a, b;
  a.phases = {
      {Phase::identification, 0, 5}, {Phase::clipping, 5, 8}, {Phase::identification, 8, 9}, {Phase::cutting, 9, 10}};
  b.phases = {{Phase::identification, 0, 7}, {Phase::cutting, 7, 9}};
  EXPECT_EQ(commonPhases(a, b), (std::vector<Phase>{Phase::identification, Phase::cutting}));
  EXPECT_EQ(firstOf(a, Phase::identification), 0.0);
  EXPECT_EQ(firstOf(b, Phase::clipping), std::nullopt);
}

}  // namespace
}  // namespace calot::gui::trainee_history_test
