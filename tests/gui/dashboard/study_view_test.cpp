// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/study_view.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <random>

#include "analytics/report/study_output.h"
#include "analytics/statistics/two_groups.h"
#include "recorder/base/errors.h"
#include "tests/support/message.h"

namespace calot::gui {
namespace {

// Ten instances in the order of their scores, p p n p n p n n p n: true and false positives counted by hand.
TEST(Roc, CountsAsByHand) {
  const std::vector<double> first{0.9, 0.8, 0.6, 0.5, 0.2}, second{0.7, 0.55, 0.4, 0.3, 0.1};
  const RocCurve curve = rocOf(first, second, false);
  ASSERT_EQ(curve.points.size(), 11U);
  const std::vector<std::pair<double, double>> expected{{0, 0}, {0, 1}, {0, 2}, {1, 2}, {1, 3}, {2, 3},
                                                        {2, 4}, {3, 4}, {4, 4}, {4, 5}, {5, 5}};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_DOUBLE_EQ(curve.points[i].falsePositive, expected[i].first / 5.0) << i;
    EXPECT_DOUBLE_EQ(curve.points[i].truePositive, expected[i].second / 5.0) << i;
  }
  // Steps of width 1/5 at heights 2, 3, 4, 4, 5 of five.
  EXPECT_DOUBLE_EQ(curve.area, (2.0 + 3.0 + 4.0 + 4.0 + 5.0) / 25.0);
}

TEST(Roc, SeparatedGroupsFillTheSquareAndTheOtherWayRoundNothing) {
  EXPECT_DOUBLE_EQ(rocOf({5, 6}, {1, 2, 3}, false).area, 1.0);
  EXPECT_DOUBLE_EQ(rocOf({5, 6}, {1, 2, 3}, true).area, 0.0);
  const RocCurve tied = rocOf({4, 4}, {4, 4, 4}, false);
  EXPECT_DOUBLE_EQ(tied.area, 0.5);
  EXPECT_EQ(tied.points.size(), 2U) << "one slanted line";
}

// The area is Vargha and Delaney's A, computed elsewhere from ranks.
TEST(Roc, AreaIsTheProbabilityOfSuperiority) {
  const auto seed = std::random_device{}();
  std::cout << "seed " << seed << '\n';
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> size(1, 12), score(0, 9);
  for (int round = 0; round < 300; ++round) {
    std::vector<double> first(static_cast<std::size_t>(size(random))), second(static_cast<std::size_t>(size(random)));
    for (double& v : first) v = score(random);
    for (double& v : second) v = score(random);
    const auto larger = analytics::superiority(first, second);
    if (!larger) continue;
    EXPECT_NEAR(rocOf(first, second, false).area, larger->a, 1e-12);
    EXPECT_NEAR(rocOf(first, second, true).area, 1.0 - larger->a, 1e-12);
    const RocCurve curve = rocOf(first, second, false);
    EXPECT_EQ(curve.points.back().falsePositive, 1.0);
    EXPECT_EQ(curve.points.back().truePositive, 1.0);
    for (std::size_t i = 1; i < curve.points.size(); ++i) {
      EXPECT_GE(curve.points[i].falsePositive, curve.points[i - 1].falsePositive);
      EXPECT_GE(curve.points[i].truePositive, curve.points[i - 1].truePositive);
    }
  }
}

TEST(StudyView, ARowsValuesAreItsBoxes) {
  analytics::Study study;
  study.groups = {"expert", "novice"};
  analytics::StudyRow row;
  row.unit = "mm";
  row.participants = {std::vector<std::string>{"a", "b", "c", "d", "e"}, {}};
  row.values = {std::vector<double>{5, 1, 4, 2, 3}, {}};
  const std::optional<analytics::Drawing> plot = analytics::boxPlotOf(study, row);
  ASSERT_TRUE(plot);
  ASSERT_EQ(plot->marks.size(), 5U) << "a group without values has no box";
  EXPECT_EQ(plot->marks.front().key, "b") << "the smallest";
  EXPECT_EQ(plot->marks.front().text, "expert: 1 mm\nb");
  const auto count = [&](analytics::Ink ink) {
    return std::count_if(plot->shapes.begin(), plot->shapes.end(), [&](const auto& shape) { return shape.ink == ink; });
  };
  EXPECT_EQ(count(analytics::Ink::firstBox), 1);
  EXPECT_EQ(count(analytics::Ink::secondBox), 0);
  EXPECT_EQ(count(analytics::Ink::watermark), 0);
}

TEST(StudyView, ARefusalIsOneLine) {
  std::string refusal;
  try {
    (void)studyOf("/nowhere/c.db", {});
  } catch (const Error& error) {
    refusal = error.what();
  }
  EXPECT_NE(refusal.find("c.db"), std::string::npos);
  EXPECT_EQ(refusal.find('\n'), std::string::npos);
}

TEST(StudyView, RegistrationIsSaidInOneLine) {
  analytics::Study study;
  const std::string without = registrationText(study);
  analytics::StudyProtocol& p = study.protocol.emplace();
  p.name = "table2";
  p.version = 3;
  p.registeredUtc = "2026-01-01T00:00:00Z";
  p.firstAttemptUtc = "2026-02-01T00:00:00Z";
  const std::string confirmatory = registrationText(study);
  expectNames(confirmatory, {"Confirmatory", "table2 version 3", "2026-01-"});
  p.whyExploratory = "the protocol was registered on a later day";
  const std::string open = registrationText(study);
  expectNames(open, {"Exploratory", "table2 version 3", p.whyExploratory});
  p.masked = true;
  expectNames(registrationText(study), {"masked"});
  expectDistinct({without, confirmatory, open, registrationText(study)});
  p.masked = false;
  p.lock = analytics::StudyLock{"2026-03-01T00:00:00Z", "A. Analyst", {"data"}};
  expectNames(registrationText(study), {"2026-03-01T00:00:00Z", "A. Analyst", "data"});
}

TEST(StudyView, TextsAreEscaped) {
  analytics::Study study;
  study.groups = {"<b>x</b>", "y"};
  study.remarks = {"a < b & c"};
  const std::string html = studyText(study);
  EXPECT_EQ(html.find("<b>x</b>"), std::string::npos);
  EXPECT_NE(html.find("&lt;b&gt;x"), std::string::npos);
}

}  // namespace
}  // namespace calot::gui
