// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QWidget>

#include "gui/dashboard/import_queue.h"

class QLabel;
class QPushButton;

namespace calot::gui {

/// Page shown without a database, or with an empty one. Greets and says what to do.
class GreetingPage : public QWidget {
  Q_OBJECT
 public:
  explicit GreetingPage(AssessProgram program, QWidget* parent = nullptr);
  void explainNoDatabase();
  void explainEmptyDatabase(const QString& fileName);

 signals:
  void openRequested();
  void newRequested();
  void importRequested();

 private:
  AssessProgram program_;
  QLabel* title_;
  QLabel* text_;
  QPushButton* import_;
};

}  // namespace calot::gui
