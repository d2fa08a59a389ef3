// SPDX-License-Identifier: GPL-3.0-or-later
// Fixed pass marks, the short rule that counts where none is named, and a norm that its own members fail.
#include "analytics/assessment/norm.h"

#include <gtest/gtest.h>

#include <sstream>

#include "analytics/assessment/grade.h"
#include "analytics/report/grade_sheet.h"
#include "tests/analytics/cohort/support/cohort_support.h"
#include "tests/support/fault.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

using support::humanAttempt;
using support::uuidOf;

/// Six experts and six novices. Experts are faster and straighter by a hair, and alike in what harms: all have six
/// points of the critical view and no clip error.
class NormRule : public testing::Test {
 protected:
  NormRule() : path_(folder_.file("c.db")), cohort_(path_, CohortDatabase::Access::create) {
    for (unsigned i = 0; i < 6; ++i) {
      add(i, fmt::format("E{}", i), "expert", 60.0 + i, 0.99995 + 0.00001 * i, 6.0, 0.0);
      add(10 + i, fmt::format("N{}", i), "novice", 120.0 + 2 * i, 0.9998 + 0.00001 * i, i < 3 ? 6.0 : 4.0,
          i < 4 ? 0.0 : 2.0);
    }
    request_.name = "clinic";
    request_.by = "A. Instructor";
  }

  void add(unsigned n, const std::string& who, const std::string& group, double time, double straight, double view,
           double errors) {
    if (!support::findParticipant(cohort_, who)) cohort_.addParticipant({who, group, "", "", {}, {}});
    cohort_.storeAttempt(humanAttempt(n, who),
                         {makeValue(*findCheckpoint("elapsed-time"), "", Origin::resimulated, time),
                          makeValue(*findCheckpoint("movement-straightness"), "left", Origin::samples, straight),
                          makeValue(*findCheckpoint("critical-view"), "", Origin::resimulated, view),
                          makeValue(*findCheckpoint("clip-errors"), "", Origin::resimulated, errors)});
  }

  Norm made() { return makeNorm(cohort_.listAttempts(), cohort_.allValues(), {}, request_, "c.db"); }
  Grade graded(unsigned n, const Norm& norm) {
    return gradeAttempt(*cohort_.attempt(uuidOf(n)), cohort_.listAttempts(), cohort_.allValues(), norm, false, "c.db");
  }
  static std::vector<std::string> inRule(const Norm& norm) {
    std::vector<std::string> names;
    for (const NormCheckpoint& mark : norm.checkpoints) {
      if (mark.inRule) names.push_back(mark.checkpoint);
    }
    return names;
  }
  static const NormCheckpoint& markOf(const Norm& norm, const std::string& checkpoint) {
    for (const NormCheckpoint& mark : norm.checkpoints) {
      if (mark.checkpoint == checkpoint) return mark;
    }
    throw std::out_of_range(checkpoint);
  }

  support::Folder folder_;
  std::string path_;
  CohortDatabase cohort_;
  NormRequest request_;
};

TEST_F(NormRule, theRuleThatNobodyNamesIsShort) {
  const Norm norm = made();
  EXPECT_EQ(inRule(norm), std::vector<std::string>{"elapsed-time"});
  EXPECT_FALSE(markOf(norm, "critical-view").cut);
  expectNames(uncountedWarning(norm), {"critical-view, clip-errors"});
  request_.checkpoints = {"all"};
  EXPECT_GT(inRule(made()).size(), 1U) << "a difference of 0.0002 counts where it is asked for";
}

TEST_F(NormRule, anInstructorFixesWhatIsCritical) {
  request_.fixed = {parseFixedCut("critical-view>=5"), parseFixedCut("clip-errors <= 0")};
  const Norm norm = made();
  EXPECT_EQ(inRule(norm), (std::vector<std::string>{"elapsed-time", "critical-view", "clip-errors"}));
  EXPECT_EQ(markOf(norm, "critical-view").cut, 5.0);
  EXPECT_TRUE(isFixed(markOf(norm, "critical-view")));
  EXPECT_FALSE(isFixed(markOf(norm, "elapsed-time")));
  expectNames(markOf(norm, "critical-view").reason, {"A. Instructor"});
  EXPECT_EQ(uncountedWarning(norm), "");
  const auto [competent, others] = passRates(norm);
  EXPECT_EQ(competent.passed, 6U);
  EXPECT_EQ(others.passed, 0U);
  // Stored and read as any other mark.
  CohortDatabase database(path_, CohortDatabase::Access::write);
  database.storeNorm(norm);
  const Norm stored = database.norm("clinic");
  EXPECT_EQ(markOf(stored, "clip-errors").cut, 0.0);
  EXPECT_TRUE(isFixed(markOf(stored, "clip-errors")));
}

TEST_F(NormRule, whatIsFixedHasToBePassedInAnyCase) {
  request_.fixed = {parseFixedCut("critical-view>=5"), parseFixedCut("clip-errors<=0")};
  request_.leastPassed = 2;
  add(30, "T0", "", 50.0, 0.9999, 6.0, 0.0);
  add(31, "T1", "", 50.0, 0.9999, 6.0, 1.0);
  add(32, "T2", "", 500.0, 0.9999, 6.0, 0.0);
  const Norm norm = made();
  EXPECT_TRUE(graded(30, norm).passed);
  EXPECT_TRUE(graded(32, norm).passed) << "two of three, and neither fixed one failed";
  const Grade failed = graded(31, norm);
  EXPECT_FALSE(failed.passed) << "two of three are passed, too";
  EXPECT_EQ(failed.passedCount, 2U);
  expectNames(failed.verdict, {"Clips misplaced"});
}

TEST_F(NormRule, aNormThatItsOwnMembersFailIsSaidToBeOne) {
  request_.fixed = {parseFixedCut("elapsed-time<=62")};
  const Norm norm = made();
  expectNames(ownFailureWarning(norm), {"3", "6"});
  std::ostringstream sheet;
  printGrade(graded(0, norm), sheet);
  std::string words = sheet.str();
  expectHolds(words, {ownFailureWarning(norm)});
}

TEST_F(NormRule, whatCannotBeFixedIsRefused) {
  for (const char* text :
       {"", "clip-errors", "clip-errors=0", "clip-errors<0", "clip-errors<=", "<=0", "clip-errors<=nan"})
    expectFault(ErrorKind::invalid, "", {"norm", text}, [&] { parseFixedCut(text); });
  request_.fixed = {parseFixedCut("clip-errors>=0")};
  expectFault(ErrorKind::invalid, "", {"norm", "clip-errors"}, [&] { made(); });
  request_.fixed = {parseFixedCut("sparc left>=0")};
  expectFault(ErrorKind::invalid, "", {"\"sparc left\""}, [&] { made(); }, {Remedy::nameCheckpoints});
}

}  // namespace
}  // namespace calot::analytics
