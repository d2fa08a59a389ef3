// SPDX-License-Identifier: GPL-3.0-or-later
// The verdict on a page, and the way from each error to its moment: by mouse, and by keys alone.
#include "gui/attempt/verdict_card.h"

#include <gtest/gtest.h>
#include <algorithm>
#include <QApplication>
#include <QLabel>
#include <QPushButton>
#include <QSignalSpy>
#include <QTest>

#include "gui/dashboard/timeline.h"
#include "tests/gui/dashboard/support/recorded.h"
#include "tests/support/message.h"

namespace calot::gui {
namespace {

const std::vector<analytics::ErrorLine> errors{{Severity::critical, 1, 100.2, "cystic duct <left> open"},
                                               {Severity::major, 2, 62.0, "clip lost"},
                                               {Severity::minor, 9, 5.0, "bed torn"}};

AttemptSummary unsafe() {
  AttemptSummary summary;
  summary.safety = AttemptSummary::Safety::notSafe;
  summary.verdict = "The task was completed.";
  summary.errors = {"Not safe: a duct <left> open."};
  return summary;
}

TEST(VerdictCard, SaysTheStoredSentencesUntilTheRecordingWasRead) {
  test::startApplication();
  VerdictCard card;
  card.show();
  card.showSummary(unsafe());
  EXPECT_EQ(card.findChild<QLabel*>("summary-errors")->text(),
            QString::fromStdString(unsafe().errors.front()).toHtmlEscaped());
  EXPECT_FALSE(card.findChild<QPushButton*>("show-gravest")->isVisible()) << "its moment is not known yet";
  EXPECT_FALSE(card.findChild<QLabel*>("summary-critical-view")->isVisible());
  const QString safety = card.findChild<QLabel*>("safety")->text();
  AttemptSummary unknown = unsafe();
  unknown.safety = AttemptSummary::Safety::notAssessed;
  card.showSummary(unknown);
  EXPECT_NE(card.findChild<QLabel*>("safety")->text(), safety);
}

TEST(VerdictCard, EachErrorLeadsToItsMoment) {
  test::startApplication();
  VerdictCard card;
  card.show();
  card.showSummary(unsafe());
  card.showErrors(errors);
  QSignalSpy chosen(&card, &VerdictCard::timeChosen);
  QTest::mouseClick(card.findChild<QPushButton*>("show-gravest"), Qt::LeftButton);
  ASSERT_EQ(chosen.size(), 1);
  EXPECT_EQ(chosen.takeFirst()[0].toDouble(), 100.2) << "the gravest";
  QLabel& words = *card.findChild<QLabel*>("summary-errors");
  expectHolds(words.text().toStdString(), {"cystic duct &lt;left&gt; open", "1:40.2", "clip lost, 2 times", "9 minor"});
  EXPECT_FALSE(words.text().contains("bed torn")) << "minor ones are among the events";
  QApplication::setActiveWindow(&card);
  words.setFocus(Qt::TabFocusReason);
  QTest::keyClick(&words, Qt::Key_Tab);
  QTest::keyClick(&words, Qt::Key_Return);
  QTest::keyClick(&words, Qt::Key_Tab);
  QTest::keyClick(&words, Qt::Key_Return);
  ASSERT_EQ(chosen.size(), 2) << "by keys alone";
  EXPECT_EQ(chosen[0][0].toDouble(), 100.2);
  EXPECT_EQ(chosen[1][0].toDouble(), 62.0);
}

TEST(Timeline, AnErrorIsChosenInTheLaneOfItsSeverity) {
  test::startApplication();
  TimelineBar bar;
  bar.resize(800, bar.sizeHint().height());
  bar.show();
  AttemptTrack track;
  track.seconds = 200.0;
  track.events = {{100.0, "", "left open", true, Severity::critical}, {101.0, "", "bed torn", true, Severity::minor}};
  bar.setTrack(track);
  QSignalSpy chosen(&bar, &TimelineBar::timeChosen);
  const int x = static_cast<int>(TimeScale{200.0, 800.0}.x(100.5));
  std::vector<double> times;
  for (int y = 0; y < bar.height(); ++y) {
    QTest::mouseClick(&bar, Qt::LeftButton, {}, {x, y});
    times.push_back(chosen.takeLast()[0].toDouble());
  }
  const auto critical = std::find(times.begin(), times.end(), 100.0),
             minor = std::find(times.begin(), times.end(), 101.0);
  ASSERT_NE(critical, times.end());
  ASSERT_NE(minor, times.end());
  EXPECT_LT(critical, minor) << "the gravest lane above";
  EXPECT_GT(std::count(times.begin(), times.end(), 100.0), 8) << "a lane is high enough to be hit";
}

}  // namespace
}  // namespace calot::gui
