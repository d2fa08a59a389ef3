// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <QWidget>

#include "gui/attempt/background.h"
#include "gui/dashboard/cohort_document.h"
#include "gui/dashboard/trainee_history.h"

class QComboBox;
class QLabel;
class QTableWidget;

namespace calot::gui {

class HistoryChart;

/// One person's attempts over time: a figure's learning curve, and every attempt with its badge.
class TraineePage : public QWidget {
  Q_OBJECT
 public:
  explicit TraineePage(QWidget* parent = nullptr);
  /// @pre not null. The values are read when the page is first shown.
  void setDocument(std::shared_ptr<const CohortDocument> document);
  [[nodiscard]] bool ready() const { return ready_; }  ///< the values were read

 signals:
  void problem(const QString& message);
  void attemptActivated(const QString& uuid);

 protected:
  void showEvent(QShowEvent* event) override;

 private:
  void connectParts();
  void readValues();
  void fillKeys();
  void redraw();
  void fillTable(const TraineeHistory& history);
  void fillTasks(const Trainee& trainee, std::size_t figure, const std::vector<analytics::Norm>& norms);
  void showGoal(const TraineeHistory& history, const std::vector<analytics::Norm>& norms);

  std::shared_ptr<const CohortDocument> document_;
  bool read_ = false, ready_ = false;
  std::shared_ptr<const FigureValues> values_;  ///< null: they could not be read
  std::vector<Trainee> trainees_;
  Background background_;

  QComboBox* trainee_ = nullptr;
  QComboBox* figure_ = nullptr;
  QComboBox* key_ = nullptr;
  HistoryChart* chart_ = nullptr;
  QLabel* goal_ = nullptr;
  QTableWidget* tasks_ = nullptr;
  QLabel* caption_ = nullptr;
  QTableWidget* table_ = nullptr;
};

}  // namespace calot::gui
