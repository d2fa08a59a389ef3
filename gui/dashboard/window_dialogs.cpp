// SPDX-License-Identifier: GPL-3.0-or-later
// What the dashboard asks the user for.
#include <QFileDialog>
#include <QInputDialog>

#include "gui/dashboard/attempts_page.h"
#include "gui/dashboard/dashboard_window.h"
#include "gui/dashboard/settings.h"
#include "gui/dashboard/settings_dialog.h"

namespace calot::gui {

void DashboardWindow::askForDatabase() {
  const QString path =
      QFileDialog::getOpenFileName(this, "Open a cohort database", {}, "Cohort databases (*.db);;All files (*)");
  if (!path.isEmpty()) openDatabase(path);
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

void DashboardWindow::showSettings() {
  SettingsDialog dialog(this);
  dialog.exec();
}

}  // namespace calot::gui
