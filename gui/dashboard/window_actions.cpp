// SPDX-License-Identifier: GPL-3.0-or-later
// Actions on the selected attempts, and pictures of the dashboard's pages for its documentation.
#include <algorithm>
#include <filesystem>
#include <QCoreApplication>
#include <QDesktopServices>
#include <QElapsedTimer>
#include <QEventLoop>
#include <QFileDialog>
#include <QFileInfo>
#include <QInputDialog>
#include <QMenu>
#include <QPrintDialog>
#include <QPrinter>
#include <QProcess>
#include <QStackedWidget>
#include <QStandardPaths>
#include <QStatusBar>
#include <QTabWidget>
#include <QUrl>
#include <system_error>

#include "gui/attempt/recording_file.h"
#include "gui/dashboard/attempt_page.h"
#include "gui/dashboard/attempts_page.h"
#include "gui/dashboard/course_page.h"
#include "gui/dashboard/dashboard_window.h"
#include "gui/dashboard/dialogs.h"
#include "gui/dashboard/figure_panel.h"
#include "gui/dashboard/figures_page.h"
#include "gui/dashboard/import_queue.h"
#include "gui/dashboard/norm_dialog.h"
#include "gui/dashboard/pair_page.h"
#include "gui/dashboard/ratings_page.h"
#include "gui/dashboard/study_page.h"
#include "gui/report/pdf_report.h"
#include "recorder/base/csv.h"
#include "recorder/base/files.h"

namespace calot::gui {
namespace {

/// The person at the desk, who is asked for a pseudonym once; empty: cancelled.
QString personWhoDecides(QWidget* window) {
  const QString known = settings::person();
  return known.isEmpty() ? QInputDialog::getText(window, "Who decides", "Your pseudonym:").trimmed() : known;
}

constexpr qint64 maxWaiting = 120000;  // ms for a page to have read what it shows
constexpr int settleTime = 1500;       // ms for pictures and animations to be on the screen

void waitFor(const std::function<bool()>& condition) {
  QElapsedTimer clock;
  clock.start();
  // Recently requested work may not have begun: the condition must hold for a while.
  qint64 since = -1;
  while (clock.elapsed() < maxWaiting && (since < 0 || clock.elapsed() < since + settleTime)) {
    QCoreApplication::processEvents(QEventLoop::AllEvents, 50);
    if (!condition())
      since = -1;
    else if (since < 0)
      since = clock.elapsed();
  }
}

}  // namespace

std::vector<analytics::AttemptRow> DashboardWindow::chosenAttempts() const {
  std::vector<analytics::AttemptRow> chosen = attempts_->selectedAll();
  if (chosen.empty() && attempts_->selected() != nullptr) chosen.push_back(*attempts_->selected());
  return chosen;
}

void DashboardWindow::excludeOrInclude(const QString& reason, const QString& by) {
  if (const analytics::AttemptRow* current = attempts_->selected())
    decide(exclusionDecision(chosenAttempts(), !current->excluded, reason.toStdString(), by.toStdString()));
}

void DashboardWindow::tagSelected(const QString& tag, bool add, const QString& by) {
  if (attempts_->selected() != nullptr) decide(tagDecision(chosenAttempts(), add, tag.toStdString(), by.toStdString()));
}

void DashboardWindow::changeGroup(const QString& participant, const QString& group) {
  const auto current =
      std::ranges::find(document_->attempts(), participant.toStdString(), &analytics::AttemptRow::participant);
  if (current != document_->attempts().end())
    decide(groupDecision(participant.toStdString(), group.toStdString(), current->group));
}

void DashboardWindow::decide(const Decision& decision) { decisions_->take(document_->path(), decision); }

void DashboardWindow::exportList(const QString& file) {
  std::string text;
  for (const std::vector<std::string>& cells : attempts_->shownCells()) text += csvLine(cells);
  if (tryTo([&] { recorder::writeText(file.toStdString(), text, true); }))
    statusBar()->showMessage("Written: " + file, noticeFor);
}

void DashboardWindow::askForList() {
  if (!document_) return;
  const QString file = QFileDialog::getSaveFileName(this, "Export the list of attempts", "attempts.csv", "CSV (*.csv)");
  if (!file.isEmpty()) exportList(file);
}

void DashboardWindow::print() {
  const auto take = [this](const analytics::ReportDocument& document) {
    QPrinter printer(QPrinter::HighResolution);
    printer.setDocName(QString::fromStdString(document.title));
    QPrintDialog dialog(&printer, this);
    dialog.setOption(QAbstractPrintDialog::PrintPageRange);  // a study's first two pages stand alone
    if (dialog.exec() == QDialog::Accepted) tryTo([&] { paintReport(document, printer); });
  };
  if (!document_ || !static_cast<CohortPage*>(tabs_->currentWidget())->makeDocument(take))
    showProblem("There is nothing to print here: the pages Attempts, Attempt, Study and Course are printed.");
}

void DashboardWindow::fillRecent() {
  recent_->clear();
  for (const QString& file : settings::recentCohorts())
    recent_->addAction(QFileInfo(file).fileName() + " in " + QFileInfo(file).absolutePath(), this,
                       [this, file] { openLater(file); });
  recent_->setEnabled(!recent_->isEmpty());
}

void DashboardWindow::showManual() {
  std::error_code ignored;
  for (const std::filesystem::path& assets : assetFolders_) {
    const std::filesystem::path documents = assets / ".." / ".." / "doc" / "calot-doc";
    for (const std::filesystem::path& place :
         {documents / "html" / "index.html", documents / "docs" / "index.md", assets / ".." / "docs" / "index.md"}) {
      if (!std::filesystem::is_regular_file(place, ignored)) continue;
      QDesktopServices::openUrl(QUrl::fromLocalFile(QString::fromStdString(place.lexically_normal().string())));
      return;
    }
  }
  showProblem("The manual is not installed: it is in the package calot-doc.");
}

void DashboardWindow::verifySelected() {
  if (!document_) return;
  finder_.run(
      [this, attempts = attempts_->selectedAll(), database = document_->path(), places = settings::recordingPlaces()] {
        QStringList files, missing;
        for (const analytics::AttemptRow& attempt : attempts) {
          const std::filesystem::path file = findRecording(attempt, database, places);
          (file.empty() ? missing : files) += QString::fromStdString(file.empty() ? attempt.fileName : file.string());
        }
        return [this, files, missing] {
          if (!missing.isEmpty())
            showProblem("Not found, so not verified: " + missing.join(", ") +
                        ". Settings name the folders with recordings.");
          if (!files.isEmpty()) importRecordings(files);
        };
      },
      [this](const QString& reason) { showProblem(reason); });
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

void DashboardWindow::askForContinuation(const QString& recording, double time) {
  const analytics::AttemptRow* const attempt = attempts_->selected();
  if (attempt == nullptr) return;
  const QString uuid = QString::fromStdString(attempt->uuid);
  ContinuationDialog dialog(time, this);
  if (dialog.exec() != QDialog::Accepted) return;
  if (dialog.byPerformer()) {
    const QString profile = dialog.profile();
    addBranch({recording, time, profile, dialog.seconds(), branchFile(recording, profile, time)}, uuid);
    return;
  }
  const QString trainer =
      QStandardPaths::findExecutable("calot-trainer", {QFileInfo(settings::calotProgram()).absolutePath()});
  const QStringList arguments = program_.goOn(recording, time, QString::fromStdString(document_->path()));
  if (trainer.isEmpty() || !QProcess::startDetached(trainer, arguments))
    showProblem("The trainer cannot be started: it is looked for beside the program that File, Settings names.");
}

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
  const QStringList files = QFileDialog::getOpenFileNames(this, "Import recordings (this cannot be undone)", {},
                                                          "Recordings (*.h5);;All files (*)");
  if (!files.isEmpty()) importRecordings(files);
}

void DashboardWindow::askForExclusion() {
  const analytics::AttemptRow* attempt = attempts_->selected();
  if (attempt == nullptr) return;
  const QString by = personWhoDecides(this);
  if (by.isEmpty()) return;
  const QString what = attempt->excluded ? "Include in studies again" : "Exclude from studies";
  const QString reason = QInputDialog::getText(this, what, "Reason, for the record (Ctrl+Z undoes it):").trimmed();
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
    for (const analytics::AttemptRow& attempt : chosen) words += textsOf(attempt.tags);
    words.removeDuplicates();
    words.sort();
    if (words.isEmpty()) {
      showProblem("The selected attempts have no tags.");
      return;
    }
  }
  const QString by = personWhoDecides(this);
  if (by.isEmpty()) return;
  bool agreed = false;
  const QString what = chosen.size() == 1 ? "this attempt" : QString("%1 attempts").arg(chosen.size());
  const QString tag =
      QInputDialog::getItem(this, add ? "Add a tag" : "Remove a tag",
                            (add ? "One word, to put on " : "To take off ") + what + " (Ctrl+Z undoes it):", words, 0,
                            add, &agreed)
          .trimmed();
  if (!agreed || tag.isEmpty()) return;
  if (!tryTo([&] { analytics::checkTag(tag.toStdString()); })) return;
  settings::setPerson(by);
  tagSelected(tag, add, by);
}

void DashboardWindow::askForNorm() {
  if (!document_) return;
  NormDialog dialog(document_, attempts_->selectedUuids(), this);
  connect(&dialog, &NormDialog::made, this, &DashboardWindow::keepNorm);
  connect(&dialog, &NormDialog::undoWanted, decisions_->undoAction(), &QAction::trigger);
  dialog.exec();
}

void DashboardWindow::keepNorm(const analytics::Norm& norm) {
  decide(normDecision(norm));
  reload();
}

void DashboardWindow::savePictures(const QString& folder) {
  const auto save = [&](QWidget* page, const char* name, const std::function<bool()>& ready) {
    if (page != nullptr) tabs_->setCurrentWidget(page);
    waitFor(ready);
    parts::savePicture(*this, folder + '/' + name);
  };
  const auto atOnce = [] { return true; };
  if (stack_->currentWidget() == greeting_) {
    save(nullptr, "greeting.png", atOnce);
    return;
  }
  save(attempts_, "attempts.png", atOnce);
  tabs_->setCurrentWidget(attempt_);
  waitFor([this] { return attempt_->settled(); });
  attempt_->figures().showWorst();
  save(attempt_, "attempt.png", [this] { return attempt_->settled(); });
  save(compare_, "compare.png", [this] { return compare_->ready(); });
  bool studied = false;
  const auto told = connect(study_, &StudyPage::studyShown, this, [&] { studied = true; });
  save(study_, "study.png", [&] { return studied; });
  disconnect(told);
  save(trainee_, "trainee.png", [this] { return trainee_->ready(); });
  tabs_->setCurrentWidget(pair_);
  pair_->chooseTwo();
  waitFor([this] { return pair_->settled(); });
  pair_->showMiddle();
  save(pair_, "pair.png", [this] { return pair_->settled(); });
  rating_->chooseForm("goals");
  save(rating_, "ratings.png", [this] { return rating_->settled(); });
  save(course_, "course.png", [this] { return course_->ready(); });
  const auto saveDialog = [&](QDialog& dialog, const char* name) {
    dialog.show();
    waitFor(atOnce);
    parts::savePicture(dialog, folder + '/' + name);
    dialog.hide();
  };
  NormDialog norm(document_, {}, this);
  waitFor([&] { return norm.settled(); });
  saveDialog(norm, "norm.png");
  SettingsDialog settings(this);
  saveDialog(settings, "settings.png");
}

}  // namespace calot::gui
