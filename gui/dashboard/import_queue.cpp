// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/import_queue.h"

#include <algorithm>
#include <QDir>
#include <QFileInfo>
#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>
#include <QListWidget>
#include <QProgressBar>
#include <QPushButton>
#include <QTimer>
#include <utility>

#include "gui/attempt/long_work.h"
#include "gui/attempt/widget_parts.h"
#include "gui/view/thread_rank.h"

namespace calot::gui {
namespace {

constexpr qsizetype maxOutput = 64 * 1024 * 1024;  // bytes; the report of a recording is far smaller
constexpr int patience = 3000;                     // ms for a killed process to be gone

QString storedText(const QString& how) {
  if (how == "added") return "new in the cohort";
  if (how == "extended") return "brought up to date";
  if (how == "unchanged") return "was in the cohort already";
  return "not stored";
}

QString verdictText(const QString& verdict, const QString& message) {
  if (verdict == "bit-exact") return QString::fromUtf8("✓ verified");
  if (verdict == "diverged") return QString::fromUtf8("≠ diverged: ") + message;
  if (verdict == "damaged") return QString::fromUtf8("✕ damaged: ") + message;
  return "? not checkable here: " + message;
}

QString lastLine(const QByteArray& text) {
  const QList<QByteArray> lines = text.trimmed().split('\n');
  return QString::fromUtf8(lines.last()).trimmed();
}

}  // namespace

ImportResult importResultOf(const AssessProgram& program, const QString& file, int exitCode, bool crashed,
                            const QByteArray& output, const QByteArray& errors) {
  ImportResult result;
  result.file = file;
  if (crashed) {
    result.text = "the program that assesses it ended without an answer";
    return result;
  }
  const QJsonObject row = QJsonDocument::fromJson(output).object()["recordings"].toArray().at(0).toObject();
  if (row.isEmpty()) {
    result.text = lastLine(errors);
    if (result.text.isEmpty()) result.text = QString("no answer (exit code %1)").arg(exitCode);
    if (program.refused(exitCode)) result.kind = ImportResult::Kind::refused;
    return result;
  }
  const QString stored = row["stored"].toString();
  result.kind = stored == "not stored" ? ImportResult::Kind::refused : ImportResult::Kind::stored;
  result.text = verdictText(row["verdict"].toString(), row["message"].toString()) + "; " + storedText(stored);
  if (const QString key = row["key"].toString(); !key.isEmpty()) result.text += "; " + key;
  return result;
}

QStringList recordingsIn(const QStringList& paths) {
  QStringList files;
  for (const QString& path : paths) {
    if (!QFileInfo(path).isDir()) {
      files += path;
      continue;
    }
    const QDir folder(path);
    for (const QString& name : folder.entryList({"*.h5"}, QDir::Files, QDir::Name)) files += folder.filePath(name);
  }
  files.removeDuplicates();
  return files;
}

ImportQueue::ImportQueue(AssessProgram how) : how_(std::move(how)) {
  process_.setChildProcessModifier([] { stepBack(behindInterface); });
  connect(&process_, &QProcess::readyReadStandardOutput, this, [this] { collect(); });
  connect(&process_, &QProcess::readyReadStandardError, this, [this] { collect(); });
  connect(&process_, &QProcess::finished, this, [this](int code, QProcess::ExitStatus status) {
    collect();
    if (making_ && code == 0 && status == QProcess::NormalExit && !cancelled_) {
      making_.reset();
      QTimer::singleShot(0, this, [this] { run(); });  // not from within the process's own signal
      return;
    }
    if (making_)
      return finishCurrent({current_, ImportResult::Kind::failed, "no branch was made: " + lastLine(errors_)});
    finishCurrent(importResultOf(how_, current_, code, status == QProcess::CrashExit, output_, errors_));
  });
  connect(&process_, &QProcess::errorOccurred, this, [this](QProcess::ProcessError error) {
    if (error != QProcess::FailedToStart) return;  // the others end with finished()
    finishCurrent({current_, ImportResult::Kind::failed,
                   (program_.isEmpty() ? QString("the program calot was not found") : program_ + " cannot be started") +
                       "; name it under File, Settings"});
  });
}

ImportQueue::~ImportQueue() {
  process_.disconnect(this);
  if (process_.state() != QProcess::NotRunning) {
    process_.kill();
    process_.waitForFinished(patience);
  }
}

void ImportQueue::configure(const QString& program, const QString& database, int threads) {
  program_ = program;
  database_ = database;
  threads_ = threads;
}

void ImportQueue::add(const QStringList& files) {
  if (!busy()) done_ = total_ = 0;
  for (const QString& file : files) waiting_.append({file});
  total_ += static_cast<int>(files.size());
  if (current_.isEmpty()) startNext();
}

void ImportQueue::addBranch(const BranchRequest& request) {
  if (!busy()) done_ = total_ = 0;
  waiting_.append({request.file, request});
  ++total_;
  if (current_.isEmpty()) startNext();
}

void ImportQueue::cancel() {
  total_ -= static_cast<int>(waiting_.size());
  waiting_.clear();
  if (process_.state() == QProcess::NotRunning) return;
  cancelled_ = true;
  process_.kill();
}

void ImportQueue::startNext() {
  if (waiting_.isEmpty()) {
    emit allDone();
    return;
  }
  const Item next = waiting_.takeFirst();
  current_ = next.file;
  making_ = next.branch;
  cancelled_ = false;
  clock_.start();
  run();
}

void ImportQueue::run() {
  output_.clear();
  errors_.clear();
  emit progressed();
  // An absolute path: no file's name is an option.
  process_.start(program_, making_ ? how_.branch(*making_)
                                   : how_.arguments(QFileInfo(current_).absoluteFilePath(), database_, threads_));
  process_.closeWriteChannel();
}

void ImportQueue::collect() {
  output_ += process_.readAllStandardOutput();
  errors_ += process_.readAllStandardError();
  if (output_.size() + errors_.size() > maxOutput) process_.kill();
}

void ImportQueue::finishCurrent(ImportResult result) {
  if (cancelled_) result = {current_, ImportResult::Kind::failed, "stopped"};
  ++done_;
  current_.clear();
  making_.reset();
  emit fileDone(result);
  emit progressed();
  // Not from within the process's own signal.
  QTimer::singleShot(0, this, [this] {
    if (current_.isEmpty()) startNext();
  });
}

ImportPanel::ImportPanel(ImportQueue& queue)
    : queue_(queue),
      text_(parts::plainLabel("import-text", false)),
      bar_(parts::named("import-progress", new QProgressBar)),
      stop_(parts::named("import-stop", new QPushButton("Stop importin&g"))),
      results_(parts::named("import-results", new QListWidget)),
      tick_(new QTimer(this)) {
  results_->setAccessibleName("Results of the import");
  auto* const lasting = parts::plainLabel("import-lasting");
  lasting->setText("Import and verification cannot be undone; attempts can be excluded from studies (Ctrl+E).");
  setLayout(parts::column({text_, parts::row({{bar_, 1}, stop_}), {results_, 1}, lasting}));
  connect(stop_, &QPushButton::clicked, &queue_, &ImportQueue::cancel);
  connect(&queue_, &ImportQueue::progressed, this, [this] { showProgress(); });
  connect(&queue_, &ImportQueue::fileDone, this, &ImportPanel::addResult);
  connect(&queue_, &ImportQueue::allDone, this, [this] { showProgress(); });
  connect(tick_, &QTimer::timeout, this, [this] { showProgress(); });
}

void ImportPanel::showProgress() {
  const bool busy = queue_.busy();
  if (busy && !clock_.isValid()) clock_.start();
  if (!busy) clock_.invalidate();
  double left = -1.0;
  if (busy && queue_.done() > 0)
    left = 1e-3 * static_cast<double>(clock_.elapsed()) / queue_.done() * (queue_.total() - queue_.done());
  stop_->setEnabled(busy);
  bar_->setRange(0, std::max(1, queue_.total()));
  bar_->setValue(queue_.done());
  const QString count = QString("%1 of %2 recordings").arg(queue_.done()).arg(queue_.total());
  if (!queue_.current().isEmpty())
    text_->setText(QString("%1 done. %2 %3, %4 s so far … %5")
                       .arg(count, queue_.making() ? "Making the branch" : "Simulating again",
                            QFileInfo(queue_.current()).fileName())
                       .arg(queue_.seconds())
                       .arg(leftText(left)));
  else
    text_->setText(count + " done.");
  if (busy)
    tick_->start(1000);
  else
    tick_->stop();
}

void ImportPanel::addResult(const ImportResult& result) {
  auto* item = new QListWidgetItem(QFileInfo(result.file).fileName() + ": " + result.text);
  item->setToolTip(result.file);
  if (result.kind != ImportResult::Kind::stored) item->setForeground(theme::trouble());
  results_->addItem(item);
  results_->scrollToItem(item);
}

GreetingPage::GreetingPage()
    : title_(parts::plainLabel("greeting-title", false)), text_(parts::selectableLabel("greeting")) {
  parts::enlarge(title_, 1.8);
  for (QLabel* const label : {title_, text_}) label->setAlignment(Qt::AlignHCenter);
  const auto button = [&](const char* name, const char* text, auto wish) {
    auto* const made = parts::named(name, new QPushButton(text));
    connect(made, &QPushButton::clicked, this, wish);
    return made;
  };
  import_ = button("import-recordings", "&Import recordings …", &GreetingPage::importRequested);
  QBoxLayout* const buttons =
      parts::row({parts::spring(), import_, button("open", "&Open a cohort database …", &GreetingPage::openRequested),
                  button("new", "&Make a new one …", &GreetingPage::newRequested), parts::spring()});
  setLayout(
      parts::column({parts::spring(1), title_, parts::space(12), text_, parts::space(18), buttons, parts::spring(2)}));
  explainNoDatabase();
}

void GreetingPage::explainNoDatabase() {
  title_->setText("Welcome to Calot");
  text_->setText(
      "A cohort database holds attempts and their checkpoints.\nOpen one, make a new one, or drop one here.");
  import_->hide();
}

void GreetingPage::explainEmptyDatabase(const QString& fileName) {
  title_->setText("This cohort is still empty");
  text_->setText(
      fileName +
      " is a cohort database without attempts.\nImport recordings, or drop them here: each is simulated again, "
      "verified and measured.");
  import_->show();
}

}  // namespace calot::gui
