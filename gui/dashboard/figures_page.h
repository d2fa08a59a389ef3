// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <QWidget>
#include <vector>

#include "gui/attempt/background.h"
#include "gui/dashboard/cohort_document.h"
#include "gui/dashboard/comparison.h"

class QComboBox;
class QHBoxLayout;
class QLabel;

namespace calot::gui {

/// A page about the figures of all attempts. They are read in the background when it is first shown.
class FiguresPage : public QWidget {
  Q_OBJECT
 public:
  /// @pre not null. The values are read when the page is first shown.
  void setDocument(std::shared_ptr<const CohortDocument> document);
  [[nodiscard]] bool ready() const { return ready_; }  ///< the values were read

 signals:
  void problem(const QString& message);
  void attemptActivated(const QString& uuid);

 protected:
  /// @param captionName of the caption, which the page puts into its layout
  FiguresPage(const char* captionName, QWidget* parent);
  void showEvent(QShowEvent* event) override;

  [[nodiscard]] const CohortDocument& document() const { return *document_; }  ///< @pre ready()
  [[nodiscard]] const FigureValues* values() const { return values_.get(); }   ///< null: they could not be read
  [[nodiscard]] QLabel* caption() const { return caption_; }

  /// The document's values were read, or could not be: the page fills its choices and is drawn.
  virtual void takeValues() = 0;
  /// Figures to choose from; the one that was chosen stays so, where it is still there.
  void fillFigures(QComboBox* box) const;
  /// A choice with its label in a row.
  static QComboBox* addChoice(QHBoxLayout* row, const char* name, const char* text, int stretch);

 private:
  void readValues();

  std::shared_ptr<const CohortDocument> document_;
  std::shared_ptr<const FigureValues> values_;
  bool read_ = false, ready_ = false;
  QLabel* caption_;
  Background background_;
};

}  // namespace calot::gui

class QCheckBox;
class QComboBox;

namespace calot::gui {

class PlotView;

/// One checkpoint over attempts by group, within one comparability key.
class ComparePage : public FiguresPage {
  Q_OBJECT
 public:
  explicit ComparePage(QWidget* parent = nullptr);

 protected:
  void takeValues() override;

 private:
  void redraw();

  std::vector<std::string> keys_;
  QComboBox* figure_ = nullptr;
  QComboBox* groupBy_ = nullptr;
  QComboBox* key_ = nullptr;
  QCheckBox* synthetic_ = nullptr;
  PlotView* chart_ = nullptr;
};

}  // namespace calot::gui

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
