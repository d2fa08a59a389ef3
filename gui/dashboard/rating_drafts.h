// SPDX-License-Identifier: GPL-3.0-or-later
// Forms that are not stored yet, kept among the user's settings: a rater who is called away goes on where they were.
#pragma once

#include <map>
#include <optional>
#include <string>

namespace calot::gui {

/// What a draft is of.
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
