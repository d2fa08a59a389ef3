// SPDX-License-Identifier: GPL-3.0-or-later
// Letters that no palette colours: in the study's tables and in plots.
#include <gtest/gtest.h>

#include <QApplication>
#include <QTextCursor>
#include <QTextDocument>
#include <QTextTable>

#include "gui/attempt/widget_parts.h"
#include "gui/dashboard/plot_view.h"
#include "gui/dashboard/study_view.h"
#include "tests/gui/dashboard/support/recorded.h"

namespace calot::gui {
namespace {

class Contrast : public testing::TestWithParam<theme::Choice> {
 protected:
  void SetUp() override {
    test::startApplication();
    theme::apply(GetParam(), theme::usualType);
  }
  void TearDown() override { theme::apply(theme::Choice::system, theme::usualType); }
};

/// Of a colour that is laid over another.
QColor over(const QColor& ground, const QBrush& veil) {
  if (veil.style() == Qt::NoBrush) return ground;
  const QColor c = veil.color();
  const auto mixed = [&](int below, int above) {
    return static_cast<int>(below + (above - below) * static_cast<double>(c.alphaF()));
  };
  return {mixed(ground.red(), c.red()), mixed(ground.green(), c.green()), mixed(ground.blue(), c.blue())};
}

TEST_P(Contrast, OfTheStudysTables) {
  analytics::Study study;
  study.groups = {"novice", "expert"};
  for (const char* name : {"path-length", "elapsed-time", "organ-burned"}) {
    analytics::StudyRow row;
    row.checkpoint = row.title = name;
    row.leading = true;
    row.values = {std::vector{1.0, 2.0, 3.0}, std::vector{4.0, 5.0, 6.0}};
    study.rows.push_back(row);
  }
  QTextDocument text;
  text.setHtml(QString::fromStdString(studyText(study)));
  const QColor letters = QApplication::palette().color(QPalette::Text);
  const QColor ground = QApplication::palette().color(QPalette::Base);
  int cells = 0, veiled = 0;
  for (QTextFrame* frame : text.rootFrame()->childFrames()) {
    const auto* table = qobject_cast<QTextTable*>(frame);
    if (table == nullptr) continue;
    for (int r = 0; r < table->rows(); ++r) {
      for (int c = 0; c < table->columns(); ++c, ++cells) {
        const QBrush veil = table->cellAt(r, c).format().background();
        veiled += veil.style() == Qt::NoBrush ? 0 : 1;
        const QColor behind = over(ground, veil);
        EXPECT_GE(theme::contrast(letters, behind), theme::leastContrast)
            << letters.name().toStdString() << " on " << behind.name().toStdString();
        if (r == 0) {
          EXPECT_NE(behind, ground) << "a head that does not stand out";
        }
      }
    }
  }
  EXPECT_GT(cells, 20);
  EXPECT_GT(veiled, 10);
}

TEST_P(Contrast, OfPlotsLettersAndGrid) {
  const auto shown = [](analytics::Ink ink, bool stroke) {
    const analytics::InkStyle& style = analytics::styleOf(ink);
    return theme::contrast(onScreen(QColor(stroke ? style.stroke : style.fill)), theme::surface());
  };
  using analytics::Ink;
  for (const Ink ink : {Ink::heading, Ink::tick, Ink::axis, Ink::group, Ink::label, Ink::count})
    EXPECT_GE(shown(ink, false), theme::leastContrast) << analytics::styleOf(ink).name;
  for (const Ink ink : {Ink::median, Ink::cut, Ink::firstLine, Ink::secondLine, Ink::hollowPoint})
    EXPECT_GE(shown(ink, true), 3.0) << analytics::styleOf(ink).name;
  for (const Ink ink : {Ink::firstPoint, Ink::secondPoint}) EXPECT_GE(shown(ink, false), 3.0);
  EXPECT_LT(shown(Ink::grid, true), 2.0) << "a grid that outshines the curve";
}

TEST_P(Contrast, OfAPlotFollowsTheColours) {
  PlotView plot("plot", "Plot");
  plot.resize(400, 300);
  plot.show("ROC", [](const analytics::PlotFrame& frame) {
    return drawRoc(rocOf({1.0, 2.0, 4.0}, {3.0, 5.0, 6.0}, true), "ROC", frame);
  });
  const auto ground = [&] { return plot.grab().toImage().pixelColor(2, 2); };
  EXPECT_EQ(ground(), theme::surface());
  theme::apply(GetParam() == theme::Choice::dark ? theme::Choice::light : theme::Choice::dark, theme::usualType);
  QApplication::processEvents();
  EXPECT_EQ(ground(), theme::surface());
}

INSTANTIATE_TEST_SUITE_P(Colours, Contrast, testing::Values(theme::Choice::light, theme::Choice::dark),
                         [](const auto& which) { return theme::wordOf(which.param).toStdString(); });

}  // namespace
}  // namespace calot::gui
