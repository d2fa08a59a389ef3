// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/attempt_page.h"

#include <QFileDialog>
#include <QFileInfo>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/cohort/cohort_database.h"
#include "analytics/report/grade_sheet.h"
#include "gui/attempt/figure_text.h"
#include "gui/attempt/replay_player.h"
#include "gui/dashboard/dialogs.h"
#include "gui/dashboard/figure_panel.h"
#include "gui/render/renderer.h"
#include "gui/report/pdf_report.h"
#include "recorder/base/errors.h"
#include "recorder/base/files.h"

namespace calot::gui {
namespace {

/// Figures that say what is better: only these have bad moments.
RecordingView::Figures judgedFigures(const std::vector<analytics::CheckpointValue>& values) {
  RecordingView::Figures figures;
  for (const analytics::CheckpointValue& value : values) {
    const analytics::CheckpointDefinition* definition = analytics::findCheckpoint(value.name);
    if (value.value && definition != nullptr && definition->direction != analytics::Direction::none)
      figures.emplace_back(value.name, value.subject);
  }
  return figures;
}

std::array<std::vector<double>, handCount> tracesOf(const AttemptTrack& track, std::vector<double> HandTrace::*which,
                                                    double factor) {
  std::array<std::vector<double>, handCount> traces;
  for (std::size_t h = 0; h < handCount; ++h) {
    traces[h] = track.hand[h].*which;
    for (double& value : traces[h]) value *= factor;
  }
  return traces;
}

constexpr double millimetres = 1000.0;

struct SheetRequest {
  std::string database;
  analytics::AttemptRow attempt;
  AttemptSummary summary;
  std::vector<analytics::ErrorLine> errors;
  std::vector<WorstMoment> moments;  ///< at most maxWorstMoments
  std::filesystem::path recording;   ///< empty: no pictures
  std::string norm;                  ///< name of the norm that the grade sheet is of
  std::uint32_t normVersion = 0;
  std::filesystem::path file;  ///< to be written; one that is there is replaced
};

constexpr int pictureWidth = 800, pictureHeight = 600;
constexpr const char* sheetMaker = "calot " CALOT_VERSION;

/// The attempt on one page: verdict, critical view, errors, key figures, what went wrong and when.
analytics::ReportDocument attemptDocument(const SheetRequest& request) {
  const analytics::AttemptRow& attempt = request.attempt;
  analytics::ReportDocument document;
  document.title =
      (operatorText(attempt) + ", ").toStdString() + attempt.scene + ", " + startText(attempt.startUtc).toStdString();
  document.synthetic = attempt.synthetic;
  document.add(request.summary.verdict);
  if (!request.summary.criticalView.empty()) document.add(request.summary.criticalView);
  document.add(request.summary.errors);
  std::vector<std::string> figures;
  for (const KeyFigure& figure : request.summary.figures) figures.push_back(keyFigureText(figure).toStdString());
  document.addList(figures);
  analytics::ReportTable table = analytics::tableOf("What went wrong", {"time", "=severity", "=error"});
  constexpr std::size_t maxRows = 24;
  for (const analytics::ErrorLine& error : request.errors) {
    if (table.rows.size() == maxRows) break;
    table.rows.push_back({timeText(error.time), analytics::nameOf(error.severity), error.counted()});
  }
  if (request.errors.size() > maxRows)
    table.rows.push_back({"", "", "and " + std::to_string(request.errors.size() - maxRows) + " more"});
  if (!table.rows.empty()) document.parts.emplace_back(std::move(table));
  document.add("Attempt " + attempt.uuid + ", " + badgeText(attempt.verification.verdict).toStdString() + ". " +
               analytics::comparabilityWords(attempt.comparabilityKey) + ".");
  return document;
}

/// Pictures of the scene at the worst moments. @throws Error, LongWork::Broken
std::vector<CaptionedPicture> picturesOf(const SheetRequest& request, LongWork::Control& control) {
  std::vector<CaptionedPicture> pictures;
  if (request.recording.empty() || request.moments.empty()) return pictures;
  recorder::Recording recording = openRecording(request.recording, request.attempt.uuid);
  recorder::Seeker seeker(recording);
  Renderer renderer;
  for (const WorstMoment& moment : request.moments) {
    const std::size_t done = pictures.size(), all = request.moments.size();
    control.progress(0.1 + 0.8 * static_cast<double>(done) / static_cast<double>(all),
                     QString("Picture %1 of %2").arg(done + 1).arg(all));
    seekAsRecorded(seeker, recording, stepAt(recording, moment.time));
    pictures.push_back({renderer.render(seeker.view(), pictureWidth, pictureHeight, Quality::interactive),
                        timeText(moment.time) + "  " + moment.caption});
  }
  return pictures;
}

/// Work for LongWork: one page with pictures, as PDF.
QString writeOnePage(const SheetRequest& request, LongWork::Control& control) {
  control.progress(0.0, "Opening the recording");
  const std::vector<CaptionedPicture> pictures = picturesOf(request, control);
  control.progress(0.9, "Laying out the page");
  const std::string bytes = onePagePdf(attemptDocument(request), pictures, sheetMaker);
  control.progress(1.0, "Writing the page");
  recorder::writeText(request.file, bytes, true);
  return "Written: " + QString::fromStdString(request.file.string());
}

/// The attempt against the norm, as `calot grade --pdf` writes it.
QString writeGradeSheet(const SheetRequest& request, LongWork::Control& control) {
  control.progress(0.0, "Checking the cohort");
  analytics::refuseUnsound(request.database);
  control.progress(0.05, "Reading the cohort");
  const analytics::CohortDatabase cohort(request.database, analytics::CohortDatabase::Access::read);
  const analytics::Norm norm = cohort.norm(request.norm, request.normVersion);
  analytics::Grade grade = analytics::gradeAttempt(request.attempt, cohort.listAttempts(), cohort.allValues(), norm,
                                                   false, request.database);
  const auto weak = analytics::weakFigures(grade);
  if (request.recording.empty()) {
    grade.momentsMissing = "the recording " + request.attempt.fileName + " was not found";
  } else {
    recorder::Recording recording = openRecording(request.recording, request.attempt.uuid);
    analytics::addMoments(grade, analytics::findMoments(recording, weak, [&](std::uint64_t done, std::uint64_t of) {
                            control.progress(0.1 + 0.8 * static_cast<double>(done) / static_cast<double>(of),
                                             "Looking for moments");
                          }));
  }
  control.progress(0.9, "Laying out the sheet");
  const std::string bytes =
      pdfReport(analytics::gradeDocument(grade, request.recording.filename().string(), {}), sheetMaker);
  control.progress(1.0, "Writing the sheet");
  recorder::writeText(request.file, bytes, true);
  return "Written: " + QString::fromStdString(request.file.string());
}

}  // namespace

AttemptPage::AttemptPage()
    : strip_(new WorkStrip(work_)),
      banner_(new AttemptBanner),
      summary_(new SummaryPanel),
      figures_(new FigurePanel),
      recording_(new RecordingView({})),
      find_(parts::named("find-recording", new QPushButton("Find the &recording …"))),
      force_(new TraceChart("force-trace", "Force on the hand (N): left solid, right dashed")),
      speed_(new TraceChart("speed-trace", "Speed of the tip (mm/s)")) {
  static_cast<QBoxLayout*>(recording_->layout())->insertWidget(1, find_, 0, Qt::AlignHCenter);
  QBoxLayout* const traces = parts::column({&recording_->timeline(), force_, speed_});
  traces->setSpacing(2);
  QSplitter* upper = makeSplitter(Qt::Horizontal, {{figures_, 3}, {recording_, 2}});
  upper->setSizes({720, 520});
  QSplitter* const all = makeSplitter(Qt::Vertical, {{upper, 1}, {parts::boxed(traces), 0}});
  setLayout(parts::column({banner_, summary_, {all, 1}, strip_}));
  begin_ = figures_->findChild<QWidget*>("attempt-checkpoints");
  connectParts();
  clear();
}

void AttemptPage::connectParts() {
  connect(find_, &QPushButton::clicked, this, &AttemptPage::askForRecording);
  connect(figures_, &FigurePanel::summaryChanged, this, [this] { summary_->showSummary(figures_->summary()); });
  connect(figures_, &FigurePanel::sheetRequested, this, &AttemptPage::askForSheet);
  connect(&work_, &LongWork::done, this, &AttemptPage::sheetWritten);
  connect(&work_, &LongWork::failed, this, &AttemptPage::problem);
  connect(figures_, &FigurePanel::problem, this, &AttemptPage::problem);
  connect(figures_, &FigurePanel::windowsChosen, &recording_->timeline(), &TimelineBar::setMarked);
  Replay* const replay = &recording_->replay();
  connect(figures_, &FigurePanel::timeChosen, replay, &Replay::seek);
  connect(&recording_->timeline(), &TimelineBar::timeChosen, replay, &Replay::seek);
  for (TraceChart* chart : {force_, speed_}) {
    connect(chart, &TraceChart::timeChosen, replay, &Replay::seek);
    connect(replay, &Replay::positionChanged, chart, [chart, replay] { chart->setPosition(replay->position().time); });
  }
  connect(recording_, &RecordingView::opened, this, [this] { figures_->setMomentsText("looking …"); });
  connect(recording_, &RecordingView::momentsFound, figures_, &FigurePanel::setMoments);
  connect(recording_, &RecordingView::failed, this, [this] {
    figures_->setMomentsText({});
    find_->setVisible(!recording_->isOpen());
  });
  connect(recording_, &RecordingView::trackRead, this, [this](const AttemptTrack& track) {
    figures_->setTrack(track.events, track.errors);
    force_->setTraces(track.seconds, track.bin, tracesOf(track, &HandTrace::force, 1.0));
    speed_->setTraces(track.seconds, track.bin, tracesOf(track, &HandTrace::speed, millimetres));
  });
  onKey(*this, Qt::Key_Space, [replay] { replay->togglePlaying(); });
  onKey(*this, Qt::Key_Comma, [replay] { replay->stepBy(-1); });
  onKey(*this, Qt::Key_Period, [replay] { replay->stepBy(1); });
}

void AttemptPage::setAttempt(std::shared_ptr<const CohortDocument> document, const analytics::AttemptRow& attempt) {
  document_ = std::move(document);
  // The same one after a reload, as it was: the replay goes on.
  const bool same = attempt_ && attempt_->uuid == attempt.uuid && attempt_->verifiedUtc == attempt.verifiedUtc &&
                    attempt_->chainHead == attempt.chainHead && attempt_->exclusionReason == attempt.exclusionReason;
  attempt_ = attempt;
  if (!same) outdate();
}

void AttemptPage::clear() {
  document_.reset();
  attempt_.reset();
  recording_->close("No attempt is chosen.", "No attempt is chosen.");
  banner_->showText("Choose an attempt on the page Attempts: double-click it, or press Enter.");
  summary_->hide();
  figures_->clear();
  find_->hide();
  force_->clear();
  speed_->clear();
}

void AttemptPage::read() {
  banner_->showAttempt(*attempt_);
  force_->clear();
  speed_->clear();
  figures_->setAttempt(document_, *attempt_);
  const bool found = recording_->open(*attempt_, *document_, judgedFigures(figures_->values()));
  find_->setVisible(!found);
  if (found) return;
  const QString name = QString::fromStdString(attempt_->fileName);
  recording_->close(
      (name.isEmpty()
           ? QString("The database names no file for this attempt.")
           : QString("%1 is not beside the database, nor in a folder where recordings were found before.").arg(name)) +
          "\nThe checkpoints stand; replay and timeline need the recording.",
      "No timeline without the recording.");
}

void AttemptPage::askForRecording() {
  if (!attempt_) return;
  const QString start = QFileInfo(QString::fromStdString(document_->path())).absolutePath();
  const QString file = QFileDialog::getOpenFileName(this, "Find " + QString::fromStdString(attempt_->fileName), start,
                                                    "Recordings (*.h5);;All files (*)");
  if (file.isEmpty()) return;
  settings::rememberRecordingFolder(QFileInfo(file).absolutePath());
  find_->hide();
  recording_->openFile(file.toStdString(), attempt_->uuid, judgedFigures(figures_->values()));
}

void AttemptPage::askForSheet(bool onePage) {
  const QString name =
      QString("%1-%2.pdf").arg(onePage ? "attempt" : "grade").arg(QString::fromStdString(attempt_->uuid).left(8));
  const QString file = QFileDialog::getSaveFileName(
      this, onePage ? "Write the attempt on one page" : "Write the grade sheet",
      QFileInfo(QString::fromStdString(document_->path())).absolutePath() + '/' + name, "PDF (*.pdf)");
  if (!file.isEmpty()) writeSheet(file.toStdString(), onePage);
}

void AttemptPage::writeSheet(const std::filesystem::path& file, bool onePage) {
  const analytics::Norm* const norm = figures_->norm();
  const SheetRequest request{document_->path(),
                             *attempt_,
                             figures_->summary(),
                             figures_->errors(),
                             figures_->worstMoments(),
                             recording_->isOpen() ? recording_->file() : std::filesystem::path(),
                             norm != nullptr ? norm->name : std::string(),
                             norm != nullptr ? norm->version : 0,
                             file};
  strip_->begin("Writing " + QString::fromStdString(file.filename().string()));
  work_.start([request, onePage](LongWork::Control& control) {
    return onePage ? writeOnePage(request, control) : writeGradeSheet(request, control);
  });
}

}  // namespace calot::gui
