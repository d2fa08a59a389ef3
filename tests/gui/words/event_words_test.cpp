// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/words/event_words.h"

#include <gtest/gtest.h>

#include <set>

namespace calot::gui {
namespace {

const SubjectNames names{{"liver", "gallbladder", "cystic-duct", "hepatic_artery"}, {"bed"}};

Event event(EventKind kind, std::uint16_t subject) {
  Event made;
  made.kind = kind;
  made.subject = subject;
  return made;
}

TEST(EventWords, SayWhatHappenedToWhat) {
  EXPECT_EQ(textOf(event(EventKind::clipSet, 2), names), "cystic duct: clip set");
  EXPECT_EQ(textOf(event(EventKind::organPerforated, 1), names), "gallbladder: perforated");
  EXPECT_EQ(textOf(event(EventKind::strandsTorn, 0), names), "bed: torn instead of burned");
}

TEST(EventWords, ManageWithoutANameOrASubject) {
  EXPECT_EQ(textOf(event(EventKind::organPerforated, 77), names), "tissue: perforated") << "no structure of this scene";
  EXPECT_EQ(textOf(event(EventKind::connectiveFreed, 0), {names.structures, {}}), "connective tissue: divided");
  EXPECT_EQ(textOf(event(EventKind::clipDropped, 1), names), "clip dropped") << "its subject is no structure";
  EXPECT_EQ(textOf(event(EventKind::runaway, 1), names), "simulation failed");
}

TEST(EventWords, LeaveOutWhatOnlyAMachineCaresFor) {
  for (const EventKind kind : {EventKind::contactBegin, EventKind::contactEnd, EventKind::outOfWorkspace,
                               EventKind::solverMiss, EventKind::contactMiss, EventKind::graspBegin, EventKind::smoke,
                               EventKind::strandsBurned, EventKind::fatCameLoose, EventKind::motionHeldBack}) {
    EXPECT_EQ(wordsOf(kind), nullptr) << static_cast<int>(kind);
    EXPECT_EQ(textOf(event(kind, 1), names), "") << static_cast<int>(kind);
  }
}

// What procedures count as errors (docs/explanation/procedure.md) is one here as well, and each kind has one row.
TEST(EventWords, CallFaultsWhatTheProcedureCounts) {
  std::set<EventKind> faults;
  std::set<std::string> phrases;
  int all = 0;
  for (std::uint16_t number = 0; number < 200; ++number) {
    const EventWords* const words = wordsOf(static_cast<EventKind>(number));
    if (words == nullptr) continue;
    ++all;
    EXPECT_EQ(words->kind, static_cast<EventKind>(number));
    EXPECT_TRUE(phrases.insert(words->phrase).second) << words->phrase << " is said of two kinds";
    if (words->fault) faults.insert(words->kind);
  }
  EXPECT_EQ(all, 26);
  const std::set<EventKind> expected{
      EventKind::graspSlip,       EventKind::tissueTear,    EventKind::strandsTorn,    EventKind::vesselTorn,
      EventKind::clipHalfOn,      EventKind::clipOnClip,    EventKind::clipTooNear,    EventKind::clipDropped,
      EventKind::cutOpen,         EventKind::tooFewClips,   EventKind::cutThroughClip, EventKind::vesselBurned,
      EventKind::organPerforated, EventKind::criticalError, EventKind::runaway,        EventKind::wallInjured};
  EXPECT_EQ(faults, expected);
}

TEST(PhaseWords, AreEmptyBeforeAndToldAfterTheProcedure) {
  EXPECT_EQ(wordFor(Phase::none), "");
  EXPECT_EQ(wordFor(Phase::identification), "identification");
  EXPECT_EQ(wordFor(Phase::dissection), "dissection");
  EXPECT_EQ(wordFor(Phase::done), "done");
}

}  // namespace
}  // namespace calot::gui
