// SPDX-License-Identifier: GPL-3.0-or-later
// What the dashboard asks the user for.
#include <QFileDialog>
#include <QInputDialog>

#include "gui/dashboard/attempts_page.h"
#include "gui/dashboard/dashboard_window.h"
#include "gui/dashboard/norm_dialog.h"
#include "gui/dashboard/settings.h"
#include "gui/dashboard/settings_dialog.h"
#include "gui/words/problem_words.h"
#include "recorder/base/errors.h"

namespace calot::gui {

void DashboardWindow::askForDatabase() {
  const QString path =
      QFileDialog::getOpenFileName(this, "Open a cohort database", {}, "Cohort databases (*.db);;All files (*)");
  if (!path.isEmpty()) openLater(path);
}

void DashboardWindow::askForNewDatabase() {
  const QString path =
      QFileDialog::getSaveFileName(this, "Make a cohort database", "cohort.db", "Cohort databases (*.db)", nullptr,
                                   QFileDialog::DontConfirmOverwrite);
  if (!path.isEmpty()) createDatabase(path);
}

void DashboardWindow::askForRecordings() {
  if (!document_) {
    showProblem("Open a cohort database first, or make one: recordings are imported into it.");
    return;
  }
  const QStringList files =
      QFileDialog::getOpenFileNames(this, "Import recordings", {}, "Recordings (*.h5);;All files (*)");
  if (!files.isEmpty()) importRecordings(files);
}

void DashboardWindow::askForExclusion() {
  const analytics::AttemptRow* attempt = attempts_->selected();
  if (attempt == nullptr) return;
  QString by = settings::person();
  if (by.isEmpty()) by = QInputDialog::getText(this, "Who decides", "Your pseudonym:").trimmed();
  if (by.isEmpty()) return;
  const QString what = attempt->excluded ? "Include in studies again" : "Exclude from studies";
  const QString reason = QInputDialog::getText(this, what, "Reason, for the record:").trimmed();
  if (reason.isEmpty()) return;
  settings::setPerson(by);
  excludeOrInclude(reason, by);
}

void DashboardWindow::askForTag(bool add) {
  const std::vector<analytics::AttemptRow> chosen = chosenAttempts();
  if (chosen.empty()) return;
  QStringList words;  // to add: all of the cohort; to remove: what the chosen ones have
  if (add) {
    words = document_->lines()->tags();
  } else {
    for (const analytics::AttemptRow& attempt : chosen) {
      for (const std::string& tag : attempt.tags) words += QString::fromStdString(tag);
    }
    words.removeDuplicates();
    words.sort();
    if (words.isEmpty()) {
      showProblem("The selected attempts have no tags.");
      return;
    }
  }
  QString by = settings::person();
  if (by.isEmpty()) by = QInputDialog::getText(this, "Who decides", "Your pseudonym:").trimmed();
  if (by.isEmpty()) return;
  bool agreed = false;
  const QString what = chosen.size() == 1 ? "this attempt" : QString("%1 attempts").arg(chosen.size());
  const QString tag = QInputDialog::getItem(this, add ? "Add a tag" : "Remove a tag",
                                            add ? "One word, to put on " + what + ':' : "To take off " + what + ':',
                                            words, 0, add, &agreed)
                          .trimmed();
  if (!agreed || tag.isEmpty()) return;
  try {
    analytics::checkTag(tag.toStdString());
  } catch (const Error& error) {
    showProblem(QString::fromStdString(problemText(error)));
    return;
  }
  settings::setPerson(by);
  tagSelected(tag, add, by);
}

void DashboardWindow::askForNorm() {
  if (!document_) return;
  std::vector<std::string> selected;
  for (const analytics::AttemptRow& attempt : attempts_->selectedAll()) selected.push_back(attempt.uuid);
  NormDialog dialog(document_, selected, this);
  connect(&dialog, &NormDialog::made, this, &DashboardWindow::reload);
  dialog.exec();
}

void DashboardWindow::showSettings() {
  SettingsDialog dialog(this);
  dialog.exec();
}

}  // namespace calot::gui
