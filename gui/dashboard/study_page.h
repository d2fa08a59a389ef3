// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <QWidget>

#include "gui/attempt/background.h"
#include "gui/dashboard/cohort_document.h"
#include "gui/dashboard/study_view.h"

class QBoxLayout;
class QCheckBox;
class QComboBox;
class QLabel;
class QPushButton;
class QTextBrowser;

namespace calot::gui {

class ComparisonChart;
class RocChart;

/// Two groups side by side, one value per participant: tables, box plots with points, ROC, effect sizes, export.
class StudyPage : public QWidget {
  Q_OBJECT
 public:
  explicit StudyPage(QWidget* parent = nullptr);
  /// @pre not null. The study is made when the page is first shown.
  void setDocument(std::shared_ptr<const CohortDocument> document);
  /// Writes what is shown; what is there is replaced. @pre a study is shown
  void exportCsv(const QString& folder);
  void exportHtml(const QString& file);
  [[nodiscard]] bool ready() const { return study_.has_value(); }

 signals:
  void problem(const QString& message);
  void studyShown();  ///< or its refusal

 protected:
  void showEvent(QShowEvent* event) override;

 private:
  void buildChoices(QBoxLayout& layout);
  void connectParts();
  void fillChoices();
  void fillGroups();
  void fillProtocols();
  void allowChoices();
  void make();
  void take(StudyAnswer answer);
  void showForest();
  void showRow();
  void saveAs(bool html);

  std::shared_ptr<const CohortDocument> document_;
  bool made_ = false;
  std::optional<analytics::Study> study_;
  Background background_;

  QComboBox* groupBy_ = nullptr;
  QComboBox* first_ = nullptr;
  QComboBox* second_ = nullptr;
  QComboBox* key_ = nullptr;
  QComboBox* rule_ = nullptr;
  QComboBox* protocol_ = nullptr;
  QCheckBox* synthetic_ = nullptr;
  QCheckBox* practice_ = nullptr;
  QLabel* state_ = nullptr;
  QTextBrowser* text_ = nullptr;
  QComboBox* row_ = nullptr;
  QLabel* effect_ = nullptr;
  ComparisonChart* boxes_ = nullptr;
  RocChart* roc_ = nullptr;
  QPushButton* csv_ = nullptr;
  QPushButton* html_ = nullptr;
};

}  // namespace calot::gui
