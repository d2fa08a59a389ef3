// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QWidget>
#include <vector>

#include "analytics/checkpoints/error_words.h"
#include "gui/words/attempt_summary.h"

class QLabel;
class QPushButton;

namespace calot::gui {

/// The verdict on an attempt: safe or not, the critical view, and what went wrong, the gravest first. Once the
/// recording was read, each error leads to its moment, and a button to the gravest.
class VerdictCard : public QWidget {
  Q_OBJECT
 public:
  VerdictCard();
  void showSummary(const AttemptSummary& summary);
  /// @param errors of the recording, the gravest first
  void showErrors(const std::vector<analytics::ErrorLine>& errors);

 signals:
  void timeChosen(double seconds);

 private:
  QLabel *safety_, *verdict_, *criticalView_, *errors_;
  QPushButton* show_;
  double gravest_ = 0.0;  ///< when (s)
};

}  // namespace calot::gui
