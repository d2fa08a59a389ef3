// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <optional>

#include "analytics/assessment/rating_form.h"
#include "gui/dashboard/page_parts.h"
#include "gui/dashboard/recording_view.h"

class QButtonGroup;

namespace calot::gui {

/// Forms to be filled in: raters judge the attempt that is selected, beside its replay, participants what they took
/// part in. Who acted is hidden unless it is asked for. What is not stored yet is kept as a draft. Nothing is stored
/// before every item is answered or left blank on purpose.
class RatingPage : public CohortPage {
  Q_OBJECT
 public:
  RatingPage();
  /// True if the replay stands where it was sent to, or there is none.
  [[nodiscard]] bool settled() const { return replay_->settled(); }
  /// Offers the forms in `forms/` of these folders, best first (recorder::ProgramFiles).
  void readForms(const std::vector<std::filesystem::path>& folders);
  void chooseForm(const QString& name);
  void setAttempt(const analytics::AttemptRow& attempt);

 signals:
  /// The rating is stored: the next attempt is wanted.
  void nextWanted();

 private:
  void read() override;
  void connectParts();
  void showForm();
  void addItem(QVBoxLayout& layout, const analytics::FormItem& item);
  void showSubject();
  void showEarlier();
  void showState();
  bool store();
  void openReplay();
  struct Subject;
  [[nodiscard]] Subject subject() const;  ///< @pre form() is not null
  [[nodiscard]] const analytics::RatingForm* form() const;

  std::optional<analytics::AttemptRow> attempt_;
  std::vector<analytics::RatingForm> forms_;
  QString fault_;                                      ///< why one of the forms cannot be read
  std::map<std::string, std::optional<int>> answers_;  ///< so far; none: left blank
  bool replaces_ = false;                              ///< who fills it in has filled it in before

  QComboBox* choice_;
  QLabel* source_;
  AttemptBanner* banner_;
  QLabel* raterLabel_;
  QLineEdit* rater_;
  QLabel* participantLabel_;
  QComboBox* participant_;
  QScrollArea* area_;
  std::vector<std::pair<std::string, QButtonGroup*>> groups_;
  QLabel* state_;
  QPushButton *store_, *next_;
  QCheckBox* reveal_;
  RecordingView* replay_;
  std::string shown_;  ///< uuid whose replay was opened
};

}  // namespace calot::gui
