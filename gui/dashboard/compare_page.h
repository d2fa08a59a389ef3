// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <QWidget>
#include <vector>

#include "gui/attempt/background.h"
#include "gui/dashboard/cohort_document.h"
#include "gui/dashboard/comparison.h"

class QCheckBox;
class QComboBox;
class QLabel;

namespace calot::gui {

class ComparisonChart;

/// One checkpoint over attempts by group, within one comparability key.
class ComparePage : public QWidget {
  Q_OBJECT
 public:
  explicit ComparePage(QWidget* parent = nullptr);
  /// @pre not null. The values are read when the page is first shown.
  void setDocument(std::shared_ptr<const CohortDocument> document);
  [[nodiscard]] bool ready() const { return ready_; }  ///< the values were read

 signals:
  void problem(const QString& message);
  void attemptActivated(const QString& uuid);

 protected:
  void showEvent(QShowEvent* event) override;

 private:
  void readValues();
  void takeValues(std::shared_ptr<const FigureValues> values);
  void redraw();

  std::shared_ptr<const CohortDocument> document_;
  bool read_ = false, ready_ = false;
  Background background_;
  std::shared_ptr<const FigureValues> values_;  ///< null: they could not be read
  std::vector<std::string> keys_;
  QComboBox* figure_ = nullptr;
  QComboBox* groupBy_ = nullptr;
  QComboBox* key_ = nullptr;
  QCheckBox* synthetic_ = nullptr;
  ComparisonChart* chart_ = nullptr;
  QLabel* caption_ = nullptr;
};

}  // namespace calot::gui
