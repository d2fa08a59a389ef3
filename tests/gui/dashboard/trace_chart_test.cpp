// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/timeline.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <QImage>
#include <QTest>

#include "tests/gui/dashboard/support/recorded.h"

namespace calot::gui {
namespace {

const QColor blueOfOkabeAndIto(0x00, 0x72, 0xb2);

QImage pictureOf(TraceChart& chart) { return chart.grab().toImage().convertToFormat(QImage::Format_RGB32); }

/// Pixels of a column that are more like the colour than like the ground.
int coloured(const QImage& picture, int x, const QColor& colour) {
  int count = 0;
  for (int y = 0; y < picture.height(); ++y) {
    const QColor at = picture.pixelColor(x, y);
    const auto away = [&](const QColor& c) {
      return std::abs(at.red() - c.red()) + std::abs(at.green() - c.green()) + std::abs(at.blue() - c.blue());
    };
    count += away(colour) < 150 ? 1 : 0;
  }
  return count;
}

TEST(TraceChart, AxisEndsAtAShortNumberAboveTheLargest) {
  EXPECT_DOUBLE_EQ(axisTop(0.0), 1.0);
  EXPECT_DOUBLE_EQ(axisTop(0.07), 0.08);
  EXPECT_DOUBLE_EQ(axisTop(1.0), 1.0);
  EXPECT_DOUBLE_EQ(axisTop(1.1), 2.0);
  EXPECT_DOUBLE_EQ(axisTop(4.3), 5.0);
  EXPECT_DOUBLE_EQ(axisTop(93.0), 100.0);
  EXPECT_DOUBLE_EQ(axisTop(640.0), 800.0);
}

TEST(TraceChart, LineOfTheReplayMovesAndTheTracesStay) {
  test::startApplication();
  TraceChart chart("force-trace", "Force");
  chart.resize(800, 104);
  // Left: 0 but for the last quarter; right: always 0.
  std::array<std::vector<double>, handCount> values;
  values[0].assign(100, 0.0);
  for (std::size_t i = 75; i < 100; ++i) values[0][i] = 4.0;
  values[1].assign(100, 0.0);
  chart.setTraces(100.0, 1.0, values);
  chart.setPosition(25.0);
  const TimeScale scale{100.0, 800.0};
  const int early = static_cast<int>(scale.x(25.0)), late = static_cast<int>(scale.x(60.0));
  const QImage before = pictureOf(chart);
  EXPECT_GT(coloured(before, early, Qt::black), 40);
  EXPECT_LT(coloured(before, late, Qt::black), 10);
  chart.setPosition(60.0);
  const QImage after = pictureOf(chart);
  EXPECT_LT(coloured(after, early, Qt::black), 10);
  EXPECT_GT(coloured(after, late, Qt::black), 40);
  // The step of the left hand's force, between two bins.
  int blue = 0;
  for (int x = static_cast<int>(scale.x(74.0)); x <= static_cast<int>(scale.x(76.0)); ++x)
    blue += coloured(after, x, blueOfOkabeAndIto);
  EXPECT_GT(blue, 30);
  int between = 0;
  for (int x = 0; x < 12; ++x) between += coloured(after, static_cast<int>(scale.x(50.0)) + x, blueOfOkabeAndIto);
  EXPECT_GT(between, 1) << "0 is a line along the axis, seen between the other hand's dashes";
  EXPECT_LT(between, 13);

  chart.clear();
  EXPECT_LT(coloured(pictureOf(chart), late, Qt::black), 10) << "no attempt has no moment";
}

TEST(TraceChart, AClickIsAMoment) {
  test::startApplication();
  TraceChart chart("force-trace", "Force");
  chart.resize(800, 104);
  double chosen = -1.0;
  QObject::connect(&chart, &TraceChart::timeChosen, [&](double time) { chosen = time; });
  QTest::mouseClick(&chart, Qt::LeftButton, {}, QPoint(400, 50));
  EXPECT_EQ(chosen, -1.0) << "nothing is shown";
  std::array<std::vector<double>, handCount> values;
  values[0].assign(10, 1.0);
  chart.setTraces(10.0, 1.0, values);
  const TimeScale scale{10.0, 800.0};
  QTest::mouseClick(&chart, Qt::LeftButton, {}, QPoint(400, 50));
  EXPECT_DOUBLE_EQ(chosen, scale.time(400.0));
}

}  // namespace
}  // namespace calot::gui
