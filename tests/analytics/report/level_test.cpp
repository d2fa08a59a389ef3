// SPDX-License-Identifier: GPL-3.0-or-later
// What a study says where there is nothing, and where something was put: through the cohort database and the study's
// own code, over made numbers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "analytics/report/study.h"
#include "tests/analytics/cohort/support/cohort_support.h"

namespace calot::analytics {
namespace {

using support::Folder;
using support::humanAttempt;

constexpr double level = 0.05;

/// Figures of different kinds: one spread out like times, one a share, one a count with many ties.
const std::vector<std::pair<std::string, std::string>>& figures() {
  static const std::vector<std::pair<std::string, std::string>> list{
      {"elapsed-time", ""}, {"fat-remaining-outside", ""}, {"clip-errors", ""}};
  return list;
}

struct Person {
  double time = 0.0, spared = 0.0, clips = 0.0;
};

Person draw(std::mt19937& random) {
  std::normal_distribution<double> normal(0.0, 1.0);
  std::poisson_distribution<int> few(1.0);
  return {100.0 * std::exp(0.3 * normal(random)), 0.8 + 0.05 * normal(random), static_cast<double>(few(random))};
}

/// A cohort of people without groups, as the database holds it.
struct Cohort {
  std::vector<AttemptRow> attempts;
  std::vector<AttemptValue> values;
};

Cohort stored(const std::vector<Person>& people) {
  const Folder folder;
  CohortDatabase database(folder.file("c.db"), CohortDatabase::Access::create);
  for (std::size_t i = 0; i < people.size(); ++i) {
    const auto value = [](const char* name, double v) {
      return makeValue(*findCheckpoint(name), "", Origin::resimulated, v);
    };
    database.storeAttempt(humanAttempt(static_cast<unsigned>(i), fmt::format("P{:02}", i)),
                          {value("elapsed-time", people[i].time), value("fat-remaining-outside", people[i].spared),
                           value("clip-errors", people[i].clips)});
  }
  return {database.listAttempts(), database.allValues()};
}

/// The same cohort with the figures of other people.
Cohort withFigures(Cohort cohort, const std::vector<Person>& people) {
  for (std::size_t i = 0; i < people.size(); ++i) {
    for (AttemptValue& item : cohort.values) {
      if (item.attempt != support::uuidOf(static_cast<unsigned>(i))) continue;
      const std::string& name = item.value.name;
      item.value.value = name == "elapsed-time"  ? people[i].time
                         : name == "clip-errors" ? people[i].clips
                                                 : people[i].spared;
    }
  }
  return cohort;
}

/// Study of the cohort with `inA[i]` saying who is in group a.
Study studyOf(const Cohort& cohort, const std::vector<bool>& inA) {
  std::vector<AttemptRow> attempts = cohort.attempts;
  for (std::size_t i = 0; i < attempts.size(); ++i) attempts[i].group = std::string(1, inA[i] ? 'a' : 'b');
  return makeStudy(attempts, cohort.values, {}, "cohort");
}

unsigned seedOf() {
  const char* given = std::getenv("CALOT_SEED");
  return given != nullptr ? static_cast<unsigned>(std::strtoul(given, nullptr, 10)) : 20261121U;
}

/// How often each figure is significant.
void count(const Study& study, std::map<std::string, int>& rejected) {
  for (const StudyRow& row : study.rows) {
    if (row.test && row.test->p <= level) ++rejected[row.checkpoint];
  }
}

TEST(Level, everySplitOfOnePopulationRejectsAtTheExactTestsLevel) {
  // All 924 ways to make two groups of six out of twelve. Without ties U has 19 of them in each tail up to U = 5, so
  // the test rejects in 38: its attained level is 4.1 %, and not one split more.
  const unsigned seed = seedOf();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  std::vector<Person> people(12);
  for (Person& p : people) p = draw(random);
  const Cohort cohort = stored(people);
  std::map<std::string, int> rejected;
  std::vector<bool> inA(12, false);
  std::fill(inA.end() - 6, inA.end(), true);
  int splits = 0;
  do {
    const Study study = studyOf(cohort, inA);
    ASSERT_EQ(study.rows.size(), figures().size());
    count(study, rejected);
    ++splits;
  } while (std::next_permutation(inA.begin(), inA.end()));
  EXPECT_EQ(splits, 924);
  EXPECT_EQ(rejected["elapsed-time"], 38);
  EXPECT_EQ(rejected["fat-remaining-outside"], 38);
  EXPECT_LE(rejected["clip-errors"], level * splits) << "ties only make it rarer";
}

TEST(Level, aThousandSplitsRejectNoOftenerThanTheExactTest) {
  // Ten against ten: the attained level is .04326 (p of U = 23). A thousand splits of one population reject a binomial
  // number of times; 3.1 standard deviations above leave one seed in a thousand.
  const unsigned seed = seedOf() + 1;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  std::vector<Person> people(20);
  for (Person& p : people) p = draw(random);
  const Cohort cohort = stored(people);
  const double attained = 0.0432570525;
  const double most = 1000.0 * attained + 3.1 * std::sqrt(1000.0 * attained * (1.0 - attained));
  std::map<std::string, int> rejected;
  std::vector<bool> inA(20, false);
  std::fill(inA.begin(), inA.begin() + 10, true);
  for (int split = 0; split < 1000; ++split) {
    std::shuffle(inA.begin(), inA.end(), random);
    count(studyOf(cohort, inA), rejected);
  }
  for (const auto& [name, subject] : figures()) {
    RecordProperty(name, rejected[name]);
    EXPECT_LE(rejected[name], most) << name;
  }
  EXPECT_GT(rejected["elapsed-time"], 0) << "a test that never rejects would pass as well";
}

TEST(Effect, thatWasPlantedIsRecoveredAndNoOther) {
  // A hundred cohorts of fifteen against fifteen. Group b takes 60 s longer, two standard deviations; nothing else
  // differs.
  const unsigned seed = seedOf() + 2;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  const double planted = 60.0;
  std::map<std::string, int> rejected;
  int covered = 0;
  double shift = 0.0;
  const Cohort cohort = stored(std::vector<Person>(30));
  for (int cohortNumber = 0; cohortNumber < 100; ++cohortNumber) {
    std::vector<bool> inA(30);
    std::vector<Person> people(30);
    for (std::size_t i = 0; i < people.size(); ++i) {
      inA[i] = i % 2 == 0;
      people[i] = draw(random);
      if (!inA[i]) people[i].time += planted;
    }
    const Study study = studyOf(withFigures(cohort, people), inA);
    count(study, rejected);
    const StudyRow& time = study.rows.front();
    ASSERT_EQ(time.checkpoint, "elapsed-time");
    EXPECT_EQ(study.groups[0], "a");
    EXPECT_LT(time.effect->delta, 0.0) << "b is the slower one";
    shift += *time.shift / 100.0;
    if (time.shiftInterval->lower <= -planted && -planted <= time.shiftInterval->upper) ++covered;
  }
  EXPECT_GE(rejected["elapsed-time"], 95);
  EXPECT_NEAR(shift, -planted, 5.0);
  EXPECT_GE(covered, 89) << "of 100 intervals at 95 %";
  EXPECT_LE(rejected["fat-remaining-outside"], 13) << "5 % of 100, and chance";
  EXPECT_LE(rejected["clip-errors"], 13);
}

}  // namespace
}  // namespace calot::analytics
