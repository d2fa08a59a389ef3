// SPDX-License-Identifier: GPL-3.0-or-later
// A form that is being filled in. Knows no window.
// Forms that are not stored yet, kept among the user's settings: a rater who is called away goes on where they were.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "analytics/assessment/rating_form.h"
#include "analytics/cohort/assessment_database.h"

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
