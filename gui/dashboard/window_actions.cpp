// SPDX-License-Identifier: GPL-3.0-or-later
// Actions on the selected attempts, and pictures of the dashboard's pages for its documentation.
#include <algorithm>
#include <atomic>
#include <filesystem>
#include <map>
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
#include <QUndoCommand>
#include <QUndoStack>
#include <QUrl>
#include <system_error>
#include <utility>

#include "gui/attempt/replay_player.h"
#include "gui/dashboard/attempt_page.h"
#include "gui/dashboard/attempts_page.h"
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

/// Decisions of a person about attempts, and their reversal; the database notes both.
class DecisionCommand : public QUndoCommand {
 public:
  using Change = CohortWriter::Change;
  /// @param writer outlives this
  /// @param done it was carried out already
  DecisionCommand(CohortWriter& writer, std::string database, const QString& text, Change redo, Change undo,
                  bool done = false)
      : QUndoCommand(text),
        writer_(writer),
        database_(std::move(database)),
        redo_(std::move(redo)),
        undo_(std::move(undo)),
        done_(done) {}
  void redo() override {
    if (!std::exchange(done_, false)) write(redo_);
  }
  void undo() override { write(undo_); }

 private:
  void write(const Change& change) {
    if (*failed_) {
      setObsolete(true);  // what could not be done leaves nothing to undo
      return;
    }
    const auto apply = [failed = failed_, change](analytics::CohortDatabase& cohort) {
      if (!*failed) change(cohort);
    };
    writer_.write(database_, apply, [failed = failed_] { *failed = true; });
  }

  CohortWriter& writer_;
  std::string database_;
  Change redo_, undo_;
  bool done_;
  std::shared_ptr<std::atomic<bool>> failed_ = std::make_shared<std::atomic<bool>>(false);  ///< by the writer's thread
};

/// The person who decides, the attempts and their database.
struct Decision {
  std::string database, by;
  std::vector<analytics::AttemptRow> attempts;
};

/// Keeps the attempts out of studies, or takes that back.
DecisionCommand* exclusionCommand(CohortWriter& writer, const Decision& decision, bool exclude,
                                  const std::string& reason) {
  std::vector<std::string> uuids;
  for (const analytics::AttemptRow& attempt : decision.attempts) uuids.push_back(attempt.uuid);
  const std::string by = decision.by;
  if (exclude) {
    return new DecisionCommand(
        writer, decision.database, "exclusion",
        [=](analytics::CohortDatabase& cohort) { cohort.excludeAttempts(uuids, reason, by); },
        [=](analytics::CohortDatabase& cohort) { cohort.includeAttempts(uuids, "undone: " + reason, by); });
  }
  std::map<std::string, std::vector<std::string>> former;  // reason -> attempts
  for (const analytics::AttemptRow& attempt : decision.attempts)
    former[attempt.exclusionReason].push_back(attempt.uuid);
  return new DecisionCommand(
      writer, decision.database, "inclusion",
      [=](analytics::CohortDatabase& cohort) { cohort.includeAttempts(uuids, reason, by); },
      [=](analytics::CohortDatabase& cohort) {
        for (const auto& [why, attempts] : former) cohort.excludeAttempts(attempts, why, by);
      });
}

/// Puts a tag on those attempts that do not have it, or takes it off those that do.
DecisionCommand* tagCommand(CohortWriter& writer, const Decision& decision, bool add, const std::string& tag) {
  std::vector<std::string> uuids;
  for (const analytics::AttemptRow& attempt : decision.attempts) {
    const bool has = std::find(attempt.tags.begin(), attempt.tags.end(), tag) != attempt.tags.end();
    if (has != add) uuids.push_back(attempt.uuid);
  }
  const auto change = [uuids, tag, by = decision.by](bool put) -> DecisionCommand::Change {
    return [=](analytics::CohortDatabase& cohort) {
      if (put)
        cohort.tagAttempts(uuids, tag, by);
      else
        cohort.untagAttempts(uuids, tag, by);
    };
  };
  return new DecisionCommand(writer, decision.database, add ? "tag" : "removal of a tag", change(add), change(!add));
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
  const analytics::AttemptRow* current = attempts_->selected();
  if (current == nullptr) return;
  const bool exclude = !current->excluded;
  Decision decision{document_->path(), by.toStdString(), chosenAttempts()};
  // Those that are so already stay as they are.
  std::erase_if(decision.attempts,
                [&](const analytics::AttemptRow& a) { return a.withdrawn || a.excluded == exclude; });
  undo_->push(exclusionCommand(writer_, decision, exclude, reason.toStdString()));
}

void DashboardWindow::tagSelected(const QString& tag, bool add, const QString& by) {
  if (attempts_->selected() == nullptr) return;
  const Decision decision{document_->path(), by.toStdString(), chosenAttempts()};
  undo_->push(tagCommand(writer_, decision, add, tag.toStdString()));
}

void DashboardWindow::changeGroup(const QString& participant, const QString& group) {
  const auto current =
      std::ranges::find(document_->attempts(), participant.toStdString(), &analytics::AttemptRow::participant);
  if (current == document_->attempts().end()) return;
  const auto change = [name = participant.toStdString()](const std::string& to) -> DecisionCommand::Change {
    return [name, to](analytics::CohortDatabase& cohort) {
      analytics::ParticipantChange made;
      made.group = to;
      cohort.setParticipant(name, made);
    };
  };
  undo_->push(new DecisionCommand(writer_, document_->path(), "change of group", change(group.toStdString()),
                                  change(current->group)));
}

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
    showProblem("There is nothing to print here: the pages Attempts, Attempt and Study are printed.");
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
  const QStringList files =
      QFileDialog::getOpenFileNames(this, "Import recordings", {}, "Recordings (*.h5);;All files (*)");
  if (!files.isEmpty()) importRecordings(files);
}

void DashboardWindow::askForExclusion() {
  const analytics::AttemptRow* attempt = attempts_->selected();
  if (attempt == nullptr) return;
  const QString by = personWhoDecides(this);
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
  const QString tag = QInputDialog::getItem(this, add ? "Add a tag" : "Remove a tag",
                                            add ? "One word, to put on " + what + ':' : "To take off " + what + ':',
                                            words, 0, add, &agreed)
                          .trimmed();
  if (!agreed || tag.isEmpty()) return;
  if (!tryTo([&] { analytics::checkTag(tag.toStdString()); })) return;
  settings::setPerson(by);
  tagSelected(tag, add, by);
}

void DashboardWindow::askForNorm() {
  if (!document_) return;
  std::vector<std::string> selected;
  for (const analytics::AttemptRow& attempt : attempts_->selectedAll()) selected.push_back(attempt.uuid);
  NormDialog dialog(document_, selected, this);
  connect(&dialog, &NormDialog::made, this, &DashboardWindow::keepNorm);
  connect(&dialog, &NormDialog::undoWanted, undo_, &QUndoStack::undo);
  dialog.exec();
}

void DashboardWindow::keepNorm(const analytics::Norm& norm) {
  const auto version = std::make_shared<std::uint32_t>(norm.version);  // the writer's thread alone reads and sets it
  undo_->push(new DecisionCommand(
      writer_, document_->path(), "norm " + QString::fromStdString(norm.name),
      [norm, version](analytics::CohortDatabase& cohort) { *version = cohort.storeNorm(norm); },
      [norm, version](analytics::CohortDatabase& cohort) { cohort.removeNorm(norm.name, *version, norm.by); }, true));
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
