// SPDX-License-Identifier: GPL-3.0-or-later
// Norms and grades: pass marks of a known cut, the rule and what it lets through, critical errors first, percentiles
// within what n tells, moments, history, and "formative" until there is evidence.
#include "analytics/assessment/grade.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "analytics/report/attempt_sheet.h"
#include "analytics/report/grade_sheet.h"
#include "analytics/report/report_document.h"
#include "tests/analytics/cohort/support/cohort_support.h"
#include "tests/support/fault.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

using Access = CohortDatabase::Access;
using support::Folder;
using support::humanAttempt;
using support::uuidOf;

std::vector<CheckpointValue> figures(double left, double right, double errors = 0.0) {
  return {makeValue(*findCheckpoint("path-length"), "left", Origin::samples, left),
          makeValue(*findCheckpoint("path-length"), "right", Origin::samples, right),
          makeValue(*findCheckpoint("critical-errors"), "", Origin::resimulated, errors)};
}

/// Eight values, equally far apart, of this mean and sample deviation.
std::array<double, 8> eightOf(double mean, double deviation) {
  std::array<double, 8> values{};
  // -7, -5 .. 7: squares sum to 168, of which a seventh is 24.
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = mean + deviation * (2.0 * static_cast<double>(i) - 7.0) / std::sqrt(24.0);
  return values;
}

/// Experts N(50, 10) and novices N(70, 5) on the left, whose curves cross at 61.7004517205; all alike on the right.
class Grades : public testing::Test {
 protected:
  Grades() : path_(folder_.file("c.db")), cohort_(path_, Access::create) {
    const auto experts = eightOf(50.0, 10.0), novices = eightOf(70.0, 5.0);
    for (unsigned i = 0; i < 8; ++i) {
      add(i, fmt::format("E{}", i), "expert", figures(experts[i], 1.0 + i));
      add(10 + i, fmt::format("N{}", i), "novice", figures(novices[i], 1.0 + i));
    }
    request_.name = "clinic";
    request_.by = "me";
  }

  void add(unsigned n, const std::string& who, const std::string& group, const std::vector<CheckpointValue>& values) {
    if (!support::findParticipant(cohort_, who)) cohort_.addParticipant({who, group, "", "", {}, {}});
    cohort_.storeAttempt(humanAttempt(n, who), values);
  }

  Norm made(const std::vector<Rating>& ratings = {}) {
    return makeNorm(cohort_.listAttempts(), cohort_.allValues(), ratings, request_, "c.db");
  }

  Grade graded(unsigned n, const Norm& norm, bool mixKeys = false) {
    return gradeAttempt(*cohort_.attempt(uuidOf(n)), cohort_.listAttempts(), cohort_.allValues(), norm, mixKeys,
                        "c.db");
  }

  Folder folder_;
  std::string path_;
  CohortDatabase cohort_;
  NormRequest request_;
};

TEST_F(Grades, aPassMarkIsWhereTheCurvesCross) {
  const Norm norm = made();
  ASSERT_EQ(norm.checkpoints.size(), 3U);
  EXPECT_EQ(norm.checkpoints[2].checkpoint, "critical-errors");
  EXPECT_EQ(norm.checkpoints[2].version, findCheckpoint("critical-errors")->version) << "of the rules, kept";
  EXPECT_FALSE(norm.checkpoints[2].cut) << "they are asked first and have no pass mark";
  const NormCheckpoint& left = norm.checkpoints[0];
  EXPECT_NEAR(*left.cut, 61.7004517205, 1e-9);
  EXPECT_FALSE(left.logScale) << "lengths are not times";
  EXPECT_TRUE(left.inRule);
  ASSERT_TRUE(left.lower);
  EXPECT_LT(*left.lower, *left.cut);
  EXPECT_GT(*left.upper, *left.cut);
  EXPECT_FALSE(norm.checkpoints[1].cut) << "no difference, no mark";
  EXPECT_FALSE(norm.checkpoints[1].inRule);
  EXPECT_NE(norm.checkpoints[1].reason, "");
  EXPECT_EQ(norm.judgedBy, "group expert against novice");
  // The experts' last is at 64.3, the novices' first at 62.9.
  const auto [competent, others] = passRates(norm);
  EXPECT_EQ(competent.passed, 7U);
  EXPECT_EQ(competent.members, 8U);
  EXPECT_EQ(others.passed, 0U);
  expectNames(ownFailureWarning(norm), {"1", "8"});
}

TEST_F(Grades, aNormWantsSomeMembersOfEachSide) {
  for (unsigned i = 0; i < 5; ++i) cohort_.excludeAttempts({uuidOf(i)}, "test", "me");
  EXPECT_EQ(made().members.size(), 11U);
  cohort_.excludeAttempts({uuidOf(5)}, "test", "me");
  expectFault(ErrorKind::refused, "", {"3", "2", "8", "2 and 8"}, [&] { (void)made(); });
}

TEST_F(Grades, theRuleIsDeclaredAndRefusedWhereItCannotBe) {
  request_.checkpoints = {"path-length left"};
  EXPECT_EQ(neededPasses(made()), 1U);
  request_.checkpoints = {"path-length"};
  expectFault(ErrorKind::refused, "", {"path-length"}, [&] { made(); });
  request_.checkpoints = {"sparc"};
  expectFault(ErrorKind::invalid, "", {"\"sparc\""}, [&] { made(); }, {Remedy::nameCheckpoints});
  request_.checkpoints.clear();
  request_.leastPassed = 2;
  expectFault(ErrorKind::refused, "", {"2", "1"}, [&] { made(); });
  request_.leastPassed = 0;
  request_.name = "a b";
  expectFault(ErrorKind::invalid, "", {"norm", "1", "64"}, [&] { made(); });
  request_.name = "x";
  request_.who.attemptRule = AttemptRule::mean;
  expectFault(ErrorKind::invalid, "", {"norm"}, [&] { made(); }, {Remedy::takeFirst});
}

TEST_F(Grades, figuresOfPhasesCountWhereTheyAreAskedFor) {
  for (unsigned i = 0; i < 16; ++i) {
    const unsigned n = i < 8 ? i : i + 2;  // as they were added
    auto values = cohort_.values(uuidOf(n));
    values.push_back(makeValue(*findCheckpoint("phase-path-length"), "left clipping", Origin::resimulated,
                               (i < 8 ? 1.0 : 5.0) + 0.1 * i));
    cohort_.storeValues(uuidOf(n), values);
  }
  EXPECT_EQ(made().checkpoints.size(), 3U);
  request_.checkpoints = {"path-length left", "phase-path-length left clipping"};
  EXPECT_EQ(neededPasses(made()), 2U);
  request_.checkpoints.clear();
  request_.who.includePhases = true;
  EXPECT_EQ(made().checkpoints.size(), 4U);
}

TEST_F(Grades, aNormOfFewSaysThatItsIntervalsCoverTooLittle) {
  expectNames(passMarkWarning(made()), {"10", "95 %", "90.7 %", "70 (5)", "50 (10)"});
}

TEST_F(Grades, ratersJudgeWhereThereAreRatings) {
  request_.judgedBy = "competence";
  expectFault(ErrorKind::refused, "", {"competence"}, [&] { made(); });
  std::vector<Rating> ratings;
  const auto rate = [&](unsigned n, const std::string& rater, int score) {
    ratings.push_back({"competence", 1, uuidOf(n), rater, "", {{"competent", score}}, ""});
  };
  for (unsigned i = 0; i < 8; ++i) {
    for (const char* rater : {"R1", "R2"}) {
      rate(i, rater, 1);
      rate(10 + i, rater, 0);
    }
  }
  rate(10, "R3", 1);  // two against one: still not competent
  Norm norm = made(ratings);
  EXPECT_EQ(norm.members.size(), 16U);
  expectNames(norm.judgedBy, {"competence", "majority"});
  EXPECT_NEAR(*norm.checkpoints[0].cut, 61.7004517205, 1e-9);
  rate(10, "R4", 1);  // divided: in neither group
  EXPECT_EQ(made(ratings).members.size(), 15U);
}

TEST_F(Grades, criticalErrorsComeFirst) {
  add(20, "T1", "", figures(40.0, 1.0, 1.0));
  add(21, "T2", "", figures(40.0, 1.0));
  add(22, "T3", "", {figures(40.0, 1.0)[0]});
  const Norm norm = made();
  const Grade failed = graded(20, norm);
  EXPECT_FALSE(failed.passed);
  EXPECT_EQ(failed.figures[0].passed, true) << "though every figure passed";
  expectNames(failed.verdict, {"1 critical error"});
  EXPECT_TRUE(weakFigures(failed).empty()) << "the verdict says which errors";
  const Grade passed = graded(21, norm);
  EXPECT_TRUE(passed.passed);
  EXPECT_TRUE(weakFigures(passed).empty());
  expectNames(graded(22, norm).criticalMissing, {});
}

TEST_F(Grades, aMembersCriticalErrorCountsInTheNormsOwnRates) {
  cohort_.storeValues(uuidOf(1), figures(50.0, 1.0, 1.0));
  EXPECT_EQ(passRates(made()).first.passed, 6U) << "one of the seven whose figures pass";
}

TEST_F(Grades, errorsByOtherRulesThanTheNormsAreSaid) {
  Norm norm = made();
  add(20, "T1", "", figures(40.0, 1.0));
  EXPECT_TRUE(graded(20, norm).remarks.empty());
  const auto now = norm.checkpoints[2].version--;
  ASSERT_EQ(graded(20, norm).remarks.size(), 1U);
  expectNames(graded(20, norm).remarks[0],
              {"version " + std::to_string(now), "version " + std::to_string(norm.checkpoints[2].version)});
}

TEST_F(Grades, weakOpenAndMissingFigures) {
  const Norm norm = made();
  add(20, "T1", "", figures(100.0, 2.0));
  add(21, "T2", "", figures(*norm.checkpoints[0].cut + 1e-6, 2.0));
  add(22, "T3", "", {});
  const Grade weak = graded(20, norm);
  EXPECT_FALSE(weak.passed);
  EXPECT_TRUE(weak.certain);
  EXPECT_EQ(weakFigures(weak), (std::vector<std::pair<std::string, std::string>>{{"path-length", "left"}}));
  const Grade open = graded(21, norm);
  EXPECT_FALSE(open.passed);
  EXPECT_TRUE(open.figures[0].open);
  EXPECT_FALSE(open.certain);
  expectNames(open.verdict, {"certain"});
  const Grade missing = graded(22, norm);
  EXPECT_FALSE(missing.passed) << "a figure without a value is not passed";
  expectNames(missing.figures[0].missing, {});
  ASSERT_EQ(graded(0, norm).remarks.size(), 1U);
  expectNames(graded(0, norm).remarks[0], {"member"});
}

/// A mark inside a figure's interval is not decided by the simulation, whatever the norm's own interval.
TEST_F(Grades, aMarkInsideTheIntervalIsNotDecided) {
  const Norm norm = made();
  const double cut = *norm.checkpoints[0].cut;
  const auto withInterval = [&](unsigned n, double lower, double upper) {
    add(n, fmt::format("U{}", n), "", figures(100.0, 2.0));
    cohort_.storeIntervals(
        uuidOf(n),
        {{"path-length", "left", findCheckpoint("path-length")->version, 100.0, 0, 0, 1.0, lower, upper, "", {}},
         {"path-length", "right", findCheckpoint("path-length")->version, 2.0, 0, 0, 0.0, 2.0, 2.0, "", {}}});
    return graded(n, norm);
  };
  const Grade decided = withInterval(40, cut + 1.0, 150.0);
  ASSERT_TRUE(decided.figures[0].interval);
  EXPECT_FALSE(decided.figures[0].undecided);
  EXPECT_TRUE(decided.certain);
  const Grade undecided = withInterval(41, cut - 1.0, 150.0);
  EXPECT_TRUE(undecided.figures[0].undecided);
  EXPECT_FALSE(undecided.passed) << "the value itself still counts";
  EXPECT_FALSE(undecided.certain);
  expectNames(undecided.verdict, {"simulation"});
  std::ostringstream sheet;
  printGrade(undecided, sheet);
  expectHolds(sheet.str(), {"undecided"});
  EXPECT_TRUE(gradeTree(undecided)["figures"][0]["undecided"].get<bool>());
}

TEST_F(Grades, aCriticalErrorThatOnlySomeSimulationsSeeIsNotDecided) {
  const Norm norm = made();
  add(42, "U", "", figures(50.0, 2.0, 1.0));
  EXPECT_TRUE(graded(42, norm).certain);
  const CheckpointValue errors = cohort_.values(uuidOf(42)).back();
  ASSERT_EQ(errors.name, "critical-errors");
  cohort_.storeIntervals(uuidOf(42), {{errors.name, "", errors.version, 1.0, 0, 0, 0.4, 0.2, 1.8, "", {}}});
  EXPECT_FALSE(graded(42, norm).passed);
  EXPECT_FALSE(graded(42, norm).certain);
}

TEST_F(Grades, comparesOnlyWhatCompares) {
  const Norm norm = made();
  AttemptRecord other = humanAttempt(30, "T9");
  other.comparabilityKey = "another/1";
  cohort_.storeAttempt(other, figures(1, 1));
  expectFault(ErrorKind::refused, "", {"clinic", uuidOf(30)}, [&] { graded(30, norm); }, {Remedy::mixKeys});
  EXPECT_EQ(graded(30, norm, true).remarks.size(), 1U);
  AttemptRecord bad = humanAttempt(31, "T8");
  bad.verification.verdict = Verdict::diverged;
  cohort_.storeAttempt(bad, {});
  expectFault(ErrorKind::refused, "", {uuidOf(31), "diverged"}, [&] { graded(31, norm); });
  AttemptRecord cut = humanAttempt(32, "T7");
  cut.complete = false;
  cohort_.storeAttempt(cut, {});
  expectFault(ErrorKind::refused, "", {uuidOf(32), "incomplete"}, [&] { graded(32, norm); });
}

TEST(Percentile, saysNoMoreThanItsMembersTell) {
  const std::vector<double> nine{1, 2, 3, 4, 5, 6, 7, 8, 9};
  EXPECT_DOUBLE_EQ(*percentile(nine, 5.0, Direction::higher), 50.0);
  EXPECT_DOUBLE_EQ(*percentile(nine, 5.0, Direction::lower), 50.0);
  EXPECT_DOUBLE_EQ(*percentile(nine, 9.0, Direction::higher), 90.0) << "the best member is at 100 n / (n + 1)";
  EXPECT_DOUBLE_EQ(*percentile(nine, 1.0, Direction::higher), 10.0);
  EXPECT_DOUBLE_EQ(*percentile(nine, 1.5, Direction::lower), 85.0);
  expectNames(percentile(nine, 9.5, Direction::higher).reason(), {"better", "9", "10", "90"});
  expectNames(percentile(nine, 9.5, Direction::lower).reason(), {"worse", "9", "10", "90"});
  EXPECT_EQ(percentile({1, 2, 3, 4}, 2.0, Direction::lower).reason(), "4 members, 5 needed");
}

TEST(Moments, areWhereAFigureGrew) {
  // Ten windows of a second; of 20 in all, 12 come in the fourth and fifth together and 4 in the last.
  const FigureMoments found = momentsOf({0, 1, 1, 7, 13, 14, 15, 15, 16, 20}, 1.0, Direction::lower);
  EXPECT_EQ(found.none, "");
  ASSERT_EQ(found.moments.size(), 2U);
  EXPECT_DOUBLE_EQ(found.moments[0].begin, 3.0);
  EXPECT_DOUBLE_EQ(found.moments[0].end, 5.0);
  EXPECT_DOUBLE_EQ(found.moments[0].share, 0.6);
  EXPECT_DOUBLE_EQ(found.moments[1].begin, 9.0);
  const std::string whole = momentsOf({1, 5, 2, 3}, 1.0, Direction::lower).none;
  EXPECT_EQ(momentsOf({0, 0}, 1.0, Direction::lower).none, whole);
  EXPECT_EQ(momentsOf({NAN, 0.9, 0.9}, 1.0, Direction::higher).none, whole);
  // What is known only from the third second on began somewhere before: it does not all belong to that second.
  EXPECT_EQ(momentsOf({NAN, NAN, 5.0, 5.0}, 1.0, Direction::lower).none, whole);
  expectDistinct(
      {whole, momentsOf({1, 2, 3, 4}, 1.0, Direction::lower).none, momentsOf({NAN, NAN}, 1.0, Direction::lower).none});
}

TEST(Moments, areWhereAFigureGotWorse) {
  // Of what should stay high the moments are its falls; that it came about is none.
  const FigureMoments fell = momentsOf({1.0, 1.0, 1.0, 0.4, 0.4, 0.4, 0.3}, 1.0, Direction::higher);
  ASSERT_EQ(fell.moments.size(), 1U);
  EXPECT_DOUBLE_EQ(fell.moments[0].begin, 3.0);
  EXPECT_NEAR(fell.moments[0].share, 6.0 / 7.0, 1e-12);
  // A filter that looks ahead takes a little back: no share is more than the whole.
  const FigureMoments settling = momentsOf({0.0, 0.0, 0.0, 1.01, 1.0, 1.0}, 1.0, Direction::lower);
  ASSERT_EQ(settling.moments.size(), 1U) << settling.none;
  EXPECT_DOUBLE_EQ(settling.moments[0].share, 1.0);
}

TEST_F(Grades, historyIsTheParticipantsOwnOfTheSameKey) {
  for (unsigned i = 0; i < 6; ++i) {
    AttemptRecord a = humanAttempt(40 + i, "T1");
    a.startUtc = fmt::format("2026-03-0{}T00:00:00Z", i + 1);
    if (i == 3) a.comparabilityKey = "another/1";
    cohort_.storeAttempt(a, figures(60.0 + 40.0 / (i + 1 - (i > 3 ? 1 : 0)), 1.0));
  }
  const Grade grade = graded(45, made());
  const GradedFigure& left = grade.figures[0];
  ASSERT_EQ(left.history.size(), 5U) << "the other key's attempt stays out";
  EXPECT_DOUBLE_EQ(left.history.front().value, 100e3) << "in mm";
  ASSERT_TRUE(left.curve) << left.curve.reason();
  EXPECT_NEAR(left.curve->plateau, 60e3, 1e-6);
  EXPECT_EQ(graded(40, made()).figures[0].history.size(), 1U) << "later attempts are not history";
}

TEST_F(Grades, normsAreKeptInVersionsWithTheirMembers) {
  CohortDatabase database(path_, Access::write);
  EXPECT_EQ(database.storeNorm(made()), 1U);
  EXPECT_EQ(database.storeNorm(made()), 2U);
  const Norm stored = database.norm("clinic", 1);
  const Norm fresh = made();
  ASSERT_EQ(stored.members.size(), fresh.members.size());
  for (std::size_t i = 0; i < fresh.members.size(); ++i) {
    EXPECT_EQ(stored.members[i].attempt, fresh.members[i].attempt);
    EXPECT_EQ(stored.members[i].competent, fresh.members[i].competent);
    EXPECT_EQ(stored.members[i].values, fresh.members[i].values);
  }
  EXPECT_EQ(stored.checkpoints[0].cut, fresh.checkpoints[0].cut) << "the same seed, the same bits";
  EXPECT_EQ(stored.checkpoints[0].lower, fresh.checkpoints[0].lower);
  expectFault(ErrorKind::refused, "", {"\"hospital\"", "1", "2", "clinic 1, clinic 2"},
              [&] { (void)database.norm("hospital"); });
}

TEST_F(Grades, aSheetIsFormativeUntilThereIsEvidence) {
  CohortDatabase database(path_, Access::write);
  database.storeNorm(made());
  add(20, "T<1>", "", figures(100.0, 2.0));
  Grade grade = graded(20, database.norm("clinic"));
  grade.momentsMissing = "the recording is not there";
  std::ostringstream text;
  printGrade(grade, text);
  EXPECT_NE(text.str().find("FORMATIVE"), std::string::npos);
  expectHolds(text.str(), {"moments"});
  expectFault(ErrorKind::invalid, "", {"norm"}, [&] {
    database.attachEvidence(database.norm("clinic"), {"", "v.pdf", std::string(64, 'a'), "me", ""});
  });
  database.attachEvidence(database.norm("clinic"), {"Agrees with raters", "v.pdf", std::string(64, 'a'), "me", ""});
  grade = graded(20, database.norm("clinic"));
  addMoments(grade, {{{"path-length", "left", {{12.0, 13.0, 0.5}}, ""}},
                     {{Severity::critical, 1, 100.2, "cystic duct left open"}, {Severity::minor, 2, 5.0, "bed torn"}}});
  const AttemptSheet sheet{grade.attempt,    database.values(grade.attempt.uuid), &grade, {}, {}, "", "a&b.h5",
                           "A & B draws it."};
  const std::string html = pageHtml(sheetDocument(sheet));
  EXPECT_EQ(html.find("FORMATIVE"), std::string::npos);
  EXPECT_NE(html.find("Agrees with raters"), std::string::npos);
  expectHolds(html, {"href=\"a&amp;b.h5#t=12.00,13.00\">0:12.0", "0:13.0 (50 %"});
  EXPECT_NE(html.find("T&lt;1&gt;"), std::string::npos) << "every text is escaped";
  expectHolds(html, {"A &amp; B", "critical, cystic duct left open: ", "#t=100.20,101.20\">1:40.2"});
  EXPECT_EQ(html.find("bed torn"), std::string::npos) << "minor errors are in the verdict alone";
  EXPECT_EQ(html.find("<script"), std::string::npos);
  const auto json = gradeTree(grade);
  EXPECT_EQ(json["use"], "evidence attached");
  EXPECT_EQ(json["passed"], false);
  EXPECT_EQ(json["figures"][0]["moments"][0]["begin"], 12.0);
  EXPECT_EQ(json["errors"][0]["error"], "cystic duct left open");
  EXPECT_EQ(json["errors"][1]["severity"], "minor");
  EXPECT_NEAR(json["figures"][0]["cut"].get<double>(), 61700.4517205, 1e-6) << "shown in mm";
}

}  // namespace
}  // namespace calot::analytics
