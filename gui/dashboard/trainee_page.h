// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "gui/dashboard/figures_page.h"
#include "gui/dashboard/trainee_history.h"

class QComboBox;
class QLabel;
class QTableWidget;

namespace calot::gui {

class PlotView;

/// One person's attempts over time: a figure's learning curve, and every attempt with its badge.
class TraineePage : public FiguresPage {
  Q_OBJECT
 public:
  explicit TraineePage(QWidget* parent = nullptr);

 protected:
  void takeValues() override;

 private:
  void connectParts();
  void fillKeys();
  void redraw();
  void fillTable(const TraineeHistory& history);
  void fillTasks(const Trainee& trainee, std::size_t figure, const std::vector<analytics::Norm>& norms);
  void showGoal(const TraineeHistory& history, const std::vector<analytics::Norm>& norms);

  std::vector<Trainee> trainees_;

  QComboBox* trainee_ = nullptr;
  QComboBox* figure_ = nullptr;
  QComboBox* key_ = nullptr;
  PlotView* chart_ = nullptr;
  QLabel* goal_ = nullptr;
  QTableWidget* tasks_ = nullptr;
  QTableWidget* table_ = nullptr;
};

}  // namespace calot::gui
