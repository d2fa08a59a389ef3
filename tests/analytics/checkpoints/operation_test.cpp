// SPDX-License-Identifier: GPL-3.0-or-later
// The paper's checkpoints of the operation, over steps made by hand with known answers.
#include <gtest/gtest.h>

#include <string>

#include "tests/analytics/checkpoints/support/operation.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

using recorder::Outcome;
using namespace support;

/// Takes fat: so many ml inside the triangle and outside.
void carve(Operation& o, double inside, double outside) {
  o.now.fat[0].toClear -= inside * 1e-6;
  o.now.fat[0].volume -= (inside + outside) * 1e-6;
  o.step();
}

TEST(SceneFacts, tissueIsIdentifiedByItsRole) {
  const SceneFacts facts = sceneFacts(operationScene());
  ASSERT_EQ(facts.vessel.size(), 4U);
  EXPECT_FALSE(facts.vessel[0].cystic);
  EXPECT_TRUE(facts.vessel[1].cystic);
  EXPECT_FALSE(facts.vessel[2].cystic);
  EXPECT_TRUE(facts.vessel[3].cystic);
  EXPECT_TRUE(facts.connective.at(0).holdsGallbladder);
  EXPECT_DOUBLE_EQ(facts.organ.at(0).skinArea, 0.005);
  SceneDescription none = operationScene();
  for (VesselDescription& vessel : none.vessels) vessel.role = StructureRole::artery;
  none.connective[0].role = StructureRole::other;
  EXPECT_FALSE(sceneFacts(none).hasCystic());
  EXPECT_FALSE(sceneFacts(none).connective.at(0).holdsGallbladder);
}

TEST(FatRemaining, isWhatTheFirstClipFinds) {
  Operation o;
  o.step();
  carve(o, 1.5, 0.6);
  EXPECT_DOUBLE_EQ(*o.value("fat-remaining").value, 5.9 / 8.0) << "provisional before the first clip";
  o.now.vessel[1].clips = 1;
  carve(o, 0.1, 0.0);  // in the very step of the first clip: the last that counts
  // Back to identification after the first clip: no part of the figure, but told.
  o.judged.phase = Phase::identification;
  carve(o, 0.4, 2.0);
  o.now.vessel[1].clips = 0;  // even if no clip is there any more
  carve(o, 0.0, 1.0);
  o.end();
  EXPECT_NEAR(*o.value("fat-remaining").value, 5.8 / 8.0, 1e-12);
  EXPECT_NEAR(*o.value("fat-remaining-inside").value, 0.4 / 2.0, 1e-12);
  EXPECT_NEAR(*o.value("fat-remaining-outside").value, 5.4 / 6.0, 1e-12);
  expectNames(o.value("fat-remaining").note, {"42.5 %"});
  expectNames(o.value("fat-remaining-inside").note, {"20.0 %"});
}

TEST(FatRemaining, recurringPhasesBeforeTheFirstClipCount) {
  Operation o;
  o.judged.phase = Phase::identification;
  o.step();
  carve(o, 0.5, 0.0);
  o.judged.phase = Phase::clipping;  // a clip is dropped: an act of clipping, and no clip on anything
  o.tell(EventKind::clipDropped, 1, 0, 7);
  o.step();
  o.judged.phase = Phase::identification;
  carve(o, 0.5, 0.0);
  o.now.vessel[3].clips = 1;
  o.step();
  o.end();
  EXPECT_DOUBLE_EQ(*o.value("fat-remaining-inside").value, 0.5);
  EXPECT_EQ(o.value("fat-remaining-inside").note, "");
}

TEST(FatRemaining, aClipBeforeAnyCarvingFindsAllOfIt) {
  Operation o;
  o.now.vessel[0].clips = 1;  // on the bile duct, of all things
  o.step();
  carve(o, 2.0, 0.0);
  o.end();
  EXPECT_DOUBLE_EQ(*o.value("fat-remaining-inside").value, 1.0);
  expectNames(o.value("fat-remaining-inside").note, {"100.0 %"});
}

TEST(FatRemaining, withoutAClipOnlyACompletedAttemptHasIt) {
  const auto of = [](Outcome outcome) {
    Operation o;
    o.step();
    carve(o, 1.0, 1.0);
    o.end(outcome);
    return o.value("fat-remaining");
  };
  EXPECT_DOUBLE_EQ(*of(Outcome::completed).value, 0.75);
  expectNames(of(Outcome::completed).note, {"clip"});
  for (const Outcome outcome : {Outcome::abandoned, Outcome::stopped, Outcome::timeLimit, Outcome::technicalFailure}) {
    expectNotAvailable(of(outcome), {"clip", "75.0 %"});
  }
}

TEST(FatRemaining, saysWhereThereIsNone) {
  SceneDescription scene = operationScene();
  scene.fat[0].triangleDepth = 0.0;
  Operation unmarked(scene);
  unmarked.step();
  unmarked.end();
  EXPECT_DOUBLE_EQ(*unmarked.value("fat-remaining").value, 1.0);
  expectNotApplicable(unmarked.value("fat-remaining-inside"), {"region"});
  scene.fat.clear();
  Operation without(scene);
  without.now.fat.clear();
  without.step();
  without.end();
  expectNotApplicable(without.value("fat-remaining"), {"fat"});
  Operation later;
  later.next = 500;
  later.step();
  later.end();
  expectNotAvailable(later.value("fat-remaining"), {"steps"});
}

TEST(CysticContact, sumsOverVesselsAndInstruments) {
  Operation o;
  const auto touch = [&](std::uint32_t left, std::uint32_t right, std::uint64_t steps) {
    o.now.hand[0].touching = left;
    o.now.hand[1].touching = right;
    o.steps(steps);
  };
  const std::uint32_t duct = 1U << cysticDuct, artery = 1U << cysticArtery;
  const std::uint32_t others = 1U << liver | 1U << gallbladder | 1U << bileDuct | 1U << hepaticArtery | 1U << fat;
  touch(others, others, 50);
  touch(duct, 0, 10);
  touch(duct, duct | artery, 20);
  touch(0, artery | others, 5);  // through the end
  o.end();
  const CheckpointValue v = o.value("cystic-contact-time");
  EXPECT_DOUBLE_EQ(*v.value, 0.75);
  EXPECT_EQ(v.note, "v2 0.50 s, v4 0.25 s");
  EXPECT_DOUBLE_EQ(*o.value("contact-time-union", "v2").value, 0.3);
  EXPECT_DOUBLE_EQ(*o.value("contact-time-sum", "v2").value, 0.5);
  EXPECT_GT(*v.value, *o.value("contact-time-union", "v2").value + *o.value("contact-time-union", "v4").value);
}

TEST(CysticContact, isZeroWithoutContactAndNotApplicableWithoutVessels) {
  Operation o;
  o.steps(100);
  o.end();
  EXPECT_EQ(*o.value("cystic-contact-time").value, 0.0);
  SceneDescription scene = operationScene();
  scene.vessels[1].role = scene.vessels[3].role = StructureRole::other;
  Operation without(scene);
  without.now.hand[0].touching = ~0U;
  without.steps(10);
  without.end();
  expectNotApplicable(without.value("cystic-contact-time"), {"duct", "artery"});
}

TEST(CysticContact, tellsOfAStretchedClock) {
  Operation o;
  o.tell(EventKind::clockStretched, 255, 0, 0.34);
  o.step();
  o.end();
  expectNames(o.value("cystic-contact-time").note, {"v2 0.00 s, v4 0.00 s", "0.340 s"});
}

TEST(Connective, remainingIsResidueOnceFreed) {
  Operation o;
  o.now.connective[0] = {0.5, 0.4, 0.1, 0.0, 3};
  o.step();
  expectNotAvailable(o.value("connective-remaining"), {"gallbladder", "50.0 %"});
  EXPECT_DOUBLE_EQ(*o.value("connective-torn").value, 0.1);
  o.now.connective[0] = {0.0, 0.875, 0.125, 0.0, 0};
  o.step();
  o.end();
  EXPECT_DOUBLE_EQ(*o.value("connective-remaining").value, 0.125);
  EXPECT_DOUBLE_EQ(*o.value("connective-torn").value, 0.125);
}

TEST(Connective, isThatOfTheGallbladder) {
  SceneDescription scene = operationScene();
  ConnectiveDescription other;
  other.first = other.second = "organ-a";
  scene.connective.insert(scene.connective.begin(), other);
  Operation o(scene);
  o.now.connective = {{1.0, 0.0, 0.0, 0.0, 0}, {0.0, 0.75, 0.25, 0.0, 0}};
  o.step();
  o.end();
  EXPECT_DOUBLE_EQ(*o.value("connective-remaining").value, 0.25) << "the other tissue stays out";
  scene.connective.pop_back();
  Operation without(scene);
  without.step();
  without.end();
  expectNotApplicable(without.value("connective-remaining"), {"gallbladder"});
  expectNotApplicable(without.value("connective-torn"), {"gallbladder"});
}

TEST(BurnPerBed, isTheCharForTheWorkDone) {
  Operation o;
  o.now.organ[0].charredArea = 1e-5;
  o.step();
  expectNotApplicable(o.value("burn-per-bed"), {"1 %", "bed"});
  o.now.organ[0].charredArea = 2e-5;
  o.now.organ[1].charredArea = 1e-5;
  o.now.connective[0] = {0.4, 0.5, 0.1, 0.0, 3};
  o.step();
  EXPECT_DOUBLE_EQ(*o.value("burn-per-bed").value, 3e-5 / 0.6);
  o.now.connective[0] = {0.0, 0.9, 0.1, 0.0, 0};  // the rest freed without another burn: a better figure
  o.step();
  o.end();
  EXPECT_DOUBLE_EQ(*o.value("burn-per-bed").value, 3e-5);
  SceneDescription scene = operationScene();
  scene.connective.clear();
  Operation without(scene);
  without.step();
  without.end();
  expectNotApplicable(without.value("burn-per-bed"), {"gallbladder"});
}

TEST(OrganBurned, isAShareOfTheWholeSkin) {
  Operation o;
  o.now.organ[1].charredArea = 1e-5;
  o.steps(2);
  o.now.organ[1].charredArea = 6e-5;
  o.step();
  o.end();
  EXPECT_DOUBLE_EQ(*o.value("organ-burned", "organ-b").value, 0.012);
  EXPECT_EQ(*o.value("organ-burned", "organ-a").value, 0.0);
  EXPECT_FALSE(o.has("organ-burned", "liver")) << "organ-a is the liver, whatever its name";
  SceneDescription without = operationScene();
  without.organs[0].role = StructureRole::other;
  Operation other(without);
  other.step();
  other.end();
  EXPECT_EQ(*other.value("organ-burned", "organ-a").value, 0.0);
  expectNotApplicable(other.value("organ-burned", "liver"), {"liver"});
  CheckpointCollector plain(header(), scene());
  feed(plain, 1, [](std::uint64_t, TickSamples&, recorder::TickOutcome&) {});
  EXPECT_EQ(*valueOf(plain, "organ-burned", "liver").value, 0.0);
}

TEST(OrganPerforations, areCountedWhereThereIsAWall) {
  Operation o;
  o.steps(3);
  o.tell(EventKind::organPerforated, 255, gallbladder, 1.1);
  o.tell(EventKind::contactBegin, 1, gallbladder, 1.0);
  o.steps(3);
  o.end();
  EXPECT_EQ(*o.value("organ-perforations", "organ-b").value, 1.0);
  expectNotApplicable(o.value("organ-perforations", "organ-a"), {"wall"});
}

TEST(Results, ofOlderVersionsAreNotApplicableWhereTheyAreSilent) {
  for (const std::uint32_t version : {1U, 2U}) {
    recorder::AttemptHeader header = operationHeader();
    header.stepResultVersion = version;
    header.vessels.clear();
    header.fat.clear();
    Operation o(operationScene(), header, Origin::observables);
    o.now.vessel.clear();
    o.now.fat.clear();
    o.now.connective.resize(version == 1 ? 0 : 1);
    o.steps(3);
    o.end();
    const std::vector<std::string> why{"version " + std::to_string(version)};
    for (const char* name : {"fat-remaining", "fat-remaining-inside", "fat-remaining-outside", "cystic-contact-time",
                             "clip-errors", "critical-view", "critical-errors"}) {
      expectNotApplicable(o.value(name), why);
    }
    expectNotApplicable(o.value("organ-burned", "organ-a"), why);
    expectNotApplicable(o.value("organ-perforations", "organ-b"), why);
    expectNotApplicable(o.value("cautery-without-contact", "right"), why);
    if (version == 1) {
      expectNotApplicable(o.value("connective-torn"), why);
    } else {
      EXPECT_EQ(*o.value("connective-torn").value, 0.0);
      EXPECT_EQ(o.value("connective-torn").origin, Origin::observables);
    }
    EXPECT_DOUBLE_EQ(*o.value("elapsed-time").value, 0.03);
    EXPECT_EQ(o.value("path-length", "left").origin, Origin::samples);
  }
}

}  // namespace
}  // namespace calot::analytics
