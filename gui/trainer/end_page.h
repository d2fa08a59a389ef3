// SPDX-License-Identifier: GPL-3.0-or-later
// How an attempt went, for whoever made it: the figures that count, against a norm and against the last time.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <QString>
#include <QWidget>

#include "gui/attempt/long_work.h"
#include "gui/attempt/pair_replay.h"
#include "gui/attempt/replay_transport.h"
#include "gui/trainer/attempt_report.h"
#include "gui/trainer/scenes_page.h"
#include "gui/trainer/training_session.h"

class QLabel;
class QListWidget;
class QPushButton;

namespace calot::gui {

class ScenePictureWidget;
class VerdictCard;
class WorkStrip;

/// After an attempt: how it ended, the figures that count against the norm and against the last time, and what went
/// wrong, each moment to be seen again with one click. A branch stands beside its parent, both from where it left it,
/// with what it did otherwise in figures. One button puts the attempt into the cohort, verified as `calot assess`
/// verifies. Of an assessment it shows the outcome alone: figures and mistakes are a score.
class EndPage : public QWidget {
  Q_OBJECT
 public:
  struct Setup {
    std::filesystem::path cohort;  ///< may not exist yet; empty: none
    unsigned threads = 1;          ///< of the verification
  };
  explicit EndPage(Setup setup);
  ~EndPage() override;

  void setMode(recorder::Mode mode);
  /// How an attempt ended.
  struct Ended {
    QString result;  ///< what the panel says of it
    double stepSeconds = 0.01;
    Purpose purpose = Purpose::own;
    bool next = false;  ///< there is a task after this one
  };
  /// @param status of an attempt that has ended
  void showAttempt(const TrainingStatus& status, const Ended& ended);
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

 protected:
  void resizeEvent(QResizeEvent* event) override;

 private:
  void limitPictures();
  QWidget* buildReplay();
  QWidget* buildWords();
  void read();
  void openReplays(const TrainingStatus& status);
  void alignReplays();
  void showReport(const AttemptReport& report, const std::optional<Lesson>& lesson);
  void replayMoment();
  void playFrom(double time);
  void store();
  void showStoring();

  Setup setup_;
  recorder::Mode mode_ = recorder::Mode::practice;
  bool reading_ = false, synthetic_ = false, inCohort_ = false, kept_ = true;
  std::filesystem::path file_;
  std::string attempt_, storing_;  ///< uuids
  std::shared_ptr<const std::vector<analytics::ErrorLine>> errors_;
  std::optional<AttemptFacts> shown_, earlier_;  ///< of this window, the one before it

  QLabel *title_, *syntheticMark_, *outcome_, *norm_, *previous_, *lesson_, *figures_, *momentsTitle_, *storeText_;
  VerdictCard* verdict_;
  QListWidget* moments_;
  QPushButton *store_, *back_, *again_, *next_, *scenes_;
  QWidget* replaySide_;
  ScenePictureWidget *picture_, *parentPicture_;
  QWidget *parentSide_, *nowTitle_;
  LongWork work_;
  WorkStrip* strip_;
  std::unique_ptr<Replay> replay_, parentReplay_;
  std::unique_ptr<PairReplay> pair_;
  QWidget *transport_, *pairTransport_;
  std::filesystem::path parent_;  ///< recording of a branch's parent; empty: no branch
  double branchedAt_ = 0.0;       ///< s
  Background background_;
};

}  // namespace calot::gui
