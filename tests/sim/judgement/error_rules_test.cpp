// SPDX-License-Identifier: GPL-3.0-or-later
// The table of errors: complete, in order, and every rule is broken by what it says.
#include "sim/judgement/error_rules.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <string>

#include "sim/judgement/judge.h"

namespace calot {
namespace {

enum Harmed : std::uint16_t { ofLiver, ofGallbladder, ofDuct, ofArtery, ofSpared };

SceneDescription erring() {
  SceneDescription scene;
  scene.organs.resize(2);
  scene.organs[ofLiver].role = StructureRole::liver;
  scene.organs[ofGallbladder].role = StructureRole::gallbladder;
  for (const auto& [name, role] : {std::pair{"duct", StructureRole::cysticDuct},
                                   {"artery", StructureRole::cysticArtery},
                                   {"spared", StructureRole::bileDuct}}) {
    scene.vessels.emplace_back().name = name;
    scene.vessels.back().role = role;
  }
  scene.connective.emplace_back().name = "bed";
  scene.procedure = {"gallbladder", "bed", "", {{"duct", 2, 1, true}, {"artery", 2, 1, true}}, {"spared"}};
  scene.clip.minGap = 0.001;
  return scene;
}

using Events = std::vector<Event>;

Event told(EventKind kind, std::uint16_t subject, double value = 0.0, std::uint8_t hand = 1) {
  Event made;
  made.kind = kind;
  made.subject = subject;
  made.value = value;
  made.hand = hand;
  return made;
}

Events clipping(std::uint16_t vessel, double encloses, double gap) {
  return {told(EventKind::clipSet, vessel, encloses), told(EventKind::clipPlace, vessel, 0.01),
          told(EventKind::clipGap, vessel, gap)};
}
Events cutting(std::uint16_t vessel, double open, double start, double end) {
  return {told(EventKind::vesselCut, vessel, 0.01), told(EventKind::cutOpen, vessel, open),
          told(EventKind::clipsTowardsStart, vessel, start), told(EventKind::clipsTowardsEnd, vessel, end)};
}

/// A step's events where the rule is broken. Every kind of event that can be an error is here.
const std::map<ErrorRule, Events>& breaking() {
  static const std::map<ErrorRule, Events> all{
      {ErrorRule::sparedCut, {told(EventKind::vesselCut, ofSpared, 0.01)}},
      {ErrorRule::sparedBurned, {told(EventKind::vesselBurned, ofSpared, 0.01)}},
      {ErrorRule::sparedTorn, {told(EventKind::vesselTorn, ofSpared, 0.5, 255)}},
      {ErrorRule::sparedClipped, clipping(ofSpared, 1.0, 1.0)},
      {ErrorRule::sparedHeated, {told(EventKind::wallInjured, ofSpared, 0.01)}},
      {ErrorRule::leftOpen, cutting(ofArtery, 1.0, 0.0, 1.0)},
      {ErrorRule::notIdentified, {told(EventKind::vesselCut, ofDuct, 0.01)}},
      {ErrorRule::viewIncomplete, {told(EventKind::vesselCut, ofArtery, 0.01)}},
      {ErrorRule::tooFewClips, cutting(ofDuct, 0.0, 1.0, 1.0)},
      {ErrorRule::cutThroughClip, {told(EventKind::cutThroughClip, ofDuct, 0.01)}},
      {ErrorRule::burnedThrough, {told(EventKind::vesselBurned, ofDuct, 0.01)}},
      {ErrorRule::torn, {told(EventKind::vesselTorn, ofDuct, 0.5, 255)}},
      {ErrorRule::perforated, {told(EventKind::organPerforated, ofGallbladder)}},
      {ErrorRule::organTorn, {told(EventKind::tissueTear, ofLiver, 3.0)}},
      {ErrorRule::openTowardsSpecimen, cutting(ofDuct, 2.0, 2.0, 0.0)},
      {ErrorRule::tooFewTowardsSpecimen, cutting(ofDuct, 0.0, 2.0, 0.0)},
      {ErrorRule::clipHalfOn, clipping(ofDuct, 0.9, 1.0)},
      {ErrorRule::clipLost, {told(EventKind::clipDropped, 0, 7.0)}},
      {ErrorRule::burnedAndSealed,
       {told(EventKind::vesselBurned, ofArtery, 0.01), told(EventKind::vesselSealed, ofArtery, 0.01)}},
      {ErrorRule::heated, {told(EventKind::wallInjured, ofDuct, 0.01)}},
      {ErrorRule::clipOnClip, clipping(ofDuct, 1.0, -0.001)},
      {ErrorRule::clipTooNear, clipping(ofDuct, 1.0, 0.0005)},
      {ErrorRule::tornFromJaws, {told(EventKind::tissueTear, ofGallbladder, 3.0)}},
      {ErrorRule::pressedHard, {}},
      {ErrorRule::slipped, {told(EventKind::graspSlip, ofGallbladder, 3.0)}},
      {ErrorRule::strandsTorn, {told(EventKind::strandsTorn, 0, 0.01)}}};
  return all;
}

TEST(ErrorRules, areInTheOrderOfSeverityAndOnceEach) {
  std::set<int> numbers;
  std::set<std::string> words;
  Severity before = Severity::critical;
  for (const ErrorRuleText& text : errorRules()) {
    EXPECT_LE(text.severity, before) << text.name;
    before = text.severity;
    EXPECT_TRUE(numbers.insert(static_cast<int>(text.rule)).second) << text.name;
    EXPECT_TRUE(words.insert(text.name).second) << text.name;
    EXPECT_FALSE(std::string(text.source).empty()) << text.name;
    const std::string why = text.why;
    EXPECT_EQ(std::count(why.begin(), why.end(), '.'), 1) << "one sentence: " << why;
    EXPECT_EQ(why.back(), '.') << text.name;
  }
  EXPECT_EQ(breaking().size(), errorRules().size()) << "each rule has events that break it";
}

TEST(ErrorRules, areBrokenByWhatTheySay) {
  for (const auto& [rule, events] : breaking()) {
    Judge judge(erring());
    StepResult result;
    result.organ.resize(2);
    result.vessel.resize(3);
    result.connective.resize(1);
    result.connective[0].attached = 1.0;
    const bool hidden = rule == ErrorRule::notIdentified || rule == ErrorRule::viewIncomplete;
    result.connective[0].lowerAttached = hidden ? 1.0 : 0.0;
    result.vessel[0].covered = hidden ? 1.0 : 0.0;
    result.vessel[1].covered = rule == ErrorRule::notIdentified ? 1.0 : 0.0;
    result.events = events;
    if (rule == ErrorRule::pressedHard) {
      result.hand[1].structureForce = {4.0};
      for (int step = 0; step < 9; ++step) judge.observe(result);
    }
    const Judgement& now = judge.observe(result);
    ASSERT_FALSE(now.found.empty()) << textOf(rule).name;
    EXPECT_TRUE(std::any_of(now.found.begin(), now.found.end(), [&](const JudgedError& e) { return e.rule == rule; }))
        << textOf(rule).name;
    for (const JudgedError& error : now.found)
      EXPECT_EQ(textOf(error.rule).severity, textOf(rule).severity) << "besides " << textOf(rule).name;
    ASSERT_EQ(now.errorList.size(), 1U) << textOf(rule).name;
    EXPECT_EQ(now.errors(textOf(rule).severity), 1U) << textOf(rule).name;
    EXPECT_EQ(now.errors(), 1U) << textOf(rule).name;
  }
}

TEST(ErrorRules, aLiverIsPressedHardForAWhile) {
  Judge judge(erring());
  StepResult result;
  const Judgement& now = judge.judgement();
  std::size_t events = 0, found = 0;
  const auto press = [&](double force, int steps) {
    result.hand[0].structureForce = {force, 100.0};  // what is not the liver doesn't count
    for (int i = 0; i < steps; ++i, ++result.step) {
      judge.observe(result);
      events += now.events.size();
      found += now.found.size();
    }
  };
  press(3.38, 500);
  press(50.0, 9);
  press(3.0, 1);
  EXPECT_EQ(now.errors(), 0U) << "as hard as surgeons do, or for less than 0.1 s";
  press(3.5, 100);
  const std::uint64_t worst = result.step;
  press(5.0, 1);
  press(4.0, 299);
  ASSERT_EQ(now.errorList.size(), 1U);
  EXPECT_EQ(now.errorList[0].count, 1U);
  EXPECT_EQ(now.errorList[0].first, 510U + 9U);
  EXPECT_EQ(now.errorList[0].last, result.step - 1);
  EXPECT_EQ(now.errorList[0].worst, worst);
  EXPECT_EQ(now.errorList[0].value, 5.0);
  press(0.0, 50);
  press(4.0, 20);
  EXPECT_EQ(now.errorList[0].count, 1U) << "within a second";
  press(0.0, 200);
  press(4.0, 20);
  EXPECT_EQ(now.errorList[0].count, 2U);
  EXPECT_EQ(now.errors(Severity::minor), 2U);
  EXPECT_EQ(events, 3U) << "each press is an event once";
  EXPECT_EQ(found, 3U);
}

TEST(ErrorRules, areAsTheDocumentationHasThem) {
  std::ifstream file(std::string(CALOT_SOURCE_DIR) + "/docs/explanation/procedure.md");
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  constexpr const char* severities[]{"minor", "major", "critical"};
  for (const ErrorRuleText& text : errorRules()) {
    const std::string row = std::string("| ") + severities[static_cast<int>(text.severity) - 1] + " | `" + text.name +
                            "` | " + text.words + " | " + text.why + " | " + text.source + " |\n";
    EXPECT_NE(page.find(row), std::string::npos) << row;
  }
}

TEST(ErrorRules, whatIsNotShownIsNotCalledNone) {
  SceneDescription scene = erring();
  EXPECT_EQ(notAssessed(scene, 5).size(), 1U) << "nothing bleeds";
  EXPECT_EQ(notAssessed(scene, 4).size(), 2U) << "it does not report burned walls either";
  scene.vessels.clear();
  scene.procedure.spare.clear();
  EXPECT_TRUE(notAssessed(scene, 4).empty());
}

}  // namespace
}  // namespace calot
