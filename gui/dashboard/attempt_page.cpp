// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/attempt_page.h"

#include <QFileDialog>
#include <QFileInfo>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/cohort/cohort_database.h"
#include "analytics/report/attempt_sheet.h"
#include "gui/attempt/figure_text.h"
#include "gui/attempt/recording_file.h"
#include "gui/attempt/verdict_card.h"
#include "gui/dashboard/dialogs.h"
#include "gui/dashboard/figure_panel.h"
#include "gui/moments/moments.h"
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

struct SheetRequest {
  std::string database;
  analytics::AttemptSheet sheet;
  std::optional<analytics::Grade> grade;
  std::vector<analytics::SheetMoment> moments;
  std::filesystem::path recording;  ///< empty: no pictures
};

constexpr const char* sheetMaker = "calot " CALOT_VERSION;

/// Work for LongWork: the sheet, as `calot grade --pdf` writes it.
analytics::ReportDocument makeSheet(SheetRequest request, LongWork::Control& control) {
  control.progress(0.0, "Checking the cohort");
  analytics::refuseUnsound(request.database);
  const auto share = [&](double from, double to, const char* words) {
    return [&control, from, to, words](std::uint64_t done, std::uint64_t of) {
      control.progress(
          from + (to - from) * static_cast<double>(done) / static_cast<double>(std::max<std::uint64_t>(1, of)), words);
    };
  };
  analytics::AttemptSheet& sheet = request.sheet;
  if (request.grade) {
    // As one of the participant's attempts: with their history.
    const analytics::CohortDatabase cohort(request.database, analytics::CohortDatabase::Access::read);
    request.grade = analytics::gradeAttempt(sheet.attempt, cohort.listAttempts(), cohort.allValues(),
                                            request.grade->norm, false, request.database);
    sheet.grade = &*request.grade;
  }
  if (request.recording.empty()) {
    sheet.picturesMissing = "the recording " + sheet.attempt.fileName + " was not found";
    if (request.grade) request.grade->momentsMissing = sheet.picturesMissing;
  } else {
    recorder::Recording recording = openRecording(request.recording, sheet.attempt.uuid);
    if (request.grade)
      analytics::addMoments(*request.grade, analytics::findMoments(recording, analytics::weakFigures(*request.grade),
                                                                   share(0.1, 0.5, "Looking for moments")));
    sheet.pictures = sheetPictures(request.recording, request.moments, share(0.5, 0.9, "Drawing the moments"));
  }
  sheet.recording = request.recording.filename().string();
  return analytics::sheetDocument(sheet);
}

}  // namespace

AttemptPage::AttemptPage()
    : strip_(new WorkStrip(work_)),
      banner_(new AttemptBanner),
      verdict_(new VerdictCard),
      figures_(new FigurePanel),
      recording_(new RecordingView({})),
      find_(parts::named("find-recording", new QPushButton("Find the &recording …"))),
      goOn_(parts::named("go-on", new QPushButton("Go &on from here …"))),
      force_(new TraceChart("force-trace", "Force on the hand (N): left solid, right dashed")) {
  static_cast<QBoxLayout*>(recording_->layout())->insertWidget(1, find_, 0, Qt::AlignHCenter);
  goOn_->setToolTip("A branch: a performer, or a person in the trainer, does what comes now in another way");
  QBoxLayout* const left =
      parts::column({{recording_, 1}, &recording_->timeline(), force_, parts::row({parts::spring(), goOn_})});
  left->setSpacing(2);
  QBoxLayout* const right = parts::column({verdict_, {figures_, 1}});
  QSplitter* const all = makeSplitter(Qt::Horizontal, {{parts::boxed(left), 3}, {parts::boxed(right), 2}});
  all->setSizes({720, 520});
  setLayout(parts::column({banner_, {all, 1}, strip_}));
  begin_ = figures_->findChild<QWidget*>("attempt-checkpoints");
  connectParts();
  clear();
}

void AttemptPage::connectParts() {
  connect(find_, &QPushButton::clicked, this, &AttemptPage::askForRecording);
  connect(goOn_, &QPushButton::clicked, this, [this] {
    emit continuationRequested(QString::fromStdString(recording_->file().string()),
                               recording_->replay().position().time);
  });
  connect(figures_, &FigurePanel::summaryChanged, this, [this] {
    verdict_->showSummary(figures_->summary());
    verdict_->showErrors(figures_->errors());
  });
  connect(figures_, &FigurePanel::sheetRequested, this, &AttemptPage::askForSheet);
  connect(figures_, &FigurePanel::normRequested, this, &AttemptPage::normRequested);
  connect(&work_, &LongWork::done, this, [this](const QString& text) {
    if (const auto take = std::exchange(printed_, {})) take();
    emit sheetWritten(text);
  });
  connect(&work_, &LongWork::failed, this, &AttemptPage::problem);
  connect(figures_, &FigurePanel::problem, this, &AttemptPage::problem);
  connect(figures_, &FigurePanel::windowsChosen, &recording_->timeline(), &TimelineBar::setMarked);
  Replay* const replay = &recording_->replay();
  connect(figures_, &FigurePanel::timeChosen, replay, &Replay::seek);
  connect(verdict_, &VerdictCard::timeChosen, replay, &Replay::seek);
  connect(&recording_->timeline(), &TimelineBar::timeChosen, replay, &Replay::seek);
  connect(force_, &TraceChart::timeChosen, replay, &Replay::seek);
  connect(replay, &Replay::positionChanged, goOn_, [this] { goOn_->setEnabled(recording_->isOpen()); });
  connect(replay, &Replay::positionChanged, force_, [this, replay] { force_->setPosition(replay->position().time); });
  connect(recording_, &RecordingView::opened, this, [this] { figures_->setMomentsText("looking …"); });
  const auto goOn = [this] {
    for (const auto& action : std::exchange(afterReading_, {})) action();
  };
  connect(recording_, &RecordingView::momentsFound, this, [this, goOn](const auto& moments) {
    figures_->setMoments(moments);
    goOn();
  });
  connect(recording_, &RecordingView::missing, this, [this, goOn] {
    sayMissing();
    goOn();
  });
  connect(recording_, &RecordingView::failed, this, [this, goOn] {
    figures_->setMomentsText({});
    find_->setVisible(!recording_->isOpen());
    goOn();
  });
  connect(recording_, &RecordingView::trackRead, this, [this](const AttemptTrack& track) {
    figures_->setTrack(track.events, track.errors);
    verdict_->showErrors(track.errors);
    std::array<std::vector<double>, handCount> forces;
    for (std::size_t h = 0; h < handCount; ++h) forces[h] = track.hand[h].force;
    force_->setTraces(track.seconds, track.bin, std::move(forces));
  });
  onKey(*this, Qt::Key_W, [this] { whenRead([this] { figures_->showWorst(); }); });
  onKey(*this, Qt::Key_V, [this] { recording_->toggleFreeView(); });
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

void AttemptPage::whenRead(std::function<void()> action) {
  if (recording_->reading())
    afterReading_.push_back(std::move(action));
  else
    action();
}

void AttemptPage::clear() {
  afterReading_.clear();
  document_.reset();
  attempt_.reset();
  recording_->close("No attempt is chosen.", "No attempt is chosen.");
  banner_->showText("Choose an attempt on the page Attempts: double-click it, or press Enter.");
  verdict_->hide();
  figures_->clear();
  find_->hide();
  goOn_->setEnabled(false);
  force_->clear();
}

void AttemptPage::read() {
  afterReading_.clear();
  banner_->showAttempt(*attempt_);
  goOn_->setEnabled(false);
  force_->clear();
  figures_->setAttempt(document_, *attempt_);
  find_->hide();
  recording_->open(*attempt_, *document_, judgedFigures(figures_->values()));
}

void AttemptPage::sayMissing() {
  find_->show();
  const QString name = QString::fromStdString(attempt_->fileName);
  recording_->close((name.isEmpty() ? QString("The database names no file for this attempt.")
                                    : QString("%1 is neither beside the database nor in a folder where recordings were "
                                              "found before, or belongs to another attempt there.")
                                          .arg(name)) +
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

void AttemptPage::askForSheet() {
  if (!attempt_) return;
  const QString name = QString("sheet-%1.pdf").arg(QString::fromStdString(attempt_->uuid).left(8));
  const QString file = QFileDialog::getSaveFileName(
      this, "Write the grade sheet", QFileInfo(QString::fromStdString(document_->path())).absolutePath() + '/' + name,
      "PDF (*.pdf)");
  // Errors and moments are those of the recording.
  if (!file.isEmpty()) whenRead([this, file] { writeSheet(file.toStdString()); });
}

void AttemptPage::startSheet(const QString& what,
                             std::function<QString(const analytics::ReportDocument&, LongWork::Control&)> then) {
  SheetRequest request{document_->path(),
                       {*attempt_, figures_->values(), nullptr, figures_->errors(), {}, {}},
                       {},
                       figures_->worstMoments(),
                       recording_->isOpen() ? recording_->file() : std::filesystem::path()};
  if (figures_->grade() != nullptr) request.grade = *figures_->grade();
  strip_->begin(what);
  work_.start([request = std::move(request), then = std::move(then)](LongWork::Control& control) {
    return then(makeSheet(request, control), control);
  });
}

void AttemptPage::writeSheet(const std::filesystem::path& file) {
  printed_ = {};
  startSheet("Writing " + QString::fromStdString(file.filename().string()),
             [file](const analytics::ReportDocument& document, LongWork::Control& control) {
               control.progress(0.9, "Laying out the sheet");
               const std::string bytes = pdfReport(document, sheetMaker);
               control.progress(1.0, "Writing the sheet");
               recorder::writeText(file, bytes, true);
               return "Written: " + QString::fromStdString(file.string());
             });
}

bool AttemptPage::makeDocument(const Taker& take) {
  if (!attempt_ || work_.busy()) return false;
  const auto made = std::make_shared<analytics::ReportDocument>();
  whenRead([this, made, take] {
    printed_ = [made, take] { take(*made); };
    startSheet("Making the sheet", [made](const analytics::ReportDocument& document, LongWork::Control&) {
      *made = document;
      return QString("The sheet is ready.");
    });
  });
  return true;
}

}  // namespace calot::gui
