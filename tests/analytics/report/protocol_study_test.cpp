// SPDX-License-Identifier: GPL-3.0-or-later
// What a protocol makes of a study: heading, people, family, missing values.
#include <gtest/gtest.h>
#include <SQLiteCpp/SQLiteCpp.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "analytics/cohort/page_sums.h"
#include "analytics/report/study_output.h"
#include "analytics/report/study_protocol.h"
#include "analytics/statistics/rank_tests.h"
#include "recorder/base/files.h"
#include "tests/analytics/assessment/support/texts.h"
#include "tests/analytics/cohort/support/cohort_support.h"
#include "tests/support/fault.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

using Access = CohortDatabase::Access;
using nlohmann::json;
using support::bytesOf;
using support::Folder;
using support::humanAttempt;
using support::uuidOf;

json document() {
  return json::parse(R"({"format": "calot-protocol", "formatVersion": 1, "name": "times", "version": 1,
    "title": "Experts are faster", "populations": [
      {"group": "expert", "definition": "at least 100 operations", "criteria": [{"criterion": "operations", "atLeast": 100}]},
      {"group": "novice", "definition": "no operation"}],
    "better": "expert", "unit": "participant", "attemptRule": "single",
    "exclusions": {"outcomes": ["stopped"], "reasons": ["device failed"]}, "missing": "worst-rank", "level": 0.05,
    "hypotheses": [{"checkpoint": "elapsed-time", "larger": "novice", "primary": true},
                   {"checkpoint": "path-length", "subject": "left", "larger": "novice", "primary": true},
                   {"checkpoint": "path-length", "subject": "right", "larger": "novice", "primary": true},
                   {"checkpoint": "force-maximum", "subject": "left", "larger": "novice", "primary": false}]})");
}

Protocol protocolOf(const json& text) { return parseProtocol(bytesOf(text.dump()), "p.json"); }

StoredDocument stored(const Protocol& p) { return {p.name, p.version, p.sha256, p.text}; }

std::vector<CheckpointValue> figures(double seconds, double left, double right, double depth) {
  return {makeValue(*findCheckpoint("elapsed-time"), "", Origin::resimulated, seconds),
          makeValue(*findCheckpoint("path-length"), "left", Origin::samples, left),
          makeValue(*findCheckpoint("path-length"), "right", Origin::samples, right),
          makeValue(*findCheckpoint("depth-path"), "left", Origin::samples, depth)};
}

/// Five experts and five novices of 2020, before whom putBefore() registers; all separate but one figure.
class ProtocolStudy : public testing::Test {
 protected:
  ProtocolStudy() : path_(folder_.file("c.db")), database_(path_, Access::create) {
    for (unsigned n = 0; n < 10; ++n) add(n, n < 5 ? "expert" : "novice", "200");
  }

  void add(unsigned n, const std::string& group, const std::string& operations,
           recorder::Outcome outcome = recorder::Outcome::completed) {
    const std::string who = fmt::format("{}{}", group == "expert" ? "E" : "N", n);
    Participant p;
    p.pseudonym = who;
    p.group = group;
    p.experience = {{"operations", operations}};
    database_.addParticipant(p);
    AttemptRecord a = humanAttempt(n, who);
    a.startUtc = fmt::format("2020-01-02T00:00:{:02}Z", n);
    a.outcome = outcome;
    std::vector<CheckpointValue> values = figures(10.0 + n, 1.0 + n, 1.0 + n % 5, 1.0 + n);
    values[0] = support::elapsedTime(10.0 + n, outcome);
    database_.storeAttempt(a, values);
  }

  Study study(const json& text) {
    StudyOptions options;
    options.protocol = ProtocolInUse{protocolOf(text), {}, {}};
    options.protocol->registered = CohortDatabase(path_, Access::read).protocols("times");
    return makeStudy(database_, options);
  }

  RegisteredProtocol put(const json& text) {
    bool added = false;
    return CohortDatabase(path_, Access::write).registerProtocol(stored(protocolOf(text)), "me", added);
  }

  /// Registered the day before the attempts. Every one of them comes in now.
  RegisteredProtocol putBefore(const json& text) {
    const Protocol p = protocolOf(text);
    SQLite::Database raw(path_, SQLite::OPEN_READWRITE, 0, pageSumLayer());
    SQLite::Statement insert(raw,
                             "INSERT INTO protocol (name, version, sha256, text, registered_utc, registered_by) VALUES "
                             "(?, ?, ?, ?, '2020-01-01T00:00:00Z', 'me')");
    insert.bind(1, p.name);
    insert.bind(2, p.version);
    insert.bind(3, p.sha256);
    insert.bind(4, p.text);
    insert.exec();
    return CohortDatabase(path_, Access::read).protocols(p.name).back();
  }

  static const StudyRow& row(const Study& study, const std::string& name, const std::string& subject) {
    for (const StudyRow& r : study.rows) {
      if (r.checkpoint == name && r.subject == subject) return r;
    }
    throw std::out_of_range(name);
  }

  Folder folder_;
  std::string path_;
  CohortDatabase database_;
};

TEST_F(ProtocolStudy, isExploratoryUnlessRegisteredBeforeTheFirstAttempt) {
  EXPECT_EQ(study(document()).heading, "exploratory");
  expectNames(study(document()).protocol->whyExploratory, {"registered"});
  const RegisteredProtocol now = putBefore(document());
  const Study confirmed = study(document());
  EXPECT_EQ(confirmed.heading, "confirmatory");
  EXPECT_EQ(confirmed.protocol->whyExploratory, "");
  EXPECT_EQ(confirmed.protocol->firstAttemptUtc, "2020-01-02T00:00:00Z");
  EXPECT_EQ(confirmed.protocol->registeredUtc, now.registeredUtc);
  // One attempt from before is enough, even if it was excluded by hand.
  AttemptRecord early = humanAttempt(40, "E0b");
  early.startUtc = "2019-12-31T12:00:00Z";
  database_.addParticipant({"E0b", "expert", "", "", {{"operations", "300"}}, {}});
  database_.storeAttempt(early, figures(9, 9, 9, 9));
  database_.excludeAttempts({early.uuid}, "device failed", "me");
  const Study late = study(document());
  EXPECT_EQ(late.heading, "exploratory");
  expectNames(late.protocol->whyExploratory, {early.startUtc});
  EXPECT_TRUE(late.protocol->deviations.empty()) << "the protocol names this reason";
  database_.excludeAttempts({early.uuid}, "looked odd", "me");
  ASSERT_EQ(study(document()).protocol->deviations.size(), 1U);
  EXPECT_NE(study(document()).protocol->deviations[0].find("looked odd"), std::string::npos);
}

TEST_F(ProtocolStudy, attemptsThatCameInBeforeTheRegistrationAreNoPrediction) {
  put(document());  // now, and the clocks of the stations were wrong: they say tomorrow
  SQLite::Database(path_, SQLite::OPEN_READWRITE, 0, pageSumLayer())
      .exec("UPDATE attempt SET start_utc = '2999-01-01T00:00:00Z'");
  const Study late = study(document());
  EXPECT_EQ(late.heading, "exploratory");
  expectNames(late.protocol->whyExploratory, {uuidOf(0)});
}

TEST_F(ProtocolStudy, aStatedStartIsNoEvidence) {
  putBefore(document());
  database_.addParticipant({"E42", "expert", "", "", {{"operations", "300"}}, {}});
  AttemptRecord a = humanAttempt(42, "E42");
  a.startUtc = "2020-01-03T00:00:00Z";
  a.operatorKind = recorder::OperatorKind::kinematics;  // made from a motion file
  database_.storeAttempt(a, figures(9, 9, 9, 9));
  const Study stated = study(document());
  EXPECT_EQ(stated.heading, "exploratory");
  expectNames(stated.protocol->whyExploratory, {"stated"});
  EXPECT_EQ(stated.protocol->starts, (std::map<std::string, std::uint64_t>{{"recorded", 10}, {"stated", 1}}));
}

TEST_F(ProtocolStudy, anAttemptWithoutAStartProvesNothing) {
  putBefore(document());
  database_.addParticipant({"E41", "expert", "", "", {{"operations", "300"}}, {}});
  AttemptRecord a = humanAttempt(41, "E41");
  a.startUtc.clear();
  database_.storeAttempt(a, figures(9, 9, 9, 9));
  EXPECT_EQ(study(document()).heading, "exploratory");
}

TEST_F(ProtocolStudy, versionsAreKeptAndChangesListed) {
  json changed = document();
  putBefore(document());
  const RegisteredProtocol again = put(document());
  EXPECT_EQ(again.version, 1U);
  changed["level"] = 0.01;
  expectFault(ErrorKind::refused, path_, {"times version 1"}, [&] { put(changed); });
  changed["version"] = 2;
  putBefore(changed);
  expectFault(ErrorKind::refused, path_, {"times version 2"}, [&] {
    json between = changed;
    between["title"] = "other";
    put(between);
  });
  const Study second = study(changed);
  ASSERT_EQ(second.protocol->versions.size(), 2U);
  EXPECT_EQ(second.protocol->versions[1].changed, std::vector<std::string>{"/level"});
  std::ostringstream text;
  printStudy(second, text);
  EXPECT_NE(text.str().find("Study (confirmatory): expert against novice"), std::string::npos);
  expectHolds(text.str(), {"/level"});
  expectFault(ErrorKind::invalid, "", {"protocol"}, [&] {
    bool added = false;
    CohortDatabase(path_, Access::write).registerProtocol(stored(protocolOf(document())), "", added);
  });
  SQLite::Database raw(path_, SQLite::OPEN_READWRITE);
  EXPECT_THROW(raw.exec("UPDATE protocol SET registered_utc = '2000-01-01T00:00:00Z'"), SQLite::Exception);
  EXPECT_THROW(raw.exec("DELETE FROM protocol"), SQLite::Exception);
}

TEST_F(ProtocolStudy, holmIsOverThePrimaryHypothesesAlone) {
  const Study s = study(document());
  // Complete separation of five and five: 2 / 252. The right hands' values are equal in both groups: p = 1.
  const double p = 2.0 / 252.0;
  EXPECT_NEAR(row(s, "elapsed-time", "").test->p, p, 1e-15);
  EXPECT_NEAR(*row(s, "elapsed-time", "").holm, 3.0 * p, 1e-15);
  EXPECT_NEAR(*row(s, "path-length", "left").holm, 3.0 * p, 1e-15);
  EXPECT_NEAR(*row(s, "path-length", "right").holm, 1.0, 1e-15);
  EXPECT_EQ(row(s, "elapsed-time", "").role, Role::primary);
  EXPECT_EQ(row(s, "elapsed-time", "").supported, true);
  EXPECT_EQ(row(s, "path-length", "right").supported, false);
  const StudyRow& other = row(s, "depth-path", "left");
  EXPECT_EQ(other.role, Role::exploratory);
  EXPECT_FALSE(other.holm);
  EXPECT_FALSE(other.benjaminiHochberg) << "without a hypothesis no p";
  EXPECT_FALSE(other.supported) << "nothing was expected";
  const json said = json(studyTree(s));
  EXPECT_EQ(said["rows"][0]["role"], "primary");
  EXPECT_EQ(said["protocol"]["sha256"], protocolOf(document()).sha256);
  bool absent = false;
  for (const std::string& remark : s.remarks) absent = absent || holdsToken(remark, "force-maximum left");
  EXPECT_TRUE(absent);
}

/// Five against five give 2 / 252 at least: over seven hypotheses that is .0556.
TEST_F(ProtocolStudy, aHypothesisOutOfReachIsNotDecided) {
  json text = document();
  for (const char* name : {"angular-path", "speed-mean", "movements", "sparc"})
    text["hypotheses"].push_back({{"checkpoint", name}, {"subject", "left"}, {"larger", "novice"}, {"primary", true}});
  const Study s = study(text);
  const StudyRow& time = row(s, "elapsed-time", "");
  EXPECT_NEAR(*time.holm, 7.0 * 2.0 / 252.0, 1e-15);
  EXPECT_NEAR(*time.attainableP, 7.0 * 2.0 / 252.0, 1e-15);
  EXPECT_FALSE(time.supported) << "as far apart as can be, and neither supported nor not";
  std::ostringstream out;
  printStudy(s, out, StudyDetail::first);
  expectHolds(out.str(), {"reach", "neither"});
  EXPECT_EQ(row(study(document()), "elapsed-time", "").supported, true) << "three are within reach";
}

TEST_F(ProtocolStudy, theDirectionIsTheProtocolsEvenAgainstTheCheckpoints) {
  json text = document();
  text["hypotheses"][0]["larger"] = "expert";
  const StudyRow row0 = row(study(text), "elapsed-time", "");
  EXPECT_DOUBLE_EQ(row0.area->value.a, 0.0);
  EXPECT_EQ(row0.asHypothesised, false);
  EXPECT_EQ(row0.supported, false) << "significant the other way";
}

TEST_F(ProtocolStudy, populationsOutcomesAndScenesStayOutAndAreCounted) {
  add(20, "expert", "12");
  add(21, "novice", "0", recorder::Outcome::stopped);
  json text = document();
  Study s = study(text);
  EXPECT_EQ(s.analysed, 10U);
  const auto count = [&](const std::string& reason) {
    for (const FlowRow& f : s.flow) {
      if (f.reason == reason) return f.attempts;
    }
    return std::uint64_t{0};
  };
  EXPECT_EQ(count(protocolReasons()[2]), 1U);
  EXPECT_EQ(count(protocolReasons()[1]), 1U);
  text["scene"] = "cholecystectomy/2";
  expectFault(ErrorKind::refused, "", {"scene"}, [&] { (void)study(text); });
}

TEST_F(ProtocolStudy, whoDoesNotFinishRanksBehindAll) {
  add(22, "novice", "0", recorder::Outcome::abandoned);
  add(23, "expert", "150", recorder::Outcome::timeLimit);
  const StudyRow ranked = row(study(document()), "elapsed-time", "");
  EXPECT_EQ(ranked.group[0].n, 5U);
  EXPECT_EQ(ranked.worstRanked[0], std::vector<std::string>{"E23"});
  EXPECT_EQ(ranked.worstRanked[1], std::vector<std::string>{"N22"});
  // R's W of c(10:14, 99) and c(15:19, 99): 5 + 1 / 2; of 36 pairs.
  EXPECT_DOUBLE_EQ(ranked.test->u, 5.5);
  EXPECT_DOUBLE_EQ(ranked.area->value.a, 1.0 - 5.5 / 36.0);
  EXPECT_DOUBLE_EQ(*ranked.shift, -5.0) << "of the values that there are";
  json text = document();
  text["missing"] = "complete-cases";
  EXPECT_DOUBLE_EQ(row(study(text), "elapsed-time", "").test->u, 0.0);
  std::ostringstream out;
  printStudy(study(document()), out);
  EXPECT_NE(out.str().find("rank behind all others"), std::string::npos);
}

/// The outcome decides, not why the value is missing: all three rank last, what merely ends or fails does not.
TEST_F(ProtocolStudy, theOutcomeDecidesWhoRanksLast) {
  json text = document();
  text["exclusions"]["outcomes"] = json::array();
  add(22, "novice", "0", recorder::Outcome::abandoned);
  add(24, "novice", "0", recorder::Outcome::stopped);
  add(25, "novice", "0", recorder::Outcome::timeLimit);
  add(26, "novice", "0", recorder::Outcome::technicalFailure);
  add(28, "novice", "0", recorder::Outcome::running);
  Participant p;
  p.pseudonym = "N30";
  p.group = "novice";
  p.experience = {{"operations", "0"}};
  database_.addParticipant(p);
  AttemptRecord ends = humanAttempt(30, "N30");  // a motion file
  ends.startUtc = "2999-01-01T00:00:30Z";
  ends.operatorKind = recorder::OperatorKind::kinematics;
  ends.outcome = recorder::Outcome::stopped;
  database_.storeAttempt(ends, {support::elapsedTime(9.0, ends.outcome)});
  const Study s = study(text);
  const StudyRow& time = row(s, "elapsed-time", "");
  EXPECT_EQ(time.worstRanked[1], (std::vector<std::string>{"N22", "N24", "N25"}));
  EXPECT_EQ(time.group[1].missing, 4U);
  EXPECT_DOUBLE_EQ(time.area->value.a, 1.0) << "experts are faster than all";
  // Whoever ends early has a short path; the figure says so.
  const StudyRow& path = row(s, "path-length", "left");
  EXPECT_EQ(path.unfinished, (std::array<std::uint64_t, 2>{0, 3}));
  EXPECT_TRUE(path.worstRanked[1].empty());
  bool warned = false;
  for (const std::string& remark : s.remarks)
    warned = warned || (holdsToken(remark, "3 novice") && holdsToken(remark, "path-length left"));
  EXPECT_TRUE(warned);
  std::uint64_t failed = 0, open = 0;
  for (const FlowRow& f : s.flow) {
    failed += f.reason == "technical failure" ? f.attempts : 0;
    open += f.reason == "recording incomplete" ? f.attempts : 0;
  }
  EXPECT_EQ(failed, 1U);
  EXPECT_EQ(open, 1U);
}

/// The mean of a value and a failure to finish is a failure to finish.
TEST_F(ProtocolStudy, aMeanWithAnUnfinishedAttemptRanksLast) {
  AttemptRecord again = humanAttempt(40, "E0");
  again.startUtc = "2999-01-02T00:00:00Z";
  again.outcome = recorder::Outcome::abandoned;
  database_.storeAttempt(again, {support::elapsedTime(3.0, again.outcome)});
  json text = document();
  text["attemptRule"] = "mean";
  const StudyRow time = row(study(text), "elapsed-time", "");
  EXPECT_EQ(time.worstRanked[0], std::vector<std::string>{"E0"});
  EXPECT_EQ(time.group[0].n, 4U);
  text["missing"] = "complete-cases";
  EXPECT_EQ(row(study(text), "elapsed-time", "").group[0].n, 5U);
}

TEST_F(ProtocolStudy, aDeclaredTestOfUnequalSpreadDecides) {
  for (unsigned n = 50; n < 60; ++n) add(n, "novice", "0");
  const StudyRow plain = row(study(document()), "path-length", "left");
  json text = document();
  text["test"] = "brunner-munzel";
  const Study s = study(text);
  const StudyRow& chosen = row(s, "path-length", "left");
  const auto wanted = brunnerMunzel(chosen.values[0], chosen.values[1]);
  EXPECT_DOUBLE_EQ(chosen.test->p, wanted->p);
  EXPECT_NE(chosen.test->p, plain.test->p);
  EXPECT_TRUE(holdsToken(studyMethods(s), "Brunner"));
  EXPECT_FALSE(holdsToken(studyMethods(s), "Mann-Whitney"));
}

TEST_F(ProtocolStudy, methodsSayWhatWasDone) {
  putBefore(document());
  const std::string methods = studyMethods(study(document()));
  expectHolds(methods, {"protocol times version 1", "exact"});
  EXPECT_EQ(methods.find("normal approximation"), std::string::npos);
  EXPECT_FALSE(holdsToken(methods, "covariance")) << "not done";
  expectHolds(methods, {"5 expert", "5 novice"});
}

}  // namespace
}  // namespace calot::analytics
