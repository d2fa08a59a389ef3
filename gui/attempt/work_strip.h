// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QWidget>

#include "gui/attempt/long_work.h"

class QLabel;
class QProgressBar;
class QPushButton;

namespace calot::gui {

/// How long work goes: what is being done, how far, what is left, and a button that breaks it off. Hidden in between.
class WorkStrip : public QWidget {
  Q_OBJECT
 public:
  /// @param work outlives this
  explicit WorkStrip(LongWork& work, QWidget* parent = nullptr);
  void begin(const QString& what);

 private:
  QLabel* text_;
  QProgressBar* bar_;
  QPushButton* cancel_;
};

}  // namespace calot::gui
