// SPDX-License-Identifier: GPL-3.0-or-later
// Every control is asked for, seen when it is used, and not before.
#include "gui/trainer/trainer_texts.h"

#include <gtest/gtest.h>

#include <cmath>

namespace calot::gui {
namespace {

TrainingStatus running() {
  TrainingStatus status;
  status.stage = Stage::running;
  status.figures.ticks = 100;
  for (AttemptFigures::Hand& hand : status.figures.hand) hand.instrument = InstrumentKind::grasper;
  return status;
}

TEST(ControlsTutorial, GoesThroughAllControlsOfMouseAndKeyboard) {
  ControlsTutorial tutorial(true);
  TrainingStatus now = running();
  AttemptFigures::Hand& right = now.figures.hand[1];
  Hand driven = Hand::right;
  std::size_t learnt = 0;
  const auto learns = [&](const char* what) {
    EXPECT_TRUE(tutorial.observe(now, driven)) << what;
    EXPECT_EQ(tutorial.done(), ++learnt) << what;
    EXPECT_TRUE(tutorial.text().startsWith(QString::fromUtf8("✓ Done: ") + what)) << tutorial.text().toStdString();
  };
  const auto waits = [&] { EXPECT_FALSE(tutorial.observe(now, driven)) << tutorial.text().toStdString(); };
  EXPECT_TRUE(tutorial.text().startsWith("Control 1 of 10: Move the mouse,")) << tutorial.text().toStdString();
  waits();
  right.tip = Vec3(0.01, 0.0, 0.05);  // deeper is not aside
  waits();
  right.tip = Vec3(0.01, 0.012, 0.0);
  learns("moving");
  waits();
  right.tip += Vec3(0.0, 0.0, -0.011);
  learns("depth");
  waits();
  right.jaw = 0.5;
  learns("opening");
  waits();
  right.jaw = 0.05;
  learns("closing");
  waits();
  right.orientation = Quat(std::cos(0.25), 0.0, 0.0, std::sin(0.25));
  learns("rotating");
  waits();
  driven = Hand::left;
  learns("the other hand");
  waits();
  now.figures.hand[0].instrument = InstrumentKind::hook;
  learns("exchanging");
  waits();
  now.figures.hand[0].cautery = Cautery::withoutContact;
  learns("the pedal");
  waits();
  now.figures.touched = true;
  learns("touching");
  waits();
  EXPECT_FALSE(tutorial.over());
  now.stage = Stage::paused;
  learns("the pause");
  EXPECT_TRUE(tutorial.over());
  EXPECT_EQ(tutorial.done(), tutorial.count());
  EXPECT_TRUE(tutorial.text().contains("first task"));
  EXPECT_FALSE(tutorial.observe(now, driven));
}

// The shaft swings about its port with every motion: that is no rotation about itself.
TEST(ControlsTutorial, ASwingOfTheShaftIsNoRotation) {
  ControlsTutorial tutorial(true);
  TrainingStatus now = running();
  for (int i = 0; i < 4; ++i) tutorial.skip();
  EXPECT_FALSE(tutorial.observe(now, Hand::right));
  now.figures.hand[1].orientation = Quat(std::cos(0.3), std::sin(0.3), 0.0, 0.0);
  EXPECT_FALSE(tutorial.observe(now, Hand::right));
  now.figures.hand[1].orientation = Quat(std::cos(0.3), 0.0, 0.0, -std::sin(0.3));
  EXPECT_TRUE(tutorial.observe(now, Hand::right)) << "either way";
}

TEST(ControlsTutorial, SkippingGoesOnWithoutPraise) {
  ControlsTutorial tutorial(true);
  tutorial.skip();
  EXPECT_TRUE(tutorial.text().startsWith("Control 2 of 10: Turn the wheel")) << tutorial.text().toStdString();
  for (int i = 0; i < 20; ++i) tutorial.skip();
  EXPECT_TRUE(tutorial.over());
}

TEST(ControlsTutorial, AnotherDeviceHasNoKeysToLearnButThoseOfTheTrainer) {
  ControlsTutorial tutorial(false);
  EXPECT_EQ(tutorial.count(), 9U) << "both hands are there: none is passed on";
  for (; !tutorial.over(); tutorial.skip()) EXPECT_FALSE(tutorial.text().contains("mouse"));
}

TEST(ControlsTutorial, NothingIsLearntBeforeTheFirstStep) {
  ControlsTutorial tutorial(true);
  TrainingStatus now = running();
  now.stage = Stage::preparing;
  EXPECT_FALSE(tutorial.observe(now, Hand::right));
  now = running();
  now.figures.ticks = 0;  // places are not known yet
  EXPECT_FALSE(tutorial.observe(now, Hand::right));
  now.figures.ticks = 10;
  now.figures.hand[0].tip = Vec3(0.05, 0.05, 0.1);  // where it begins
  EXPECT_FALSE(tutorial.observe(now, Hand::right));
}

}  // namespace
}  // namespace calot::gui
