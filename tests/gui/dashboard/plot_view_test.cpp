// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <QSignalSpy>
#include <QTest>
#include <variant>

#include "analytics/report/plots.h"
#include "gui/dashboard/plot_view.h"
#include "tests/gui/dashboard/support/recorded.h"

namespace calot::gui {
namespace {

TEST(PlotView, HasAWholeWatermarkInAnySize) {
  test::startApplication();
  PlotView plot("plot", "Plot");
  EXPECT_FALSE(plot.hasWatermark());
  const auto draw = [](const analytics::PlotFrame& frame) {
    analytics::HistoryPlot history;
    history.title = "t";
    history.values = {{1.0, 3.0}, {2.0, 4.0}};
    history.synthetic = true;
    history.frame = frame;
    return analytics::drawHistory(history);
  };
  for (const QSize size : {QSize(1200, 700), QSize(480, 300), QSize(200, 600), QSize(60, 40)}) {
    plot.resize(size);
    plot.show("t", draw, true);
    const analytics::Drawing& drawing = plot.drawing();
    EXPECT_TRUE(plot.hasWatermark());
    ASSERT_EQ(drawing.shapes.back().ink, analytics::Ink::watermark);
    const auto& text = std::get<analytics::DrawnText>(drawing.shapes.back().form);
    EXPECT_NEAR(text.x, 0.5 * drawing.width, 1.0);
    // Nine bold letters aslant take 270 by 175 units at most.
    EXPECT_GE(drawing.width, 290.0) << size.width() << " x " << size.height();
    EXPECT_GE(drawing.height, 179.0) << size.width() << " x " << size.height();
  }
}

TEST(PlotView, ChoosesMarksByKeyAndByMouse) {
  test::startApplication();
  PlotView plot("plot", "Plot");
  plot.resize(480, 300);
  plot.show("t", [](const analytics::PlotFrame& frame) {
    analytics::Drawing drawing{"t", frame.width, frame.height, {}};
    drawing.marks = {{200.0, 100.0, "b", "the second"}, {100.0, 100.0, "a", "the first"}};
    return std::optional(drawing);
  });
  QSignalSpy chosen(&plot, &PlotView::attemptChosen);
  QTest::keyClick(&plot, Qt::Key_Return);
  EXPECT_EQ(chosen.count(), 0) << "nothing is chosen yet";
  QTest::keyClick(&plot, Qt::Key_Right);
  EXPECT_EQ(plot.accessibleDescription(), "the first");
  QTest::keyClick(&plot, Qt::Key_Return);
  QTest::mouseClick(&plot, Qt::LeftButton, {}, plot.placeOf(plot.marks()[1]).toPoint() + QPoint(3, 3));
  QTest::mouseClick(&plot, Qt::LeftButton, {}, QPoint(5, 5));
  ASSERT_EQ(chosen.count(), 2);
  EXPECT_EQ(chosen[0][0].toString(), "a");
  EXPECT_EQ(chosen[1][0].toString(), "b");
}

}  // namespace
}  // namespace calot::gui
