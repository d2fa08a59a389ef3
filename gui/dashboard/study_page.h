// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "gui/attempt/long_work.h"
#include "gui/dashboard/page_parts.h"
#include "gui/dashboard/study_view.h"

class QTextBrowser;

namespace calot::gui {

class PlotView;

/// Two groups side by side, one value per participant: tables, box plots with points, ROC, effect sizes, export. A
/// study is computed on another thread, and can be broken off.
class StudyPage : public CohortPage {
  Q_OBJECT
 public:
  StudyPage();
  /// Writes what is shown, on another thread: as HTML, or CSV into a folder; what is there is replaced.
  void write(const QString& target, bool html);
  bool makeDocument(const Taker& take) override;
  [[nodiscard]] bool busy() const { return work_.busy(); }  ///< computing, or writing
  [[nodiscard]] bool ready() const { return study_ != nullptr; }

 signals:
  void studyShown();  ///< or its refusal
  void written();     ///< write() has ended, well or not

 private:
  void read() override;
  QLayout* buildChoices();
  void connectParts();
  void fillProtocols();
  void allowChoices();
  void make();
  struct Computed;
  /// @param computed null: there is no study
  void take(const std::shared_ptr<Computed>& computed);
  void showRow();
  void saveAs(bool html);

  std::string path_;  ///< of the cohort that the choices are from
  bool made_ = false;
  bool checked_ = false;  ///< the document as it is, by a study of it
  std::shared_ptr<const analytics::Study> study_;
  LongWork work_;
  std::shared_ptr<Computed> computed_;  ///< what work_ computes, or null: it writes

  GroupFields fields_;
  QComboBox* rule_;
  QComboBox* protocol_;
  QLabel* state_;
  WorkStrip* strip_;
  QTextBrowser* text_;
  QComboBox* row_;
  QLabel* effect_;
  PlotView* boxes_;
  PlotView* roc_;
  QPushButton* csv_;
  QPushButton* html_;
};

}  // namespace calot::gui
