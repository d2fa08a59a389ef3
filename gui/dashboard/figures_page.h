// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "analytics/assessment/course_progress.h"
#include "gui/attempt/long_work.h"
#include "gui/dashboard/cohort_document.h"
#include "gui/dashboard/comparison.h"
#include "gui/dashboard/page_parts.h"

namespace calot::gui {

class PlotView;

/// A page about one figure of all attempts of a comparability key. Figures are read in the background when it is first
/// shown.
class FiguresPage : public CohortPage {
  Q_OBJECT
 public:
  [[nodiscard]] bool ready() const { return ready_; }  ///< the values were read

 protected:
  /// Makes its widgets, which the page puts into its layout. @param prefix of their names
  FiguresPage(const std::string& prefix, PlotView* chart);

  /// The document's values were read, or could not be: fills the choices other than the figure's, quietly.
  virtual void fillChoices() = 0;
  virtual void redraw() = 0;  ///< @pre ready()

  std::shared_ptr<const FigureValues> values_;  ///< null: they could not be read
  QComboBox* figure_;
  QComboBox* key_;
  PlotView* chart_;
  QLabel* caption_;

 private:
  void read() override;

  bool ready_ = false;
  Background background_;
};

/// One checkpoint over attempts by group.
class ComparePage : public FiguresPage {
  Q_OBJECT
 public:
  ComparePage();

 private:
  void fillChoices() override;
  void redraw() override;

  QComboBox* groupBy_;
  QCheckBox* synthetic_;
};

/// One person's attempts over time: a figure's learning curve, and every attempt with its badge; and what is missing
/// next in the course that was chosen last.
class TraineePage : public FiguresPage {
  Q_OBJECT
 public:
  TraineePage();
  void readCourse();  ///< another one was chosen

 private:
  void fillChoices() override;
  void showCourse();
  void fillKeys();
  void redraw() override;
  void fillTable(const TraineeHistory& history);
  void fillTasks(const Trainee& trainee, std::size_t figure, const std::vector<analytics::Norm>& norms);
  void showGoal(const TraineeHistory& history, const std::vector<analytics::Norm>& norms);

  std::vector<Trainee> trainees_;
  QComboBox* trainee_;
  QLabel* goal_;
  QLabel* missing_;  ///< in the course
  QTableWidget* tasks_;
  QTableWidget* table_;
  std::shared_ptr<const analytics::CourseProgress> course_;  ///< or null
  Background courseReader_;
};

}  // namespace calot::gui
