// SPDX-License-Identifier: GPL-3.0-or-later
// How a design reads a cohort: who is in it, in which group, site and occasion, and with which values.
#include <gtest/gtest.h>

#include <map>

#include "analytics/design/design_data.h"
#include "tests/analytics/cohort/support/cohort_support.h"
#include "tests/support/fault.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

using support::humanAttempt;

DesignChoices choicesOf(Design design) {
  DesignChoices choices;
  choices.design = design;
  return choices;
}

/// Six people of three groups and two sites; the first has three attempts, the last stopped after 40 s.
class CohortDesign : public testing::Test {
 protected:
  CohortDesign() : cohort_(folder_.file("c.db"), CohortDatabase::Access::create) {
    const char* groups[] = {"expert", "expert", "novice", "novice", "student", "student"};
    for (unsigned i = 0; i < 6; ++i) {
      const std::string who = fmt::format("P{}", i);
      cohort_.addParticipant({who, groups[i], "", i % 2 == 0 ? "north" : "south", {}, {}});
      add(i, who, 100.0 + i, recorder::Outcome::completed);
    }
    add(21, "P0", 81.0, recorder::Outcome::completed);
    add(11, "P0", 91.0, recorder::Outcome::completed);
    add(31, "P5", 40.0, recorder::Outcome::abandoned);
  }

  void add(unsigned n, const std::string& who, double seconds, recorder::Outcome outcome) {
    AttemptRecord a = humanAttempt(n, who);
    a.outcome = outcome;
    a.steps = static_cast<std::uint64_t>(seconds * 100.0);
    a.stepSeconds = 0.01;
    std::vector<CheckpointValue> values = support::valuesOf(seconds, seconds / 100.0);
    values[0] = support::elapsedTime(seconds, outcome);
    cohort_.storeAttempt(a, values);
  }

  DesignData read(const DesignChoices& choices) {
    return cohortDesignData(cohort_.listAttempts(), cohort_.allValues(), options_, choices, "c.db");
  }

  support::Folder folder_;
  CohortDatabase cohort_;
  StudyOptions options_;
};

const DesignFigure& figureOf(const DesignData& data, const std::string& name) {
  for (const DesignFigure& f : data.figures) {
    if (f.name == name) return f;
  }
  ADD_FAILURE() << "no figure " << name;
  return data.figures.at(0);
}

TEST_F(CohortDesign, occasionsAreNumberedByStart) {
  DesignChoices choices = choicesOf(Design::learning);
  const DesignData data = read(choices);
  EXPECT_EQ(data.occasionWord, "attempt");
  EXPECT_EQ(data.occasions, (std::vector<std::string>{"1", "2", "3"}));
  EXPECT_EQ(data.people.size(), 6U);
  const DesignFigure& left = figureOf(data, "path-length left");
  std::vector<double> first;
  for (const DesignValue& v : left.values) {
    if (data.people.at(v.person).name != "P0") continue;
    EXPECT_EQ(v.order, static_cast<double>(v.occasion) + 1.0);
    first.push_back(v.value);
  }
  // Started at 0, 11 and 21 s, stored in another order; metres are shown in centimetres or so: ratios are free of it.
  ASSERT_EQ(first.size(), 3U);
  EXPECT_NEAR(first[1] / first[0], 91.0 / 100.0, 1e-12);
  EXPECT_NEAR(first[2] / first[0], 81.0 / 100.0, 1e-12);
}

TEST_F(CohortDesign, oneEachWantsARule) {
  DesignChoices choices = choicesOf(Design::severalGroups);
  expectFault(ErrorKind::refused, "", {"\"P0\"", "3"}, [&] { (void)read(choices); }, {Remedy::chooseAttemptRule});
  choices.attemptRule = AttemptRule::first;
  const DesignData data = read(choices);
  EXPECT_EQ(data.groups.size(), 3U);
  for (const DesignFigure& f : data.figures) EXPECT_LE(f.values.size(), 6U) << f.name;
  expectNames(data.attemptRule, {"first"});
  std::map<std::string, std::size_t> group;
  for (const DesignPerson& p : data.people) group[p.name] = p.group;
  EXPECT_EQ(group["P0"], group["P1"]);
  EXPECT_EQ(group["P2"], group["P3"]);
  EXPECT_NE(group["P0"], group["P2"]);
  EXPECT_NE(group["P2"], group["P4"]);
}

TEST_F(CohortDesign, sitesAreStrata) {
  DesignChoices choices = choicesOf(Design::strata);
  choices.strata = std::string("site");
  choices.groups = {"expert", "novice"};
  choices.attemptRule = AttemptRule::first;
  const DesignData data = read(choices);
  EXPECT_EQ(data.strata, (std::vector<std::string>{"north", "south"}));
  ASSERT_EQ(data.people.size(), 4U) << "students are of another group";
  for (const DesignPerson& p : data.people)
    EXPECT_EQ(data.strata.at(p.stratum), p.name == "P0" || p.name == "P2" ? "north" : "south");
  bool told = false;
  for (const FlowRow& row : data.flow) told = told || row.reason == "another group";
  EXPECT_TRUE(told) << "whoever is left out is counted";
}

TEST_F(CohortDesign, whoWasNotFinishedIsFollowedAsLongAsTheAttemptLasted) {
  DesignChoices choices = choicesOf(Design::timeToCriterion);
  choices.groups = {"novice", "student"};
  choices.attemptRule = AttemptRule::first;
  cohort_.excludeAttempts({support::uuidOf(5)}, "test", "me");  // P5's other one
  const DesignData data = read(choices);
  ASSERT_EQ(data.figures.size(), 1U);
  std::size_t unfinished = 0;
  for (const DesignValue& v : data.figures[0].values) {
    if (v.finished) continue;
    ++unfinished;
    EXPECT_NEAR(v.value, 40.0, 1e-9);
    EXPECT_EQ(data.people.at(v.person).name, "P5");
  }
  EXPECT_EQ(unfinished, 1U);
}

TEST_F(CohortDesign, valuesOfTwoVersionsAreNotMixedUnasked) {
  auto values = cohort_.values(support::uuidOf(1));
  for (CheckpointValue& v : values) v.version += 1;
  cohort_.storeValues(support::uuidOf(1), values);
  DesignChoices choices = choicesOf(Design::severalGroups);
  choices.attemptRule = AttemptRule::first;
  expectFault(ErrorKind::refused, "", {"2"}, [&] { (void)read(choices); });
  options_.mixKeys = true;
  EXPECT_FALSE(read(choices).remarks.empty());
}

}  // namespace
}  // namespace calot::analytics
