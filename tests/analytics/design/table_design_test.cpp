// SPDX-License-Identifier: GPL-3.0-or-later
// Designs of a table, from its text to the results.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

#include "analytics/report/report_document.h"
#include "tests/analytics/design/support/asked.h"
#include "tests/support/fault.h"

namespace calot::analytics {
namespace {

using support::asked;
using support::Asked;
using support::reportOf;

/// R's PlantGrowth, a row a plant.
std::string plants() {
  const std::vector<std::pair<std::string, std::vector<double>>> groups{
      {"ctrl", {4.17, 5.58, 5.18, 6.11, 4.5, 4.61, 5.17, 4.53, 5.33, 5.14}},
      {"trt1", {4.81, 4.17, 4.41, 3.59, 5.87, 3.83, 6.03, 4.89, 4.32, 4.69}},
      {"trt2", {6.31, 5.12, 5.54, 5.5, 5.37, 5.29, 4.92, 6.15, 5.8, 5.26}}};
  std::ostringstream text;
  text << "id,group,site,weight\n";
  int id = 0;
  for (const auto& [group, values] : groups) {
    for (const double v : values) {
      ++id;
      text << 'P' << id << ',' << group << ',' << (id % 2 == 0 ? "north" : "south") << ',' << v << '\n';
    }
  }
  return text.str();
}

TEST(TableDesign, severalGroupsOfR) {
  // R 4.2.2: kruskal.test(weight ~ group, PlantGrowth); epsilon squared H / 29; Dunn as in its own test.
  const DesignReport report = reportOf(plants(), asked(Design::severalGroups, {"weight"}));
  const auto& row = report.json["results"][0];
  EXPECT_NEAR(row["kruskal_wallis"]["h"].get<double>(), 7.988228749443715, 1e-12);
  EXPECT_NEAR(row["kruskal_wallis"]["p"].get<double>(), 0.018423755731472, 1e-14);
  EXPECT_NEAR(row["kruskal_wallis"]["epsilon_squared"].get<double>(), 7.988228749443715 / 29.0, 1e-13);
  EXPECT_NEAR(row["dunn"][2]["p_holm"].get<double>(), 0.0150008711107731, 1e-13);
  EXPECT_EQ(row["dunn"][2]["first"], "trt1");
  EXPECT_NEAR(row["groups"][1]["median"].get<double>(), 4.55, 1e-12);
  Asked two = asked(Design::severalGroups, {"weight"});
  two.choices.groups = {"ctrl", "trt1"};
  expectFault(ErrorKind::refused, "", {"\"groups\"", "2", "ctrl, trt1"}, [&] { (void)reportOf(plants(), two); });
}

TEST(TableDesign, strataAreColumns) {
  Asked a = asked(Design::strata, {"weight"});
  a.choices.groups = {"trt2", "trt1"};
  a.choices.strata = "site";
  const auto json = reportOf(plants(), a).json;
  EXPECT_EQ(json["strata"], (std::vector<std::string>{"north", "south"}));
  EXPECT_EQ(json["results"][0]["strata"], 2);
  EXPECT_EQ(json["flow"]["left_out"][0]["count"], 10);
  // R 4.2.2: van Elteren by hand: T = sum of (W - n1 (N + 1) / 2) / (N + 1) over strata, variance n1 n2 / (12 (N + 1)).
  EXPECT_NEAR(json["results"][0]["z"].get<double>(), 2.51106641597839, 1e-12);
  a.choices.strata = "town";
  expectFault(ErrorKind::invalid, "", {"\"town\""}, [&] { (void)reportOf(plants(), a); });
}

/// Two people a group, three attempts each, and one who made a single attempt.
const char* const attempts =
    "id,group,try,seconds,score\n"
    "A,x,1,90,1\nA,x,2,60,2\nA,x,3,50,4\nB,x,1,80,2\nB,x,2,70,3\nB,x,3,40,5\n"
    "C,y,1,120,1\nC,y,2,110,1\nC,y,3,95,2\nD,y,1,100,2\nD,y,2,100,3\nD,y,3,90,3\nE,y,1,130,1\n";

TEST(TableDesign, repeatedAttemptsOfR) {
  // R 4.2.2: slopes of lm(seconds ~ try) of each id: A -20, B -20, C -12.5, D -5; wilcox.test of two and two.
  Asked a = asked(Design::repeated, {"seconds:lower"});
  a.options.occasionColumns = {"try"};
  const auto json = reportOf(attempts, a).json;
  EXPECT_EQ(json["results"][0]["attempts"], 13);
  const auto& change = json["changes"][0];
  EXPECT_EQ(change["of"], "each try");
  EXPECT_EQ(change["groups"][1]["n"], 2) << "E made one attempt";
  EXPECT_DOUBLE_EQ(change["groups"][1]["median"].get<double>(), -8.75);
  EXPECT_DOUBLE_EQ(change["shift"].get<double>(), -11.25);
  EXPECT_DOUBLE_EQ(change["a"].get<double>(), 0.0);
  EXPECT_DOUBLE_EQ(change["p"].get<double>(), 1.0 / 3.0);
  EXPECT_DOUBLE_EQ(change["p_holm"].get<double>(), 1.0 / 3.0);
  // Of other designs the participants' several rows are refused until a rule is declared.
  Asked one = asked(Design::correlation, {"seconds:lower", "score:higher"});
  one.choices.against = "score";
  expectFault(
      ErrorKind::refused, "", {"3"}, [&] { (void)reportOf(attempts, one); },
      std::vector<Remedy>{Remedy::chooseOccasion, Remedy::chooseAttemptRule});
  one.choices.attemptRule = AttemptRule::mean;
  EXPECT_EQ(reportOf(attempts, one).json["results"][0]["n"], 5);
}

TEST(TableDesign, learningToACriterion) {
  Asked a = asked(Design::learning, {"seconds:lower"});
  a.options.occasionColumns = {"try"};
  a.choices.criterion = 60.0;
  const DesignReport report = reportOf(attempts, a);
  const auto& reached = report.json["to_criterion"]["groups"];
  EXPECT_EQ(reached[0]["reached"], 2);  // A at the second attempt, B at the third
  EXPECT_NEAR(reached[0]["median"].get<double>(), 2.5, 1e-12);
  EXPECT_EQ(reached[1]["reached"], 0);
  EXPECT_EQ(report.drawings.size(), 1U);
  // The curve through the means 85, 65, 45 and, of y, 116.67, 105, 92.5.
  EXPECT_NEAR(report.json["curves"][0]["mean"][1].get<double>(), 65.0, 1e-12);
  EXPECT_NEAR(report.json["curves"][1]["mean"][0].get<double>(), 350.0 / 3.0, 1e-12);
  Asked both = asked(Design::learning, {"seconds:lower", "score"});
  both.choices.criterion = 60.0;
  expectFault(ErrorKind::invalid, "", {"2"}, [&] { (void)reportOf(attempts, both); });
  Asked blind = asked(Design::learning, {"seconds"});
  blind.choices.criterion = 60.0;
  expectFault(ErrorKind::refused, "", {"seconds"}, [&] { (void)reportOf(attempts, blind); });
}

TEST(TableDesign, timesOfWhichSomeAreNotFinished) {
  // survival 3.5-3 on R 4.2.2: survdiff(Surv(time, status) ~ x, aml): $chisq and p.
  std::string text = "id,group,time,done\n";
  const std::vector<std::pair<int, int>> kept{{9, 1},  {13, 1}, {13, 0}, {18, 1}, {23, 1}, {28, 0},
                                              {31, 1}, {34, 1}, {45, 0}, {48, 1}, {161, 0}};
  const std::vector<std::pair<int, int>> others{{5, 1},  {5, 1},  {8, 1},  {8, 1},  {12, 1}, {16, 0},
                                                {23, 1}, {27, 1}, {30, 1}, {33, 1}, {43, 1}, {45, 1}};
  int id = 0;
  for (const auto& [time, done] : kept) text += fmt::format("K{},kept,{},{}\n", ++id, time, done);
  for (const auto& [time, done] : others) text += fmt::format("O{},other,{},{}\n", ++id, time, done);
  Asked a = asked(Design::timeToCriterion, {"time:lower"});
  a.choices.finishedColumn = "done";
  const auto json = reportOf(text, a).json;
  const double z = json["results"][0]["log_rank"]["z"].get<double>();
  EXPECT_NEAR(z * z, 3.3963886989776, 1e-11);
  EXPECT_NEAR(json["results"][0]["log_rank"]["p"].get<double>(), 0.0653393220405052, 1e-13);
  EXPECT_EQ(json["results"][0]["groups"][0]["median"], 31.0);
  EXPECT_TRUE(json["results"][0]["groups"][0]["upper"].is_null());
  text.replace(text.rfind(",1\n"), 3, ",maybe\n");
  expectFault(ErrorKind::damaged, "", {"line 24"}, [&] { (void)reportOf(text, a); });
}

/// Peak flow by two meters (Bland and Altman 1986), a row a person and a meter.
std::string meters() {
  const std::vector<int> large{494, 395, 516, 434, 476, 557, 413, 442, 650, 433, 417, 656, 267, 478, 178, 423, 427};
  const std::vector<int> mini{512, 430, 520, 428, 500, 600, 364, 380, 658, 445, 432, 626, 260, 477, 259, 350, 451};
  std::string text = "id,meter,flow\n";
  for (std::size_t i = 0; i < large.size(); ++i) {
    text += fmt::format("P{},large,{}\n", i, large[i]);
    text += fmt::format("P{},mini,{}\n", i, mini[i]);
  }
  return text;
}

TEST(TableDesign, agreementOfTwoDevices) {
  Asked a = asked(Design::agreement, {"flow"});
  a.options.groupColumn.clear();
  a.options.occasionColumns = {"meter"};
  const DesignReport report = reportOf(meters(), a);
  const auto& row = report.json["results"][0];
  EXPECT_NEAR(row["bias"].get<double>(), -2.11764705882353, 1e-12);
  EXPECT_NEAR(row["upper_limit_interval"]["upper"].get<double>(), 108.616259021664, 1e-10);
  EXPECT_NEAR(row["deming"]["slope"].get<double>(), 0.970880819764939, 1e-12);
  EXPECT_EQ(report.drawings.size(), 1U);
  const std::string page = pageHtml(designDocument(report));
  EXPECT_NE(page.find("<svg"), std::string::npos);
  // A third reading is a second pair of the same person.
  expectFault(ErrorKind::refused, "", {"line 36"}, [&] { (void)reportOf(meters() + "P0,mini,500\n", a); });
  expectFault(ErrorKind::refused, "", {"3"}, [&] { (void)reportOf(meters() + "P0,other,500\n", a); });
}

TEST(TableDesign, reliabilityOverRaters) {
  // Shrout and Fleiss' six people by four raters.
  const std::vector<std::vector<int>> scores{{9, 2, 5, 8}, {6, 1, 3, 2},  {8, 4, 6, 8},
                                             {7, 1, 2, 6}, {10, 5, 6, 9}, {6, 2, 4, 7}};
  std::string text = "id,rater,score\n";
  for (std::size_t i = 0; i < scores.size(); ++i) {
    for (std::size_t r = 0; r < 4; ++r) text += fmt::format("P{},R{},{}\n", i, r, scores[i][r]);
  }
  text += "P9,R0,5\n";
  Asked a = asked(Design::reliability, {"score"});
  a.options.groupColumn.clear();
  a.options.occasionColumns = {"rater"};
  const auto json = reportOf(text, a).json;
  const auto& row = json["components"][0];
  EXPECT_EQ(row["left_out"], 1);
  EXPECT_NEAR(row["person_variance"].get<double>(), 2.55555555555556, 1e-13);
  EXPECT_NEAR(row["decisions"][3]["g"].get<double>(), 0.909315542377069, 1e-13);
  EXPECT_NEAR(row["decisions"][3]["phi"].get<double>(), 0.620050547598989, 1e-13);
  EXPECT_NEAR(row["decisions"][1]["absolute_error"].get<double>(), 1.76973004846627, 1e-13);
  EXPECT_EQ(json["measurement_error"][0]["people"], 6);
  expectFault(ErrorKind::refused, "", {"\"P9\"", "score", "R0"}, [&] { (void)reportOf(text + "P9,R0,4\n", a); });
}

TEST(TableDesign, sharesWithinGroups) {
  // Four people in two groups at two levels: means of people 0, 2 and 10, 12; level b is 1 more, in group y 3 more; and
  // one person of each group goes 1 further.
  Asked a = asked(Design::reliability, {"score"});
  a.options.occasionColumns = {"level"};
  const auto json =
      reportOf("id,group,level,score\nA,x,a,0\nA,x,b,1\nB,x,a,2\nB,x,b,4\nC,y,a,10\nC,y,b,13\nD,y,a,12\nD,y,b,16\n", a)
          .json;
  ASSERT_EQ(json["shares"].size(), 1U);
  const auto& nested = json["components"][1];
  EXPECT_EQ(nested["of"], "within groups");
  // By hand: S 6.25, R 2.25 and 12.25, E 0.25; levels' means over both groups differ by 2.5, groups' means by 11.
  EXPECT_NEAR(nested["person_variance"].get<double>(), 3.0, 1e-12);
  EXPECT_NEAR(nested["facet_variance"].get<double>(), 3.5, 1e-12);
  EXPECT_NEAR(nested["residual_variance"].get<double>(), 0.25, 1e-12);
  EXPECT_NEAR(nested["common_variance"].get<double>(), 3.125 - 0.0625, 1e-12);
  EXPECT_NEAR(nested["interaction_variance"].get<double>(), 0.4375, 1e-12);
  EXPECT_NEAR(nested["group_variance"].get<double>(), 0.5 * (60.5 - 1.5625) - 0.21875, 1e-12);
  const auto& shares = json["shares"][0];
  EXPECT_NEAR(shares["level"]["share"].get<double>(), 3.75 / 6.75, 1e-12);
  EXPECT_NEAR(shares["residual"]["share"].get<double>(), 0.25 / 6.75, 1e-12);
  EXPECT_EQ(shares["level"]["interval"]["method"], "percentile bootstrap");
}

TEST(TableDesign, correlationAgainstAColumn) {
  Asked a = asked(Design::correlation, {"seconds"});
  a.choices.against = "score:higher";
  a.choices.attemptRule = AttemptRule::mean;
  const auto json = reportOf(attempts, a).json;
  EXPECT_EQ(json["against"], "score");
  // Means 66.7, 63.3, 108.3, 96.7, 130 and 2.33, 3.33, 1.33, 2.67, 1.
  EXPECT_NEAR(json["results"][0]["rho"].get<double>(), -0.9, 1e-12);
  a.choices.against = "speed";
  expectFault(ErrorKind::invalid, "", {"\"speed\""}, [&] { (void)reportOf(attempts, a); });
}

TEST(TableDesign, textAndPageHoldTheSameFigures) {
  const DesignReport report = reportOf(plants(), asked(Design::severalGroups, {"weight"}));
  std::ostringstream out;
  printDesign(report, out);
  const std::string page = pageHtml(designDocument(report));
  for (const std::string word : {"7.988", "0.0184", "0.275", "4.550 [4.207, 4.870]"}) {
    EXPECT_NE(out.str().find(word), std::string::npos) << word;
    EXPECT_NE(page.find(word), std::string::npos) << word;
  }
}

}  // namespace
}  // namespace calot::analytics
