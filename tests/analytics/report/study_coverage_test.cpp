// SPDX-License-Identifier: GPL-3.0-or-later
// A study whose groups were not measured alike says so.
#include "analytics/report/study_rows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "analytics/report/study_output.h"
#include "tests/analytics/cohort/support/cohort_support.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

/// Five experts and five novices with paths that overlap; coverage of the experts' left hand as given.
Study studyWith(const std::vector<double>& expertCoverage, double expertRate = 0.0, bool mixKeys = false) {
  const CheckpointDefinition& path = *findCheckpoint("path-length");
  std::vector<AttemptRow> attempts;
  std::vector<AttemptValue> values;
  for (unsigned n = 0; n < 10; ++n) {
    AttemptRow& a = attempts.emplace_back();
    static_cast<AttemptRecord&>(a) = support::humanAttempt(n, fmt::format("P{}", n));
    a.group = n < 5 ? "expert" : "novice";
    const double coverage = n < 5 ? expertCoverage[n] : 1.0;
    CheckpointValue left = makeValue(path, "left", Origin::samples, 0.5 + 0.01 * (n * 7 % 10));
    if (coverage < path.minCoverage)
      left = makeMissing(path, "left", Origin::samples, Availability::tooLittleCoverage, "samples cover too little");
    left.coverage = coverage;
    if (expertRate > 0.0) {
      left.rate = n < 5 ? expertRate : 30.0;
      left.noise = 1e-4;
    }
    values.push_back({a.uuid, left, {}});
    CheckpointValue right = makeMissing(path, "right", Origin::samples, Availability::absentHand, "no instrument");
    values.push_back({a.uuid, right, {}});
  }
  StudyOptions options;
  options.mixKeys = mixKeys;
  return makeStudy(attempts, values, options, "c.db");
}

std::string notesOf(const Study& study) {
  std::string text;
  for (const auto& notes : {primaryNotes(study), appendixNotes(study)}) {
    for (const std::string& note : notes) text += note + "\n";
  }
  return text;
}

TEST(StudyCoverage, ofCompleteSamplesIsOneSentence) {
  const Study study = studyWith({1.0, 1.0, 1.0, 1.0, 1.0});
  EXPECT_TRUE(coverageTable(study).rows.empty());
  expectHolds(notesOf(study), {"Coverage: samples", "whole"});
  EXPECT_EQ(notesOf(study).find("Warning: coverage"), std::string::npos);
}

TEST(StudyCoverage, warnsWhereTheGroupsDiffer) {
  const Study study = studyWith({0.95, 0.93, 0.97, 0.80, 0.91});
  ASSERT_EQ(study.coverage.size(), 1U) << "an absent hand has none";
  const CoverageRow& left = study.coverage.front();
  EXPECT_EQ(left.subject, "left");
  EXPECT_EQ(left.share[0].size(), 5U) << "the refused one is counted";
  EXPECT_EQ(left.below, (std::array<std::uint64_t, 2>{1, 0}));
  // Complete separation of five and five, all of one group tied.
  EXPECT_NEAR(left.test->p, 2.0 / 252.0, 1e-12);
  EXPECT_TRUE(coverageDiffers(left));
  const ReportTable table = coverageTable(study);
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_EQ(table.rows[0],
            (std::vector<std::string>{"left hand", "expert", "5", "93.0", "80.0", "1", pText(left.test->p), "-", "-"}));
  EXPECT_EQ(table.rows[1][4], "100.0");
  const std::string notes = notesOf(study);
  expectHolds(notes, {"Warning: coverage", "left hand", "93.0 %", "100.0 %"});
  const auto json = nlohmann::json(studyTree(study));
  EXPECT_TRUE(json["coverage"][0]["differs"].get<bool>());
  EXPECT_EQ(json["coverage"][0]["shares"][0].size(), 5U);
}

TEST(StudyCoverage, unlikeTrackersAreNotCompared) {
  const std::vector<double> whole(5, 1.0);
  const auto rowOf = [](const Study& study) { return study.rows.front(); };
  EXPECT_TRUE(rowOf(studyWith(whole, 30.0)).test);
  EXPECT_TRUE(rowOf(studyWith(whole, 36.0)).test) << "warned of";
  expectHolds(notesOf(studyWith(whole, 36.0)), {"trackers", "36.0 Hz", "30.0 Hz"});
  const Study apart = studyWith(whole, 100.0);
  EXPECT_FALSE(rowOf(apart).test);
  EXPECT_FALSE(rowOf(apart).area);
  expectHolds(rowOf(apart).test.reason(), {"100.0 Hz", "30.0 Hz"});
  EXPECT_EQ(coverageTable(apart).rows.at(0).at(7), "100.0 Hz");
  const Study mixed = studyWith(whole, 100.0, true);
  EXPECT_TRUE(rowOf(mixed).test);
  expectHolds(notesOf(mixed), {"trackers", "100.0 Hz"});
}

TEST(StudyCoverage, missingIsCountedAsWhatItIs) {
  const Study study = studyWith({0.95, 0.93, 0.97, 0.80, 0.5});
  const auto json = nlohmann::json(studyTree(study));
  for (const auto& row : json["rows"]) {
    const auto& kinds = row["groups"][0]["missing_kinds"];
    if (row["subject"] == "left") {
      EXPECT_EQ(kinds, (nlohmann::json{{"too little coverage", 2}}));
    } else {
      EXPECT_EQ(kinds, (nlohmann::json{{"absent hand", 5}}));
    }
  }
}

}  // namespace
}  // namespace calot::analytics
