// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QWidget>

#include "analytics/cohort/cohort_database.h"

class QLabel;

namespace calot::gui {

/// Who and what an attempt is, its verification badge, and whether a performer made it. Stands over everything that is
/// shown of one attempt.
class AttemptBanner : public QWidget {
  Q_OBJECT
 public:
  explicit AttemptBanner(QWidget* parent = nullptr);
  void showAttempt(const analytics::AttemptRow& attempt);
  /// For half a window: the mark of performers in one word.
  void makeNarrow();
  void showText(const QString& text);  ///< no attempt

 protected:
  void changeEvent(QEvent* event) override;

 private:
  void colourBadge();

  analytics::Verdict verdict_ = analytics::Verdict::notChecked;
  QLabel* watermark_;
  QLabel* identity_;
  QLabel* badge_;
};

}  // namespace calot::gui
