// SPDX-License-Identifier: GPL-3.0-or-later
// What a study's report shows first, what it leaves to the appendix, and what it doesn't test.
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "analytics/report/study.h"
#include "analytics/report/study_output.h"
#include "tests/analytics/cohort/support/cohort_support.h"
#include "tests/analytics/report/support/study_support.h"

namespace calot::analytics {
namespace {

using Access = CohortDatabase::Access;
using support::addPerformers;
using support::attemptOf;
using support::Folder;
using support::performers;
using support::rowOf;
using support::textOf;
using support::valuesOf;

TEST(StudyReport, publishedValuesStandBesideTheirTaskAlone) {
  const Folder folder;
  CohortDatabase database(folder.file("c.db"), Access::create);
  for (unsigned n = 0; n < 4; ++n) {
    AttemptRecord a = attemptOf(n, n < 2 ? "skilled" : "unskilled");
    a.scene = "cholecystectomy";
    database.storeAttempt(a, valuesOf(20 + n, 0.1 + n));
  }
  const Study study = makeStudy(database, performers);
  EXPECT_DOUBLE_EQ(*rowOf(study, "elapsed-time", "").publishedExpert, 38.86);
  EXPECT_DOUBLE_EQ(*rowOf(study, "elapsed-time", "").publishedNovice, 113.31);
  EXPECT_DOUBLE_EQ(*rowOf(study, "path-length", "left").publishedExpert, 67.36);
  EXPECT_EQ(study.setting.tasks, std::vector<std::string>{"cholecystectomy"});
  const std::string text = textOf(study);
  EXPECT_NE(text.find("E 38.86"), std::string::npos);
  for (const char* heading : {"Figures of the paper's Table 2", "Values: Table 2", "Comparison: Table 2"})
    EXPECT_NE(text.find(heading), std::string::npos) << heading;
}

TEST(StudyReport, theFirstScreenHoldsTheFirstResultAndAllTheRest) {
  const Folder folder;
  CohortDatabase database(folder.file("c.db"), Access::create);
  addPerformers(database);
  auto more = valuesOf(30, 0.03);
  more.push_back(makeValue(*findCheckpoint("depth-path"), "left", Origin::samples, 0.5));
  more.push_back(makeValue(*findCheckpoint("motion-rate"), "left", Origin::samples, 100));
  database.storeAttempt(attemptOf(30, "skilled"), more);
  more[3] = makeValue(*findCheckpoint("depth-path"), "left", Origin::samples, 0.7);
  database.storeAttempt(attemptOf(31, "unskilled"), more);
  const Study study = makeStudy(database, performers);
  EXPECT_TRUE(rowOf(study, "elapsed-time", "").leading);
  EXPECT_FALSE(rowOf(study, "depth-path", "left").leading);
  std::ostringstream out;
  printStudy(study, out, StudyDetail::first);
  const std::string first = out.str(), all = textOf(study);
  EXPECT_LE(std::count(first.begin(), first.end(), '\n'), 40) << first;
  for (const char* said : {"Task touch-liver 1, device", "Attempts of 2026-01-01", "Unit of analysis: the participant",
                           "Outcomes", "elapsed-time (s)"})
    EXPECT_NE(first.find(said), std::string::npos) << said << "\n" << first;
  EXPECT_EQ(first.find("depth-path"), std::string::npos);
  EXPECT_EQ(all.find("Table 2"), std::string::npos) << "another task";
  const std::size_t motion = all.find("Values: motion"), apart = all.find("No outcomes: not tested");
  EXPECT_LT(all.find("Values: time, path and tissue"), motion);
  EXPECT_LT(motion, apart);
  EXPECT_LT(apart, all.find("motion-rate left"));
  EXPECT_EQ(rowOf(study, "motion-rate", "left").test.reason(), "it describes the tracker");
  EXPECT_FALSE(rowOf(study, "motion-rate", "left").holm);
}

TEST(StudyReport, saysWhereTheGroupsCannotReachTheLevel) {
  const Folder folder;
  CohortDatabase database(folder.file("c.db"), Access::create);
  for (unsigned n = 0; n < 6; ++n)
    database.storeAttempt(attemptOf(n, n < 3 ? "skilled" : "unskilled"), valuesOf(10 + n, 0.1 + n));
  EXPECT_FALSE(rowOf(makeStudy(database, performers), "elapsed-time", "").attainableP) << "no hypothesis";
  StudyOptions declared = performers;
  declared.family = {"elapsed-time", "path-length"};
  const Study study = makeStudy(database, declared);
  // 2 / C(6, 3) of three against three; two tests by Holm.
  EXPECT_DOUBLE_EQ(rowOf(study, "elapsed-time", "").test->smallestP, 0.1);
  EXPECT_DOUBLE_EQ(*rowOf(study, "elapsed-time", "").attainableP, 0.2);
  EXPECT_NE(textOf(study).find("for 2 of 2 figures no adjusted p of these groups can be 0.05 or less"),
            std::string::npos)
      << textOf(study);
  CohortDatabase larger(folder.file("d.db"), Access::create);
  for (unsigned n = 0; n < 12; ++n)
    larger.storeAttempt(attemptOf(n, n < 6 ? "skilled" : "unskilled"), valuesOf(10 + n, 0.1 + n));
  EXPECT_EQ(textOf(makeStudy(larger, declared)).find("cannot decide"), std::string::npos);
}

TEST(StudyReport, aKeyIsSaidInWords) {
  EXPECT_EQ(
      comparabilityWords("touch-liver/2 device=falcon mk 2 calibration=- simulation=18 results=6 mode=assessment"),
      "task touch-liver 2, device falcon mk 2, no calibration, simulation 18, step results 6, mode assessment");
  EXPECT_EQ(comparabilityWords("knots/0 device=kinematics calibration=c1 simulation=0 results=0 mode=practice"),
            "task knots, device kinematics, calibration c1, imported motion without simulation, mode practice");
  EXPECT_EQ(comparabilityWords("k"), "k");
}

}  // namespace
}  // namespace calot::analytics
