// SPDX-License-Identifier: GPL-3.0-or-later
// Rating forms. A form that is not stored yet is kept among the user's settings: a rater who is called away goes on
// where they were.
#pragma once

#include <filesystem>
#include <map>
#include <optional>

#include "analytics/assessment/rating_form.h"
#include "analytics/cohort/assessment_database.h"
#include "gui/dashboard/cohort_document.h"
#include "gui/dashboard/page_parts.h"
#include "gui/dashboard/recording_view.h"

namespace calot::gui {

/// Forms that come with the program, by name, and why one cannot be read.
struct KnownForms {
  std::vector<analytics::RatingForm> forms;
  std::vector<std::string> faults;
};
/// @param folders that may hold `forms/`, best first (recorder::ProgramFiles)
KnownForms readForms(const std::vector<std::filesystem::path>& folders);

/// Answers so far: a score, or "left blank"; nothing yet for the others.
class RatingDraft {
 public:
  explicit RatingDraft(const analytics::RatingForm& form) : form_(form) {}
  /// @pre the form has such an item; @param score of the scale, none: left blank
  void answer(const std::string& item, std::optional<int> score) { answers_[item] = score; }
  [[nodiscard]] std::size_t answered() const { return answers_.size(); }
  [[nodiscard]] bool complete() const { return answers_.size() == form_.items().size(); }
  [[nodiscard]] const std::map<std::string, std::optional<int>>& answers() const { return answers_; }
  [[nodiscard]] const analytics::RatingForm& form() const { return form_; }

  /// Stores it as `calot rate` does. @param attempt, rater of a form about attempts; @param participant of the others
  /// @throws Error (invalid) for an item without answer, all blank, or a missing name; (refused) as
  /// AssessmentDatabase::storeRating
  void store(const std::string& database, const std::string& attempt, const std::string& rater,
             const std::string& participant, bool replace) const;

 private:
  const analytics::RatingForm& form_;
  std::map<std::string, std::optional<int>> answers_;
};

/// Earlier answers of this rater (participant), to be changed; none if there are none.
std::optional<analytics::Rating> earlierRating(const std::vector<analytics::Rating>& ratings,
                                               const analytics::RatingForm& form, const std::string& attempt,
                                               const std::string& rater, const std::string& participant);

/// Identity of a draft.
struct DraftSubject {
  std::string database, form;
  std::uint32_t formVersion = 1;
  std::string attempt, rater, participant;
};
using DraftAnswers = std::map<std::string, std::optional<int>>;  ///< by item; none: left blank

void keepDraft(const DraftSubject& subject, const DraftAnswers& answers);
[[nodiscard]] DraftAnswers keptDraft(const DraftSubject& subject);  ///< empty: there is none
void dropDraft(const DraftSubject& subject);

}  // namespace calot::gui

class QButtonGroup;
class QScrollArea;

namespace calot::gui {

/// Forms to be filled in: raters judge the attempt that is selected, beside its replay, participants what they took
/// part in. Who acted is hidden unless it is asked for. What is not stored yet is kept as a draft. Nothing is stored
/// before every item is answered or left blank on purpose.
class RatingPage : public CohortPage {
  Q_OBJECT
 public:
  explicit RatingPage(QWidget* parent = nullptr);
  [[nodiscard]] quint64 replayShown() const { return replay_->picture().shown(); }  ///< pictures so far
  /// True if the replay stands where it was sent to, or there is none.
  [[nodiscard]] bool settled() const { return replay_->settled(); }
  void setForms(KnownForms forms);
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
  QWidget* buildForm();
  void openReplay();
  [[nodiscard]] DraftSubject draftSubject() const;
  [[nodiscard]] const analytics::RatingForm* form() const;

  std::optional<analytics::AttemptRow> attempt_;
  KnownForms forms_;
  std::optional<RatingDraft> draft_;
  bool replaces_ = false;  ///< who fills it in has filled it in before

  QComboBox* choice_ = nullptr;
  QLabel* source_ = nullptr;
  AttemptBanner* banner_ = nullptr;
  QWidget* raterLabel_ = nullptr;
  QLineEdit* rater_ = nullptr;
  QWidget* participantLabel_ = nullptr;
  QComboBox* participant_ = nullptr;
  QScrollArea* area_ = nullptr;
  std::vector<std::pair<std::string, QButtonGroup*>> groups_;
  QLabel* state_ = nullptr;
  QPushButton* store_ = nullptr;
  QPushButton* next_ = nullptr;
  QCheckBox* reveal_ = nullptr;
  RecordingView* replay_;
  std::string shown_;  ///< uuid whose replay was opened
};

}  // namespace calot::gui
