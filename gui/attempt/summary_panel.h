// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QWidget>

#include "analytics/assessment/grade.h"

class QLabel;

namespace calot::gui {

/// Summary for an instructor, in words: verdict, critical view, errors, and the figures that count.
class SummaryPanel : public QWidget {
  Q_OBJECT
 public:
  explicit SummaryPanel(QWidget* parent = nullptr);
  void showSummary(const analytics::AttemptSummary& summary);

 private:
  QLabel* verdict_;
  QLabel* criticalView_;
  QLabel* errors_;
  QLabel* figures_;
};

/// "Path length of the instrument's tip: left 179 mm, right 696 mm"
[[nodiscard]] QString keyFigureText(const analytics::KeyFigure& figure);

}  // namespace calot::gui
