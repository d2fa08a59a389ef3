// SPDX-License-Identifier: GPL-3.0-or-later
// In which order news is read aloud, through an engine of Qt's that a test listens to.
#include "gui/trainer/run_panel.h"

#include <gtest/gtest.h>

#include <QCoreApplication>
#include <QtPlugin>

#include "tests/gui/trainer/support/spoken.h"
#include "tests/support/message.h"

Q_IMPORT_PLUGIN(SpokenPlugin)

namespace calot::gui {
namespace {

using trainertest::SpokenEngine;

TEST(Voice, FindsTheEngineAndSpeaksEnglish) {
  const Voice voice;
  EXPECT_EQ(voice.fault(), "");
  ASSERT_NE(SpokenEngine::last, nullptr);
  EXPECT_EQ(SpokenEngine::last->locale().language(), QLocale::English);
}

TEST(Voice, NewsWaitsForWhatIsBeingSaid) {
  Voice voice;
  SpokenEngine& engine = *SpokenEngine::last;
  voice.say("stage", "Recording");
  voice.say("hint", "Grasp the fundus.");
  voice.say("pointer", "The mouse is free.");
  EXPECT_EQ(engine.begun, QStringList({"Recording"}));
  engine.finish();
  EXPECT_EQ(engine.begun.back(), "Grasp the fundus.");
  engine.finish();
  EXPECT_EQ(engine.begun.back(), "The mouse is free.");
  engine.finish();
  EXPECT_EQ(engine.begun.size(), 3) << "and then there is silence";
  voice.say("stage", "Paused");
  EXPECT_EQ(engine.begun.back(), "Paused");
}

TEST(Voice, OfOneSubjectOnlyTheLatestIsSaid) {
  Voice voice;
  SpokenEngine& engine = *SpokenEngine::last;
  voice.say("stage", "Recording");
  voice.say("hint", "Grasp the fundus.");
  voice.say("hint", "Lift it.");
  engine.finish();
  EXPECT_EQ(engine.begun, QStringList({"Recording", "Lift it."}));
  voice.say("stage", "Paused");
  voice.say("hint", "Dissect the triangle.");
  EXPECT_EQ(engine.begun.back(), "Dissect the triangle.") << "what it replaces is cut off, and it goes first";
  engine.finish();
  EXPECT_EQ(engine.begun.back(), "Paused");
}

TEST(Voice, StoppedItForgetsWhatWaited) {
  Voice voice;
  SpokenEngine& engine = *SpokenEngine::last;
  voice.say("stage", "Recording");
  voice.say("hint", "Grasp the fundus.");
  voice.stop();
  EXPECT_EQ(engine.state(), QTextToSpeech::Ready);
  EXPECT_EQ(engine.begun, QStringList({"Recording"}));
}

TEST(Voice, SaysWhyNothingIsHeard) {
  Voice voice;
  QString told;
  QObject::connect(&voice, &Voice::failed, [&](const QString& why) { told = why; });
  SpokenEngine::last->fail("no sound\ncard");
  expectNames(told.toStdString(), {"\"spoken\"", "sound card"});
  EXPECT_EQ(voice.fault(), told);
  voice.say("hint", "Lift it.");
  EXPECT_TRUE(SpokenEngine::last->begun.isEmpty());
}

}  // namespace
}  // namespace calot::gui
