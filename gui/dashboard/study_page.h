// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <QWidget>

#include "gui/attempt/long_work.h"
#include "gui/dashboard/cohort_document.h"
#include "gui/dashboard/study_view.h"

class QBoxLayout;
class QCheckBox;
class QComboBox;
class QLabel;
class QPushButton;
class QTextBrowser;

namespace calot::gui {

class PlotView;
class WorkStrip;

/// Two groups side by side, one value per participant: tables, box plots with points, ROC, effect sizes, export. A
/// study is computed on another thread, and can be broken off.
class StudyPage : public QWidget {
  Q_OBJECT
 public:
  explicit StudyPage(QWidget* parent = nullptr);
  /// @pre not null. The study is made when the page is first shown.
  void setDocument(std::shared_ptr<const CohortDocument> document);
  /// Writes what is shown, on another thread; what is there is replaced. @pre a study is shown
  void exportCsv(const QString& folder);
  void exportHtml(const QString& file);
  [[nodiscard]] bool busy() const { return work_.busy(); }  ///< computing, or writing
  [[nodiscard]] bool ready() const { return study_ != nullptr; }

 signals:
  void problem(const QString& message);
  void studyShown();  ///< or its refusal
  void written();     ///< exportCsv() or exportHtml() has ended, well or not

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
  struct Computed;
  void take(Computed& computed);
  void showRow();
  void write(const QString& target, bool html);
  void saveAs(bool html);

  std::shared_ptr<const CohortDocument> document_;
  bool made_ = false;
  bool checked_ = false;  ///< the document as it is, by a study of it
  std::shared_ptr<const analytics::Study> study_;
  LongWork work_;
  std::shared_ptr<Computed> computed_;  ///< what work_ computes, or null: it writes

  QComboBox* groupBy_ = nullptr;
  QComboBox* first_ = nullptr;
  QComboBox* second_ = nullptr;
  QComboBox* key_ = nullptr;
  QComboBox* rule_ = nullptr;
  QComboBox* protocol_ = nullptr;
  QCheckBox* synthetic_ = nullptr;
  QCheckBox* practice_ = nullptr;
  QLabel* state_ = nullptr;
  WorkStrip* strip_ = nullptr;
  QTextBrowser* text_ = nullptr;
  QComboBox* row_ = nullptr;
  QLabel* effect_ = nullptr;
  PlotView* boxes_ = nullptr;
  PlotView* roc_ = nullptr;
  QPushButton* csv_ = nullptr;
  QPushButton* html_ = nullptr;
};

}  // namespace calot::gui
