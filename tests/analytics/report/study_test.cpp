// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/study.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <clocale>
#include <cmath>
#include <fstream>
#include <locale>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>

#include "analytics/cohort/embedded.h"
#include "analytics/cohort/registers.h"
#include "analytics/report/report_document.h"
#include "analytics/report/study_output.h"
#include "recorder/base/errors.h"
#include "tests/analytics/cohort/support/cohort_support.h"
#include "tests/analytics/report/support/study_support.h"
#include "tests/support/fault.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

using Access = CohortDatabase::Access;
using support::addPerformers;
using support::attemptOf;
using support::Folder;
using support::humanAttempt;
using support::performers;
using support::rowOf;
using support::textOf;
using support::uuidOf;
using support::valuesOf;

TEST(Study, comparesPerformersAndWatermarksThem) {
  const Folder folder;
  CohortDatabase database(folder.file("c.db"), Access::create);
  addPerformers(database);
  const Study study = makeStudy(database, performers);
  EXPECT_EQ(study.heading, "exploratory");
  EXPECT_TRUE(study.synthetic);
  EXPECT_EQ(study.groups[0], "skilled");
  EXPECT_EQ(study.groups[1], "unskilled");
  EXPECT_EQ(study.analysed, 9U);
  const StudyRow& time = rowOf(study, "elapsed-time", "");
  EXPECT_EQ(time.group[0].n, 5U);
  EXPECT_DOUBLE_EQ(*time.group[0].mean, 22.0);
  EXPECT_DOUBLE_EQ(*time.group[0].median, 22.0);
  EXPECT_DOUBLE_EQ(*time.group[1].mean, 15.0);
  EXPECT_DOUBLE_EQ(*time.group[1].median, 14.5);
  EXPECT_DOUBLE_EQ(*time.group[1].lowerQuartile, 11.75);
  EXPECT_DOUBLE_EQ(time.test->u, 17.0);
  EXPECT_TRUE(time.test->exact);
  EXPECT_NEAR(time.test->p, 1.0 / 9.0, 1e-15);
  EXPECT_DOUBLE_EQ(time.effect->delta, 0.7);
  EXPECT_FALSE(time.publishedExpert) << "of another task";
  const StudyRow& left = rowOf(study, "path-length", "left");
  EXPECT_EQ(left.unit, "mm");
  EXPECT_DOUBLE_EQ(*left.group[0].median, 22.0) << "stored in m, shown in mm";
  const StudyRow& right = rowOf(study, "path-length", "right");
  EXPECT_FALSE(right.test);
  expectNames(right.test.reason(), {"groups"});
  EXPECT_EQ(right.group[0].missing, 5U);
  const std::string text = textOf(study);
  EXPECT_EQ(text.rfind("SYNTHETIC", 0), 0U) << "the watermark comes first";
  EXPECT_NE(text.find("exploratory"), std::string::npos);
  EXPECT_EQ(study.better, "skilled");
  EXPECT_NEAR(time.area->value.a, 0.15, 1e-12) << "shorter was expected, and longer it is";
  EXPECT_EQ(time.asHypothesised, false);
  EXPECT_NE(text.find("0.150"), std::string::npos);
  expectHolds(text, {"instrument"});
  EXPECT_EQ(text.find("nan"), std::string::npos);
}

TEST(Study, saysHowFarItIsAndCanBeBrokenOff) {
  const Folder folder;
  CohortDatabase database(folder.file("c.db"), Access::create);
  addPerformers(database);
  std::vector<double> shares;
  std::set<std::string> doing;
  const Study watched = makeStudy(database, performers, [&](double share, const char* what) {
    shares.push_back(share);
    doing.insert(what);
  });
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  ASSERT_FALSE(shares.empty());
  EXPECT_GT(shares.front(), 0.0);
  EXPECT_LT(shares.back(), 1.0);
  EXPECT_EQ(doing, (std::set<std::string>{"comparing groups", "reading values"}));
  EXPECT_GE(shares.size(), watched.recruited + watched.rows.size()) << "each attempt and each row are told of";
  EXPECT_EQ(textOf(watched), textOf(makeStudy(database, performers))) << "to watch changes nothing";

  struct Enough {};
  int calls = 0;
  const auto breakOff = [&](double, const char*) {
    if (++calls == 3) throw Enough{};
  };
  EXPECT_THROW((void)makeStudy(database, performers, breakOff), Enough);
  EXPECT_EQ(calls, 3) << "nothing is done after that";
}

TEST(Study, syntheticAttemptsStayOutUnlessAskedFor) {
  const Folder folder;
  CohortDatabase database(folder.file("c.db"), Access::create);
  addPerformers(database);
  StudyOptions options = performers;
  options.includeSynthetic = false;
  expectFault(ErrorKind::refused, "", {"9", "synthetic"}, [&] { (void)makeStudy(database, options); });
}

TEST(Study, countsWhyAttemptsStayOut) {
  const Folder folder;
  CohortDatabase database(folder.file("c.db"), Access::create);
  addPerformers(database);
  const auto add = [&](unsigned n, auto change) {
    AttemptRecord a = attemptOf(n, "skilled");
    change(a);
    database.storeAttempt(a, valuesOf(1000, 1000));
  };
  add(20, [](AttemptRecord& a) { a.mode = recorder::Mode::practice; });
  add(21, [](AttemptRecord& a) { a.mode = recorder::Mode::practice; });
  add(22, [](AttemptRecord& a) { a.parent = uuidOf(0); });
  add(23, [](AttemptRecord& a) { a.complete = false; });
  add(24, [](AttemptRecord& a) { a.outcome = recorder::Outcome::technicalFailure; });
  add(25, [](AttemptRecord& a) { a.verification.verdict = Verdict::diverged; });
  add(26, [](AttemptRecord& a) { a.verification.verdict = Verdict::notChecked; });
  add(27, [](AttemptRecord& a) { a.purpose = "golden"; });
  add(28, [](AttemptRecord& a) { a.profile.clear(); });
  add(29, [](AttemptRecord&) {});
  database.excludeAttempts({uuidOf(29)}, "fire alarm", "instructor");
  const Study study = makeStudy(database, performers);
  EXPECT_EQ(study.recruited, 19U);
  EXPECT_EQ(study.analysed, 9U);
  const char* const reasons[] = {"fire alarm (instructor)",
                                 "diverged",
                                 "verified",
                                 "incomplete",
                                 "failure",
                                 "practice",
                                 "branch",
                                 "golden",
                                 "group"};
  ASSERT_EQ(study.flow.size(), std::size(reasons));
  std::uint64_t out = 0;
  for (std::size_t i = 0; i < study.flow.size(); ++i) {
    expectNames(study.flow[i].reason, {reasons[i]});
    EXPECT_EQ(study.flow[i].attempts, i == 5 ? 2U : 1U) << reasons[i];
    out += study.flow[i].attempts;
  }
  EXPECT_EQ(out + study.analysed, study.recruited);
  EXPECT_DOUBLE_EQ(*rowOf(study, "elapsed-time", "").group[0].mean, 22.0);
  StudyOptions withPractice = performers;
  withPractice.includePractice = true;
  EXPECT_EQ(makeStudy(database, withPractice).analysed, 11U);
}

TEST(Study, takesOneValueAParticipant) {
  const Folder folder;
  CohortDatabase database(folder.file("c.db"), Access::create);
  for (const char* p : {"E1", "E2"}) database.addParticipant({p, "expert", "", "", {}, {}});
  for (const char* p : {"N1", "N2"}) database.addParticipant({p, "novice", "", "", {}, {}});
  database.storeAttempt(humanAttempt(1, "E1"), valuesOf(30, 0.06));
  database.storeAttempt(humanAttempt(2, "E1"), valuesOf(40, 0.08));
  AttemptRecord gaveUp = humanAttempt(3, "E1");
  gaveUp.outcome = recorder::Outcome::abandoned;
  auto values = valuesOf(0, 0.07);
  values[0] = makeMissing(*findCheckpoint("elapsed-time"), "", Origin::resimulated, Availability::notApplicable,
                          "not completed: abandoned");
  database.storeAttempt(gaveUp, values);
  database.storeAttempt(humanAttempt(4, "E2"), valuesOf(50, 0.05));
  database.storeAttempt(humanAttempt(5, "N1"), valuesOf(100, 0.1));
  database.storeAttempt(humanAttempt(6, "N2"), valuesOf(120, 0.2));
  expectFault(ErrorKind::refused, "", {"\"E1\"", "3", "1"}, [&] { (void)makeStudy(database, {}); });
  StudyOptions mean;
  mean.attemptRule = AttemptRule::mean;
  const Study study = makeStudy(database, mean);
  EXPECT_FALSE(study.synthetic);
  EXPECT_EQ(textOf(study).find("SYNTHETIC"), std::string::npos);
  EXPECT_EQ(study.groups[0], "expert");
  EXPECT_EQ(study.participants, (std::array<std::uint64_t, 2>{2, 2}));
  EXPECT_EQ(study.attempts, (std::array<std::uint64_t, 2>{4, 2}));
  const StudyRow& time = rowOf(study, "elapsed-time", "");
  EXPECT_EQ(time.values[0], (std::vector<double>{35.0, 50.0})) << "an abandoned attempt is not a fast one";
  EXPECT_EQ(time.participants[0], (std::vector<std::string>{"E1", "E2"}));
  EXPECT_EQ(time.group[0].missing, 0U);
  EXPECT_EQ(time.group[0].partial, 1U) << "and whose mean lacks it is said";
  expectHolds(textOf(study), {"1 of 2 expert"});
  EXPECT_NEAR(time.test->p, 1.0 / 3.0, 1e-15);
  StudyOptions first;
  first.attemptRule = AttemptRule::first;
  const Study firsts = makeStudy(database, first);
  EXPECT_EQ(rowOf(firsts, "elapsed-time", "").values[0], (std::vector<double>{30.0, 50.0}));
  EXPECT_EQ(firsts.analysed, 4U);
  ASSERT_EQ(firsts.flow.size(), 1U);
  expectNames(firsts.flow[0].reason, {"later"});
  EXPECT_EQ(firsts.flow[0].attempts, 2U);
}

TEST(Study, aFirstAttemptWithoutAValueIsNotReplacedByALaterOne) {
  const Folder folder;
  CohortDatabase database(folder.file("c.db"), Access::create);
  for (const char* p : {"E1", "E2"}) database.addParticipant({p, "expert", "", "", {}, {}});
  for (const char* p : {"N1", "N2"}) database.addParticipant({p, "novice", "", "", {}, {}});
  auto none = valuesOf(0, 0.07);
  none[0] = makeMissing(*findCheckpoint("elapsed-time"), "", Origin::resimulated, Availability::notApplicable,
                        "not completed: abandoned");
  database.storeAttempt(humanAttempt(1, "E1"), none);
  database.storeAttempt(humanAttempt(2, "E1"), valuesOf(40, 0.08));
  for (unsigned n = 3; n < 6; ++n) {
    const char* who[] = {"E2", "N1", "N2"};
    database.storeAttempt(humanAttempt(n, who[n - 3]), valuesOf(10.0 * n, 0.05));
  }
  StudyOptions first;
  first.attemptRule = AttemptRule::first;
  const Study study = makeStudy(database, first);
  const StudyRow& time = rowOf(study, "elapsed-time", "");
  EXPECT_EQ(time.values[0], (std::vector<double>{30.0}));
  EXPECT_EQ(time.group[0].missing, 1U);
  EXPECT_EQ(time.group[0].missingReason, "not completed: abandoned");
  AttemptRecord sameTime = humanAttempt(9, "N1");
  sameTime.startUtc = humanAttempt(4, "N1").startUtc;
  database.storeAttempt(sameTime, valuesOf(1, 1));
  expectFault(ErrorKind::refused, "", {"\"N1\""}, [&] { (void)makeStudy(database, first); });
}

TEST(Study, adjustsOverTheFamilyAndCorrelatesWithTheDuration) {
  const Folder folder;
  CohortDatabase database(folder.file("c.db"), Access::create);
  // Durations 1, 2, ... 8 in order; path lengths fall with them: rho is -1, exact p 2 / 8!.
  for (unsigned n = 0; n < 8; ++n) {
    const std::string person = fmt::format("P{}", n);
    database.addParticipant({person, n % 2 == 0 ? "expert" : "novice", "", "", {}, {}});
    auto values = valuesOf(5.0 + (n * 5) % 8, 8.0 - n);
    values.push_back(makeValue(*findCheckpoint("attempt-duration"), "", Origin::resimulated, 1.0 + n));
    database.storeAttempt(humanAttempt(n, person), values);
  }
  StudyOptions both;
  both.family = {"elapsed-time", "path-length"};
  const Study study = makeStudy(database, both), pilot = makeStudy(database, {});
  EXPECT_TRUE(std::none_of(pilot.rows.begin(), pilot.rows.end(), [](const StudyRow& row) { return row.holm; }))
      << "without a declared hypothesis nothing is tested";
  const std::string text = textOf(pilot);
  EXPECT_EQ(text.find("Holm"), std::string::npos);
  EXPECT_EQ(text.find(" p  "), std::string::npos) << text;
  const StudyRow& path = rowOf(study, "path-length", "left");
  ASSERT_TRUE(path.withDuration);
  EXPECT_DOUBLE_EQ(path.withDuration->rho, -1.0);
  EXPECT_NEAR(path.withDuration->p, 2.0 / 40320.0, 1e-15);
  EXPECT_EQ(path.withDurationPairs, 8U);
  expectNames(rowOf(study, "attempt-duration", "").test.reason(), {"elapsed time"});
  StudyOptions named;
  named.family = {"attempt-duration"};
  const Study withDuration = makeStudy(database, named);
  EXPECT_TRUE(rowOf(withDuration, "attempt-duration", "").holm) << "who names it has it tested";
  expectNames(rowOf(withDuration, "attempt-duration", "").withDuration.reason(), {"duration"});
  // Two tests (the right hand has none): Holm by hand.
  std::vector<double> p;
  for (const StudyRow& row : study.rows) {
    if (row.test) p.push_back(row.test->p);
  }
  ASSERT_EQ(p.size(), 2U);
  std::sort(p.begin(), p.end());
  const double a = std::min(1.0, 2 * p[0]), b = std::max(a, p[1]);
  std::vector<double> adjusted;
  for (const StudyRow& row : study.rows) {
    EXPECT_EQ(row.holm.has_value(), static_cast<bool>(row.test));
    if (row.holm) adjusted.push_back(*row.holm);
  }
  std::sort(adjusted.begin(), adjusted.end());
  EXPECT_EQ(adjusted, (std::vector<double>{a, b}));
  StudyOptions one;
  one.family = {"elapsed-time"};
  const Study narrower = makeStudy(database, one);
  EXPECT_DOUBLE_EQ(*rowOf(narrower, "elapsed-time", "").holm, rowOf(narrower, "elapsed-time", "").test->p);
  EXPECT_FALSE(rowOf(narrower, "path-length", "left").holm);
  expectNames(narrower.family, {"1", "elapsed-time"});
  one.family = {"elapsed"};
  expectFault(ErrorKind::invalid, "", {"\"elapsed\""}, [&] { (void)makeStudy(database, one); });
}

/// Figures of phases would quadruple the family of whoever did not ask for them.
TEST(Study, phasesAreInWhereTheyAreAskedFor) {
  const Folder folder;
  CohortDatabase database(folder.file("c.db"), Access::create);
  for (unsigned n = 0; n < 8; ++n) {
    const std::string person = fmt::format("P{}", n);
    database.addParticipant({person, n % 2 == 0 ? "expert" : "novice", "", "", {}, {}});
    auto values = valuesOf(5.0 + (n * 5) % 8, 8.0 - n);
    values.push_back(makeValue(*findCheckpoint("phase-duration"), "clipping", Origin::resimulated, 1.0 + n));
    for (const char* name : {"phase-sparc", "phase-force-p99"})
      values.push_back(makeValue(*findCheckpoint(name), "left clipping", Origin::resimulated, 2.0 + n % 3));
    database.storeAttempt(humanAttempt(n, person), values);
  }
  const auto rowsOf = [](const Study& study) {
    std::vector<std::string> names;
    for (const StudyRow& row : study.rows) {
      if (row.checkpoint.starts_with("phase-")) names.push_back(row.checkpoint);
    }
    return names;
  };
  const auto says = [](const Study& study) {
    const bool remark = std::any_of(study.remarks.begin(), study.remarks.end(),
                                    [](const std::string& r) { return holdsToken(r, "single phases"); });
    EXPECT_EQ(remark, study.phasesLeftOut);
    return remark;
  };
  const Study plain = makeStudy(database, {});
  EXPECT_EQ(rowsOf(plain), std::vector<std::string>{"phase-duration"});
  EXPECT_TRUE(says(plain));
  StudyOptions one;
  one.family = {"elapsed-time", "phase-sparc"};
  EXPECT_EQ(rowsOf(makeStudy(database, one)), (std::vector<std::string>{"phase-duration", "phase-sparc"}));
  StudyOptions all;
  all.includePhases = true;
  const Study every = makeStudy(database, all);
  EXPECT_EQ(rowsOf(every), (std::vector<std::string>{"phase-duration", "phase-sparc", "phase-force-p99"}));
  EXPECT_FALSE(says(every));
  // From the database or from values at hand.
  EXPECT_EQ(studyTree(makeStudy(database.listAttempts(), database.allValues(), withCohortData(database, {}),
                                database.path())),
            studyTree(plain));
}

TEST(Study, takesTheParticipantsOfANamedCohortAlone) {
  const Folder folder;
  const std::string path = folder.file("c.db");
  CohortDatabase database(path, Access::create);
  for (unsigned n = 0; n < 8; ++n) {
    const std::string person = fmt::format("P{}", n);
    database.addParticipant({person, n % 2 == 0 ? "expert" : "novice", "", "", {}, {}});
    database.storeAttempt(humanAttempt(n, person), valuesOf(5.0 + n, 1.0));
  }
  database.storeAttempt(humanAttempt(9, ""), valuesOf(1.0, 1.0));
  setCohort(path, "pilot", {}, {"P0", "P1", "P2", "P3"}, {});
  setCohort(path, "main", {}, {"P7"}, {});
  StudyOptions options;
  options.cohort = CohortInUse{"pilot", {}};
  const Study study = makeStudy(database, options);
  EXPECT_EQ(study.cohort, "pilot");
  EXPECT_EQ(study.recruited, 9U);
  EXPECT_EQ(study.analysed, 4U);
  ASSERT_EQ(study.flow.size(), 1U);
  expectNames(study.flow[0].reason, {"cohort: pilot"});
  EXPECT_EQ(study.flow[0].attempts, 5U);
  EXPECT_EQ(rowOf(study, "elapsed-time", "").participants[0], (std::vector<std::string>{"P0", "P2"}));
  expectHolds(textOf(study), {"\"pilot\""});
  options.cohort = CohortInUse{"main", {}};
  expectFault(ErrorKind::refused, "", {"8", "main"}, [&] { (void)makeStudy(database, options); });
  options.cohort = CohortInUse{"Pilot", {}};
  expectFault(ErrorKind::invalid, "", {"\"Pilot\"", "main, pilot"}, [&] { (void)makeStudy(database, options); });
}

TEST(Study, pageIsWatermarkedWhereItIsSynthetic) {
  const Folder folder;
  CohortDatabase database(folder.file("c.db"), Access::create);
  addPerformers(database);
  const std::string page = pageHtml(studyDocument(makeStudy(database, performers)));
  EXPECT_NE(page.find("<title>SYNTHETIC"), std::string::npos);
  EXPECT_NE(page.find("class=\"behind\""), std::string::npos);
  std::size_t figures = 0, marks = 0;
  for (std::size_t at = 0; (at = page.find("<svg", at)) != std::string::npos; ++at) ++figures;
  for (std::size_t at = 0; (at = page.find("class=\"mark\"", at)) != std::string::npos; ++at) ++marks;
  EXPECT_EQ(figures, 5U)
      << "the forest plot, and on its second page and in the appendix a figure for each row with values";
  EXPECT_EQ(marks, figures);
}

TEST(Study, refusesToMixComparabilityKeys) {
  const Folder folder;
  CohortDatabase database(folder.file("c.db"), Access::create);
  addPerformers(database);
  AttemptRecord other = attemptOf(50, "skilled");
  other.comparabilityKey = "touch-liver/2 device=performer calibration=- simulation=1 results=1 mode=assessment";
  database.storeAttempt(other, valuesOf(22, 0.022));
  expectFault(ErrorKind::refused, "", {"2"}, [&] { (void)makeStudy(database, performers); },
              {Remedy::chooseKey, Remedy::mixKeys});
  StudyOptions one = performers;
  one.key = attemptOf(0, "skilled").comparabilityKey;
  const Study chosen = makeStudy(database, one);
  EXPECT_EQ(chosen.keys, (std::vector<std::string>{one.key}));
  ASSERT_EQ(chosen.flow.size(), 1U);
  expectNames(chosen.flow[0].reason, {"key"});
  EXPECT_EQ(chosen.flow[0].attempts, 1U);
  one.key = "another";
  expectFault(ErrorKind::refused, "", {"10", "key"}, [&] { (void)makeStudy(database, one); });
  StudyOptions mixed = performers;
  mixed.mixKeys = true;
  const Study study = makeStudy(database, mixed);
  EXPECT_EQ(study.keys.size(), 2U);
  expectHolds(textOf(study), {"comparability", "mixed"});
}

TEST(Study, refusesToMixCheckpointVersions) {
  const Folder folder;
  CohortDatabase database(folder.file("c.db"), Access::create);
  addPerformers(database);
  auto values = valuesOf(22, 0.022);
  const std::uint32_t version = values[1].version;
  values[1].version = version + 1;
  database.storeAttempt(attemptOf(50, "skilled"), values);
  expectFault(ErrorKind::refused, "", {"path-length", "2"}, [&] { (void)makeStudy(database, performers); });
  StudyOptions mixed = performers;
  mixed.mixKeys = true;
  EXPECT_EQ(rowOf(makeStudy(database, mixed), "path-length", "left").versions,
            (std::vector<std::uint32_t>{version, version + 1}));
}

TEST(Study, needsTwoIndependentGroups) {
  const Folder folder;
  CohortDatabase database(folder.file("c.db"), Access::create);
  expectFault(ErrorKind::refused, "", {"none"}, [&] { (void)makeStudy(database, performers); });
  database.storeAttempt(attemptOf(1, "skilled"), valuesOf(1, 1));
  expectFault(ErrorKind::refused, "", {"skilled"}, [&] { (void)makeStudy(database, performers); });
  database.storeAttempt(attemptOf(2, "unskilled"), valuesOf(1, 1));
  database.storeAttempt(attemptOf(3, "intermediate"), valuesOf(1, 1));
  expectFault(ErrorKind::refused, "", {"3"}, [&] { (void)makeStudy(database, performers); }, {Remedy::nameGroups});
  StudyOptions named = performers;
  named.groups = {"unskilled", "intermediate"};
  EXPECT_EQ(makeStudy(database, named).groups[0], "unskilled");
  named.groups = {"skilled", "absent"};
  expectFault(ErrorKind::refused, "", {"\"absent\""}, [&] { (void)makeStudy(database, named); });
  named.groups = {"skilled", "skilled"};
  expectFault(ErrorKind::invalid, "", {}, [&] { (void)makeStudy(database, named); }, {Remedy::nameGroups});
  AttemptRecord a = attemptOf(4, "skilled"), b = attemptOf(5, "unskilled");
  a.participant = b.participant = "P1";
  database.storeAttempt(a, valuesOf(1, 1));
  database.storeAttempt(b, valuesOf(1, 1));
  named.groups = {"skilled", "unskilled"};
  expectFault(ErrorKind::refused, "", {"\"P1\""}, [&] { (void)makeStudy(database, named); });
}

TEST(Study, allTiedAnswersWithAReason) {
  const Folder folder;
  CohortDatabase database(folder.file("c.db"), Access::create);
  database.storeAttempt(attemptOf(1, "skilled"), valuesOf(5, 1));
  database.storeAttempt(attemptOf(2, "unskilled"), valuesOf(5, 1));
  const Study study = makeStudy(database, performers);
  const std::string reason = rowOf(study, "elapsed-time", "").test.reason();
  expectNames(reason, {"equal"});
  // Rows of which the same is to be said share a sentence, which may be longer than a line.
  std::string text = textOf(study);
  std::replace(text.begin(), text.end(), '\n', ' ');
  EXPECT_TRUE(std::regex_search(text, std::regex("elapsed-time(, [a-z -]+)*: [^:]*" + reason))) << text;
  EXPECT_TRUE(nlohmann::json(studyTree(study)).at("rows").at(0).at("mann_whitney").at("value").is_null());
}

TEST(Study, jsonAndCsvHoldTheTable) {
  const Folder folder;
  CohortDatabase database(folder.file("c.db"), Access::create);
  addPerformers(database);
  const Study study = makeStudy(database, performers);
  const auto json = nlohmann::json(studyTree(study));
  EXPECT_EQ(json.at("watermark"), "SYNTHETIC");
  EXPECT_EQ(json.at("rows").at(0).at("mann_whitney").at("method"), "exact");
  EXPECT_EQ(json.at("rows").at(0).at("shift_interval").at("method"), "exact");
  EXPECT_DOUBLE_EQ(json.at("rows").at(0).at("groups").at(1).at("upper_quartile").get<double>(), 17.75);
  const std::string out = folder.file("csv");
  writeStudyCsv(study, out, false);
  std::ifstream file(out + "/values.csv");
  std::string line;
  std::getline(file, line);
  EXPECT_EQ(line, "checkpoint,subject,unit,group,participant,value,watermark");
  std::getline(file, line);
  EXPECT_EQ(line, "elapsed-time,,s,skilled,attempt " + uuidOf(0) + ",19,SYNTHETIC");
  std::ifstream summary(out + "/study.csv");
  std::getline(summary, line);
  const auto columns = std::count(line.begin(), line.end(), ',');
  while (std::getline(summary, line)) EXPECT_EQ(std::count(line.begin(), line.end(), ','), columns) << line;
  expectFault(ErrorKind::invalid, "", {out}, [&] { writeStudyCsv(study, out, false); }, {Remedy::replaceExisting});
  EXPECT_NO_THROW(writeStudyCsv(study, out, true));
  expectFault(ErrorKind::failure, folder.file("c.db"), {}, [&] { writeStudyCsv(study, folder.file("c.db"), false); });
}

TEST(Study, numbersDontFollowTheLocale) {
  const Folder folder;
  CohortDatabase database(folder.file("c.db"), Access::create);
  addPerformers(database);
  const Study study = makeStudy(database, performers);
  const std::string text = textOf(study), json = studyTree(study).dump();
  struct Comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
  };
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new Comma));
  const char* german = std::setlocale(LC_ALL, "de_DE.UTF-8");
  const std::string textThen = textOf(makeStudy(database, performers)), jsonThen = studyTree(study).dump();
  std::setlocale(LC_ALL, "C");
  std::locale::global(before);
  EXPECT_EQ(textThen, text) << (german != nullptr ? "with de_DE" : "with a locale of commas");
  EXPECT_EQ(jsonThen, json);
}

TEST(Reference, publishedTableIsThatOfThePaper) {
  const auto table = nlohmann::json::parse(publishedTable2());
  const auto& rows = table.at("rows");
  ASSERT_EQ(rows.size(), 8U);
  for (const auto& row : rows) {
    const std::string name = row.at("matches").get<std::string>();
    if (!name.empty()) {
      EXPECT_NE(findCheckpoint(name), nullptr) << name;
    }
  }
  EXPECT_NE(table.at("source").get<std::string>().find("10.1007/s00371-014-0944-3"), std::string::npos);
  std::ifstream file(std::string(CALOT_SOURCE_DIR) + "/assets/reference/cholecystectomy-2014-table3.json");
  const auto questionnaire = nlohmann::json::parse(file);
  int items = 0;
  for (const auto& section : questionnaire.at("sections")) {
    for (const auto& item : section.at("items")) {
      ++items;
      for (const char* group : {"expert", "novice"}) {
        EXPECT_GE(item.at(group).get<double>(), 1.0);
        EXPECT_LE(item.at(group).get<double>(), 5.0);
      }
    }
  }
  EXPECT_EQ(items, 13);
}

TEST(TextTable, writesSignificantDigits) {
  EXPECT_EQ(significant(0.0), "0");
  EXPECT_EQ(significant(-1.6e-11), "0") << "what rounding leaves";
  EXPECT_EQ(significant(113.31), "113.3");
  EXPECT_EQ(significant(-0.012345), "-0.01235");
  EXPECT_EQ(significant(123456.7), "123457");
  EXPECT_EQ(significant(1.5e-6), "1.500e-06");
  EXPECT_EQ(significant(std::nan("")), "-");
  EXPECT_EQ(pText(1.082508822e-5), "<0.0001");
  EXPECT_EQ(pText(0.0524259023), "0.0524");
}

/// Groups that lie apart by 4 and move alike with the mesh by 10 stay apart; where one of them alone moves, they don't.
TEST(Study, saysWhatTheSimulationDoesNotDecide) {
  const Folder folder;
  CohortDatabase database(folder.file("c.db"), Access::create);
  const auto interval = [](const std::string& name, const std::string& subject, std::uint32_t version, double value,
                           double mesh) {
    return ValueInterval{name, subject, version, value, 0.0, mesh, 0.0, value - 20.0, value + 20.0, "", {value, value}};
  };
  std::vector<std::vector<ValueInterval>> intervals;
  for (unsigned n = 0; n < 6; ++n) {
    const bool skilled = n < 3;
    const double value = 1.0 + n % 3 + (skilled ? 0.0 : 4.0);
    database.storeAttempt(attemptOf(n, skilled ? "skilled" : "unskilled"), valuesOf(value, value / 1000));
    intervals.push_back(
        {interval("elapsed-time", "", 1, value, 10.0),
         interval("path-length", "left", findCheckpoint("path-length")->version, value / 1000, skilled ? 0.01 : 0.0)});
    if (n < 5) database.storeIntervals(uuidOf(n), intervals.back());
  }
  const Study partly = makeStudy(database, performers);
  ASSERT_TRUE(rowOf(partly, "elapsed-time", "").simulation);
  EXPECT_EQ(rowOf(partly, "elapsed-time", "").simulation->known, 5U);
  EXPECT_FALSE(rowOf(partly, "elapsed-time", "").simulation->area) << "of one attempt nobody knows";
  expectHolds(textOf(partly), {"5 of 6 values"});
  database.storeIntervals(uuidOf(5), intervals[5]);
  const Study study = makeStudy(database, performers);
  const SimulationRange& time = *rowOf(study, "elapsed-time", "").simulation;
  EXPECT_DOUBLE_EQ(time.halfWidth, 20.0) << "wide, and common to all";
  EXPECT_TRUE(time.decided());
  EXPECT_DOUBLE_EQ(time.area->second, 0.0) << "no skilled one is slower than an unskilled one, in any world";
  const SimulationRange& path = *rowOf(study, "path-length", "left").simulation;
  EXPECT_NEAR(path.halfWidth, 20000.0, 1e-6) << "mm";
  EXPECT_DOUBLE_EQ(path.area->first, 0.0);
  EXPECT_DOUBLE_EQ(path.area->second, 1.0) << "11, 12, 13 against 5, 6, 7 with elements of size zero";
  EXPECT_FALSE(path.decided());
  expectHolds(textOf(study), {"decided"});
  EXPECT_NE(studyTree(study).dump(2).find("\"decided\": false"), std::string::npos);
  const std::vector<std::string> notes = primaryNotes(study);
  const auto warned = [&](const char* figure) {
    return std::any_of(notes.begin(), notes.end(), [&](const std::string& note) {
      return note.starts_with("Warning: ") && holdsToken(note, "ahead") && note.find(figure) != std::string::npos;
    });
  };
  EXPECT_TRUE(warned("path-length left"));
  EXPECT_FALSE(warned("elapsed-time"));
  EXPECT_FALSE(rowOf(study, "path-length", "right").simulation) << "has no value";
}

}  // namespace
}  // namespace calot::analytics
