// SPDX-License-Identifier: GPL-3.0-or-later
// Errors and safety of the operation, over steps made by hand with known answers.
#include <gtest/gtest.h>

#include "tests/analytics/checkpoints/support/operation.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

using recorder::Outcome;
using namespace support;

TEST(ClipErrors, countClipsNotFaults) {
  Operation o;
  o.step();
  expectNotApplicable(o.value("clip-errors"), {"clip"});
  o.tell(EventKind::clipSet, 1, cysticDuct, 1.0);
  o.step();
  EXPECT_EQ(*o.value("clip-errors").value, 0.0);
  o.tell(EventKind::clipSet, 1, cysticDuct, 0.6);  // two faults of one clip
  o.tell(EventKind::clipHalfOn, 1, cysticDuct, 0.6);
  o.tell(EventKind::clipTooNear, 1, cysticDuct, 0.0005);
  o.step();
  EXPECT_EQ(*o.value("clip-errors").value, 1.0);
  o.tell(EventKind::clipSet, 0, cysticArtery, 1.0);  // two hands in one step: the fault is the right one's
  o.tell(EventKind::clipSet, 1, cysticArtery, 1.0);
  o.tell(EventKind::clipOnClip, 1, cysticArtery, 0.0002);
  o.step();
  EXPECT_EQ(*o.value("clip-errors").value, 2.0);
  o.tell(EventKind::clipSet, 1, bileDuct, 1.0);
  o.step();
  o.tell(EventKind::clipDropped, 1, 0, 3.0);
  o.step();
  o.end();
  EXPECT_EQ(*o.value("clip-errors").value, 4.0);
  expectNames(o.value("clip-errors").note, {"5 set", "on 1", "clip 1", "near 1", "vessel 1", "dropped 1"});
}

TEST(Cautery, withoutContactIsDebouncedAndOfOneHand) {
  Operation o;
  o.now.hand[1].instrument = InstrumentKind::hook;
  const auto current = [&](Cautery cautery, std::uint64_t steps) {
    o.now.hand[1].cautery = cautery;
    o.steps(steps);
  };
  current(Cautery::withoutContact, 9);  // too short
  current(Cautery::onTissue, 30);
  current(Cautery::withoutContact, 10);  // 0.1 s: long enough
  current(Cautery::onTissue, 1);         // a touch begins a new stretch
  current(Cautery::withoutContact, 9);
  current(Cautery::off, 1);
  current(Cautery::withoutContact, 9);
  current(Cautery::off, 40);
  EXPECT_DOUBLE_EQ(*o.value("cautery-without-contact", "right").value, 0.1);
  current(Cautery::withoutContact, 25);  // through the end
  o.end();
  EXPECT_DOUBLE_EQ(*o.value("cautery-without-contact", "right").value, 0.35);
  expectNotApplicable(o.value("cautery-without-contact", "left"), {"hook"});
}

TEST(Cautery, aHookThatWasPutDownStillCounts) {
  Operation o;
  o.now.hand[0].instrument = InstrumentKind::hook;
  o.now.hand[0].cautery = Cautery::withoutContact;
  o.steps(20);
  o.now.hand[0].instrument = InstrumentKind::scissors;
  o.now.hand[0].cautery = Cautery::off;
  o.steps(20);
  o.end();
  EXPECT_DOUBLE_EQ(*o.value("cautery-without-contact", "left").value, 0.2);
}

TEST(CriticalView, isThatOfTheFirstClip) {
  Operation o;
  o.judged.triangleCleared = 2;
  o.judged.lowerThirdFreed = 1;
  o.judged.twoStructures = 2;
  o.step();
  EXPECT_EQ(*o.value("critical-view").value, 5.0) << "provisional";
  o.judged.criticalViewFrozen = true;
  o.step();
  o.end();
  EXPECT_EQ(*o.value("critical-view").value, 5.0);
  expectNames(o.value("critical-view").note, {"triangle 2", "third 1", "structures 2"});
  Operation never;
  never.judged.triangleCleared = 1;
  never.step();
  never.end(Outcome::abandoned);
  expectNotAvailable(never.value("critical-view"), {"clip", "1", "6"});
}

TEST(ErrorCounts, areTheProceduresAndSayWhichAndWhen) {
  Operation o;
  o.step();
  EXPECT_EQ(*o.value("critical-errors").value, 0.0);
  expectNames(o.value("critical-errors").note, {"assessed", "bleeding"});
  o.judged.errorList = {{{ErrorRule::leftOpen, ErrorRule::tooFewClips}, cysticDuct, 1, 9, 9, 9, 0.0},
                        {{ErrorRule::slipped}, liver, 18, 20, 900, 99, 3.0}};
  o.judged.changed = true;
  o.step();
  o.end();
  EXPECT_EQ(*o.value("critical-errors").value, 1.0);
  expectNames(o.value("critical-errors").note, {"v2", "open", "clips", "0:00.1", "assessed"});
  EXPECT_EQ(*o.value("major-errors").value, 0.0);
  EXPECT_EQ(*o.value("minor-errors").value, 18.0);
  expectNames(o.value("minor-errors").note, {"organ", "slipped", "18 times", "0:01.0"});
  SceneDescription scene = operationScene();
  scene.procedure = {};
  Operation without(scene);
  without.step();
  without.end();
  expectNotApplicable(without.value("critical-errors"), {"procedure"});
  expectNotApplicable(without.value("critical-view"), {"procedure"});
}

}  // namespace
}  // namespace calot::analytics
