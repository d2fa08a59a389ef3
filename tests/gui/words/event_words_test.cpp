// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/words/event_words.h"

#include <gtest/gtest.h>

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
  EXPECT_EQ(textOf(event(EventKind::strandsTorn, 0), names), "bed: torn");
}

TEST(EventWords, ManageWithoutANameOrASubject) {
  EXPECT_EQ(textOf(event(EventKind::organPerforated, 77), names), "tissue: perforated") << "no structure of this scene";
  EXPECT_EQ(textOf(event(EventKind::connectiveFreed, 0), {names.structures, {}}), "connective tissue: divided");
  EXPECT_EQ(textOf(event(EventKind::clipDropped, 1), names), "clip lost") << "its subject is no structure";
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

TEST(EventWords, HaveOneRowAKind) {
  int all = 0;
  for (std::uint16_t number = 0; number < 200; ++number) {
    const EventWords* const words = wordsOf(static_cast<EventKind>(number));
    if (words == nullptr) continue;
    ++all;
    EXPECT_EQ(words->kind, static_cast<EventKind>(number));
  }
  EXPECT_EQ(all, 21);
}

TEST(Telling, TellsAnErrorInTheEventsPlaceAndOfAStructureInOneSentence) {
  Judgement now;
  now.events = {event(EventKind::vesselCut, 2), event(EventKind::cutOpen, 2), event(EventKind::tooFewClips, 2),
                event(EventKind::smoke, 0), event(EventKind::clipSet, 3)};
  now.found = {{ErrorRule::tooFewClips, now.events[2]}, {ErrorRule::leftOpen, now.events[1]}};
  const std::vector<Told> told = tell(now, names);
  ASSERT_EQ(told.size(), 3U);
  EXPECT_EQ(told[0].text, "cystic duct left open, cut with too few clips");
  EXPECT_EQ(told[0].severity, Severity::critical);
  EXPECT_TRUE(told[0].marked());
  EXPECT_EQ(told[1].text, "cystic duct: cut");
  EXPECT_FALSE(told[1].marked());
  EXPECT_EQ(told[2].title, "clip set");
  now.events = {event(EventKind::runaway, 0)};
  now.found.clear();
  EXPECT_TRUE(tell(now, names).front().marked()) << "no error of anybody's, and it should not happen";
}

TEST(PhaseWords, AreEmptyBeforeAndToldAfterTheProcedure) {
  EXPECT_EQ(wordFor(Phase::none), "");
  EXPECT_EQ(wordFor(Phase::identification), "identification");
  EXPECT_EQ(wordFor(Phase::dissection), "dissection");
  EXPECT_EQ(wordFor(Phase::done), "done");
}

}  // namespace
}  // namespace calot::gui
