// SPDX-License-Identifier: GPL-3.0-or-later
// Progress of a trainee, from the cohort. No window.
#pragma once

#include <filesystem>
#include <optional>
#include <QString>
#include <QWidget>
#include <string>
#include <vector>

#include "analytics/cohort/cohort_database.h"
#include "gui/trainer/scene_choices.h"

class QComboBox;
class QLabel;
class QListWidget;
class QPushButton;

namespace calot::gui {

/// Purpose of an attempt.
enum class Purpose {
  own,            ///< the trainee's
  controls,       ///< the trainee's, who is asked for one control after the other; in practice
  demonstration,  ///< a performer's, to be watched: synthetic, without the trainee's pseudonym
};

/// One attempt of the past.
struct PastAttempt {
  std::string scene;
  std::string startUtc;
  double seconds = 0.0;
  recorder::Mode mode = recorder::Mode::practice;
  recorder::Outcome outcome = recorder::Outcome::running;
  bool branch = false;
  QString verdict;      ///< of the norm, one sentence; empty: there is none, or it is not judged
  bool passed = false;  ///< by the norm
};

/// A participant's attempts, the newest first; without those that performers made.
/// @param cohort may not exist yet; empty: none @throws Error as CohortDatabase
std::vector<PastAttempt> historyIn(const std::filesystem::path& cohort, const std::string& participant);

/// "Not tried yet", "3 attempts, 1 completed", "3 attempts, passed by the norm": how far a task is.
QString progressText(const std::vector<PastAttempt>& history, const std::string& scene);

/// "2026-02-03 14:05 UTC, practice: completed after 1:02.5": one attempt in a line, with what the norm finds.
QString pastText(const PastAttempt& attempt);

/// Page shown when no scene is given: greets, and offers the course's tasks and all other scenes with their pictures;
/// of the one that is chosen, what the trainee has done so far.
class ScenesPage : public QWidget {
  Q_OBJECT
 public:
  /// @param demonstrates a performer can be watched
  explicit ScenesPage(bool demonstrates);
  /// @param note beside it: which calibration is used, or why there is no assessment
  void showMode(recorder::Mode mode, const QString& note);
  void setScenes(const std::vector<SceneChoice>& scenes);
  /// @param history none: nobody's is known
  void setHistory(std::optional<std::vector<PastAttempt>> history);
  void focusList();

 signals:
  void chosen(const QString& file, calot::gui::Purpose purpose);
  void modeChosen(calot::recorder::Mode mode);
  void calibrationRequested();

 private:
  void showTexts();
  void showPast();

  std::vector<SceneChoice> choices_;
  std::optional<std::vector<PastAttempt>> history_;
  QListWidget *list_, *past_;
  QLabel *pastTitle_, *text_, *modeNote_;
  QComboBox* mode_;
  QPushButton* calibration_;
  bool demonstrates_;
  QWidget* pastSide_;
  QPushButton *begin_, *tutorial_, *demonstration_;
};

}  // namespace calot::gui
