// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QWidget>

#include "gui/attempt/long_work.h"

class QLabel;
class QProgressBar;
class QPushButton;
class QTimer;

namespace calot::gui {

/// How long work goes: what is being done, how far, what is left, and a button that breaks it off. Hidden in between.
class WorkStrip : public QWidget {
  Q_OBJECT
 public:
  /// @param work outlives this
  explicit WorkStrip(LongWork& work, QWidget* parent = nullptr);
  /// @param after ms: shorter work shows nothing, so that a page does not jump
  void begin(const QString& what, int after = 0);

 private:
  QLabel* text_;
  QProgressBar* bar_;
  QPushButton* cancel_;
  QTimer* appear_;
};

}  // namespace calot::gui
