// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <QWidget>

#include "gui/attempt/long_work.h"
#include "gui/attempt/replay_transport.h"
#include "gui/trainer/attempt_report.h"
#include "gui/trainer/training_session.h"

class QLabel;
class QListWidget;
class QPushButton;

namespace calot::gui {

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
  explicit EndPage(Setup setup, QWidget* parent = nullptr);
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
  QWidget* buildButtons();
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
