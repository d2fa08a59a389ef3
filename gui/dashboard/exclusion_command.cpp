// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/exclusion_command.h"

#include "analytics/cohort/cohort_database.h"
#include "gui/words/problem_words.h"
#include "recorder/errors.h"

namespace calot::gui {

ExclusionCommand::ExclusionCommand(Change change, std::function<void(const QString&)> done)
    : QUndoCommand(change.exclude ? "exclusion" : "inclusion"), change_(std::move(change)), done_(std::move(done)) {}

void ExclusionCommand::undo() {
  apply(!change_.exclude, change_.exclude ? "undone: " + change_.reason : change_.formerReason);
}

void ExclusionCommand::apply(bool exclude, const std::string& reason) {
  try {
    analytics::CohortDatabase database(change_.database, analytics::CohortDatabase::Access::write);
    if (exclude)
      database.excludeAttempt(change_.attempt, reason, change_.by);
    else
      database.includeAttempt(change_.attempt, reason, change_.by);
    done_({});
  } catch (const Error& error) {
    // What could not be done leaves nothing to undo.
    setObsolete(true);
    done_(QString::fromStdString(problemText(error)));
  }
}

}  // namespace calot::gui
