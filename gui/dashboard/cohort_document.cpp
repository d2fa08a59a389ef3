// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/cohort_document.h"

#include <algorithm>

namespace calot::gui {

using Access = analytics::CohortDatabase::Access;

CohortDocument::CohortDocument(const std::string& path)
    : database_(path, Access::read), lines_(std::make_shared<const AttemptLines>(database_.listAttempts())) {}

const analytics::AttemptRow* CohortDocument::attempt(const std::string& uuid) const {
  const auto at = std::find_if(attempts().begin(), attempts().end(),
                               [&](const analytics::AttemptRow& attempt) { return attempt.uuid == uuid; });
  return at == attempts().end() ? nullptr : &*at;
}

std::shared_ptr<const FigureValues> CohortDocument::figureValues() const {
  const std::lock_guard lock(valuesMutex_);
  if (!values_) {
    const analytics::CohortDatabase database(path(), Access::read);  // a connection is of one thread
    values_ =
        std::make_shared<const FigureValues>([&](const FigureValues::Take& take) { database.eachValue({}, take); });
  }
  return values_;
}

const std::vector<analytics::Norm>& CohortDocument::norms() const {
  if (!norms_) norms_ = analytics::AssessmentDatabase(path(), Access::read).norms();
  return *norms_;
}

std::vector<analytics::RegisteredProtocol> CohortDocument::protocols() const {
  return analytics::AssessmentDatabase(path(), Access::read).protocols();
}

std::vector<std::string> CohortDocument::participants() const {
  std::vector<std::string> names;
  for (const analytics::Participant& participant : database_.participants()) names.push_back(participant.pseudonym);
  return names;
}

std::vector<analytics::Rating> CohortDocument::ratings() const {
  return analytics::AssessmentDatabase(path(), Access::read).ratings();
}

}  // namespace calot::gui
