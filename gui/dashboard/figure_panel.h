// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <QWidget>
#include <string>

#include "analytics/assessment/grade.h"
#include "analytics/report/attempt_sheet.h"
#include "gui/dashboard/cohort_document.h"
#include "gui/dashboard/family_tree_model.h"
#include "gui/words/attempt_summary.h"

class QComboBox;
class QLabel;
class QPushButton;
class QTreeView;

namespace calot::gui {

class PlotView;

/// Clicks on figures to moments of the replay: a figure's first click goes to the moment that made most of it, each
/// further one to the next in time, around.
class MomentCycle {
 public:
  /// How long before a moment's begin one looks at it (s): to see what led to it.
  static constexpr double leadIn = 0.5;

  /// @return when to look (s), or none where the figure has no moments
  std::optional<double> next(const analytics::FigureMoments& figure);
  void forget() { figure_.clear(); }

 private:
  std::string figure_;  ///< checkpoint and subject of the last click
  std::size_t at_ = 0;  ///< its moment
};

/// The figures of one attempt that count, as bars against the pass marks of a norm; all of them folded by family; and
/// its events, in groups. Choosing one asks for its moment.
class FigurePanel : public QWidget {
  Q_OBJECT
 public:
  FigurePanel();

  /// Reads and shows the figures; their moments and the events are still to come. @pre not null
  void setAttempt(std::shared_ptr<const CohortDocument> document, const analytics::AttemptRow& attempt);
  void clear();
  void setTrack(const std::vector<TrackEvent>& events, const std::vector<analytics::ErrorLine>& errors);
  /// In place of all moments, as long as there are none: "looking …".
  void setMomentsText(const QString& text) { figures_.setMomentsText(text); }
  void setMoments(const std::vector<analytics::FigureMoments>& moments);

  [[nodiscard]] const std::vector<analytics::CheckpointValue>& values() const { return values_; }
  [[nodiscard]] AttemptSummary summary() const;  ///< @pre an attempt is shown
  /// Moments worth a picture, by what is known of the recording.
  [[nodiscard]] std::vector<analytics::SheetMoment> worstMoments() const;
  [[nodiscard]] const std::vector<analytics::ErrorLine>& errors() const { return errors_; }
  /// Against the norm that is chosen; null if none is, or the attempt is not judged.
  [[nodiscard]] const analytics::Grade* grade() const;
  [[nodiscard]] const CheckpointTableModel& figures() const { return figures_; }
  /// Goes to the moments of a figure as soon as they are known.
  void goToFigure(const std::string& checkpoint, const std::string& subject);
  /// Goes to the gravest error, then to the next; without errors to the moments of the first figure that falls short of
  /// the norm, else of the first that has any.
  void showWorst();

 signals:
  void problem(const QString& message);
  void timeChosen(double seconds);
  void summaryChanged();
  /// The attempt is to be written as a sheet.
  void sheetRequested();
  void normRequested();
  /// Intervals in which a figure arose: beginnings and ends (s).
  void windowsChosen(const std::vector<std::pair<double, double>>& windows);

 private:
  void showStanding();
  void showBars();
  void showFigure(int row);
  void selectFigure(int row);

  std::shared_ptr<const CohortDocument> document_;
  std::optional<analytics::AttemptRow> attempt_;
  std::vector<analytics::CheckpointValue> values_;
  std::vector<analytics::ValueInterval> intervals_;
  std::optional<std::pair<std::string, std::string>> wanted_;  ///< figure to go to when its moments are known
  CheckpointTableModel figures_;
  FamilyTreeModel families_{figures_};
  QStandardItemModel events_{0, 2};
  std::vector<analytics::ErrorLine> errors_;
  std::size_t nextWorst_ = 0;  ///< of errors_
  MomentCycle cycle_;
  QComboBox* norm_;
  QLabel* verdict_;
  QPushButton *sheet_, *makeNorm_;
  std::optional<AttemptStanding> standing_;
  PlotView* bars_;
  QTreeView* figureTable_;
  QTreeView* eventTable_;
};

}  // namespace calot::gui
