// SPDX-License-Identifier: GPL-3.0-or-later
// What is done to the attempts that are selected.
#include <filesystem>
#include <QTabWidget>
#include <QUndoStack>

#include "gui/attempt/open_recording.h"
#include "gui/dashboard/attempts_page.h"
#include "gui/dashboard/dashboard_window.h"
#include "gui/dashboard/decision_command.h"
#include "gui/dashboard/pair_page.h"
#include "gui/dashboard/settings.h"

namespace calot::gui {

std::vector<analytics::AttemptRow> DashboardWindow::chosenAttempts() const {
  std::vector<analytics::AttemptRow> chosen = attempts_->selectedAll();
  if (chosen.empty() && attempts_->selected() != nullptr) chosen.push_back(*attempts_->selected());
  return chosen;
}

void DashboardWindow::excludeOrInclude(const QString& reason, const QString& by) {
  const analytics::AttemptRow* current = attempts_->selected();
  if (current == nullptr) return;
  const bool exclude = !current->excluded;
  Decision decision{document_->path(), by.toStdString(), chosenAttempts()};
  // Those that are so already stay as they are.
  std::erase_if(decision.attempts,
                [&](const analytics::AttemptRow& a) { return a.withdrawn || a.excluded == exclude; });
  undo_->push(exclusionCommand(writer_, decision, exclude, reason.toStdString()).release());
}

void DashboardWindow::tagSelected(const QString& tag, bool add, const QString& by) {
  if (attempts_->selected() == nullptr) return;
  const Decision decision{document_->path(), by.toStdString(), chosenAttempts()};
  undo_->push(tagCommand(writer_, decision, add, tag.toStdString()).release());
}

void DashboardWindow::verifySelected() {
  if (!document_) return;
  QStringList files, missing;
  for (const analytics::AttemptRow& attempt : attempts_->selectedAll()) {
    const std::filesystem::path file = findRecording(attempt, document_->path(), settings::recordingPlaces());
    (file.empty() ? missing : files) += QString::fromStdString(file.empty() ? attempt.fileName : file.string());
  }
  if (!missing.isEmpty())
    showProblem("Not found, so not verified: " + missing.join(", ") + ". Settings name the folders with recordings.");
  if (!files.isEmpty()) importRecordings(files);
}

void DashboardWindow::pairSelected() {
  const std::vector<analytics::AttemptRow> chosen = attempts_->selectedAll();
  if (chosen.size() != 2) {
    showProblem("Select two attempts on the page Attempts (Ctrl and a click, or Shift and an arrow).");
    return;
  }
  for (std::size_t side = 0; side < 2; ++side) pair_->setAttempt(side, chosen[side].uuid);
  tabs_->setCurrentWidget(pair_);
}

}  // namespace calot::gui
