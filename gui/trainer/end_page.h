// SPDX-License-Identifier: GPL-3.0-or-later
// How an attempt went, for whoever made it: the figures that count, against a norm and against the last time.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <QString>
#include <QWidget>
#include <vector>

#include "analytics/assessment/grade.h"
#include "analytics/cohort/cohort_database.h"
#include "gui/attempt/long_work.h"
#include "gui/attempt/replay_transport.h"
#include "gui/trainer/training_session.h"

class QLabel;
class QListWidget;
class QPushButton;

namespace calot::gui {

/// An attempt and its figures, from the cohort where it is in it, else from what its recording says of itself.
struct AttemptFacts {
  analytics::AttemptRow attempt;
  std::vector<analytics::CheckpointValue> values;
  std::vector<analytics::ValueInterval> intervals;
  bool inCohort = false;
};

/// One figure that counts.
struct FigureReport {
  QString title;   ///< "Elapsed time"
  QString now;     ///< "41.2 s"
  QString norm;    ///< "pass mark 38.0 s, competent people 20.1 to 35.5 s: falls short", or empty
  QString before;  ///< "52.0 s, better by 10.8 s", or empty
};

struct AttemptReport {
  AttemptFacts facts;
  analytics::AttemptSummary summary;
  QString norm;      ///< what it is held against, and what that finds; or why there is none
  QString previous;  ///< which attempt it is compared with, or why there is none
  std::vector<FigureReport> figures;
};

/// @param file a recording that was written to its end @param cohort may not exist yet; empty: none
/// @throws Error as recorder::Recording and CohortDatabase
AttemptFacts readFacts(const std::filesystem::path& file, const std::filesystem::path& cohort);

/// The participant's attempt before this one at the same task: same comparability key, whole, no branch, and made by
/// the same kind of operator. None for an attempt without a pseudonym.
std::optional<AttemptFacts> previousInCohort(const AttemptFacts& now, const std::filesystem::path& cohort);

/// Norms of a cohort. @param cohort may not exist yet; empty: none
std::vector<analytics::Norm> normsOf(const std::filesystem::path& cohort);

/// @param previous none: there is none
AttemptReport reportOf(AttemptFacts now, const std::optional<AttemptFacts>& previous,
                       const std::vector<analytics::Norm>& norms);

class ScenePictureWidget;
class WorkStrip;

/// After an attempt: how it ended, the figures that count against the norm and against the last time, and what went
/// wrong, each moment to be seen again with one click. One button puts the attempt into the cohort, verified as `calot
/// assess` verifies. Of an assessment it shows the outcome alone: figures and mistakes are a score.
class EndPage : public QWidget {
  Q_OBJECT
 public:
  struct Setup {
    recorder::Mode mode = recorder::Mode::practice;
    std::filesystem::path cohort;  ///< may not exist yet; empty: none
    unsigned threads = 1;          ///< of the verification
  };
  explicit EndPage(Setup setup);
  ~EndPage() override;

  /// @param status of an attempt that has ended @param result what the panel says of it @param next there is a task
  /// after this one
  void showAttempt(const TrainingStatus& status, const QString& result, double stepSeconds, bool next);
  /// Another page comes: the replay ends. What is being put into the cohort goes on.
  void leave();
  /// Nothing more is to come by itself.
  [[nodiscard]] bool settled() const;
  [[nodiscard]] Replay& replay() { return *replay_; }
  [[nodiscard]] bool storing() const { return work_.busy(); }

 signals:
  void againRequested();
  void nextRequested();
  void scenesRequested();
  void backRequested(double time);
  void problem(const QString& message);
  void stored();

 private:
  QWidget* buildReplay();
  QWidget* buildWords();
  void read();
  void showReport(const AttemptReport& report);
  void replayMoment();
  void store();
  void showStoring();

  Setup setup_;
  bool reading_ = false, synthetic_ = false, inCohort_ = false;
  std::filesystem::path file_;
  std::string attempt_, storing_;                ///< uuids
  std::optional<AttemptFacts> shown_, earlier_;  ///< of this window, the one before it

  QLabel *title_, *syntheticMark_, *outcome_, *verdict_, *norm_, *previous_, *figures_, *momentsTitle_, *storeText_;
  QListWidget* moments_;
  QPushButton *store_, *back_, *again_, *next_, *scenes_;
  QWidget* replaySide_;
  ScenePictureWidget* picture_;
  LongWork work_;
  WorkStrip* strip_;
  std::unique_ptr<Replay> replay_;
  Background background_;
};

}  // namespace calot::gui
