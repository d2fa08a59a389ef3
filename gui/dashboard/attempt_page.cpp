// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/attempt_page.h"

#include <QBoxLayout>
#include <QFileDialog>
#include <QFileInfo>
#include <QPushButton>
#include <QShortcut>
#include <QSplitter>

#include "analytics/checkpoints/registry.h"
#include "gui/attempt/attempt_recording.h"
#include "gui/attempt/long_work.h"
#include "gui/attempt/replay_transport.h"
#include "gui/attempt/summary_panel.h"
#include "gui/attempt/widget_parts.h"
#include "gui/dashboard/attempt_banner.h"
#include "gui/dashboard/figure_panel.h"
#include "gui/dashboard/page_parts.h"
#include "gui/dashboard/settings.h"
#include "gui/dashboard/timeline_bar.h"
#include "gui/dashboard/trace_chart.h"
#include "gui/view/scene_picture_widget.h"

namespace calot::gui {
namespace {

/// Figures that say what is better: only these have bad moments.
RecordingReader::Figures judgedFigures(const std::vector<analytics::CheckpointValue>& values) {
  RecordingReader::Figures figures;
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

}  // namespace

AttemptPage::AttemptPage(QWidget* parent) : QWidget(parent) {
  figures_ = new FigurePanel;
  picture_ = new ScenePictureWidget;
  replay_ = std::make_unique<Replay>(
      [picture = picture_](std::shared_ptr<const SceneView> view) { picture->showView(std::move(view)); });
  reader_ = std::make_unique<RecordingReader>();

  auto* layout = new QVBoxLayout(this);
  banner_ = new AttemptBanner;
  layout->addWidget(banner_);
  summary_ = new SummaryPanel;
  layout->addWidget(summary_);
  auto* upper = new QSplitter(Qt::Horizontal);
  upper->addWidget(figures_);
  upper->addWidget(buildReplay());
  upper->setSizes({720, 520});
  upper->setStretchFactor(0, 3);
  upper->setStretchFactor(1, 2);
  upper->setChildrenCollapsible(false);
  timeline_ = new TimelineBar;
  force_ = new TraceChart("force-trace", "Force on the hand (N): left solid, right dashed");
  speed_ = new TraceChart("speed-trace", "Speed of the tip (mm/s)");
  auto* traces = new QWidget;
  auto* traceLayout = parts::bare<QVBoxLayout>(traces);
  traceLayout->setSpacing(2);
  for (QWidget* row : {static_cast<QWidget*>(timeline_), static_cast<QWidget*>(force_), static_cast<QWidget*>(speed_)})
    traceLayout->addWidget(row);
  auto* parts = new QSplitter(Qt::Vertical);
  parts->addWidget(upper);
  parts->addWidget(traces);
  parts->setStretchFactor(0, 1);
  parts->setChildrenCollapsible(false);
  layout->addWidget(parts, 1);
  setProperty(beginProperty, QVariant::fromValue<QObject*>(figures_->findChild<QWidget*>("attempt-checkpoints")));
  strip_ = new WorkStrip(work_);
  layout->addWidget(strip_);
  connectParts();
  clear();
}

AttemptPage::~AttemptPage() {
  // Their threads use the picture and this page.
  reader_.reset();
  replay_.reset();
}

QWidget* AttemptPage::buildReplay() {
  find_ = parts::named("find-recording", new QPushButton("Find the &recording …"));
  auto* made = new QWidget;
  auto* layout = parts::bare<QVBoxLayout>(made);
  layout->addWidget(picture_, 1);
  layout->addWidget(find_, 0, Qt::AlignHCenter);
  layout->addWidget(new TransportBar(*replay_));
  return made;
}

void AttemptPage::connectParts() {
  connect(find_, &QPushButton::clicked, this, &AttemptPage::askForRecording);
  connect(figures_, &FigurePanel::summaryChanged, this, [this] { summary_->showSummary(figures_->summary()); });
  connect(figures_, &FigurePanel::sheetRequested, this, [this] { askForSheet(false); });
  connect(figures_, &FigurePanel::onePageRequested, this, [this] { askForSheet(true); });
  connect(&work_, &LongWork::done, this, &AttemptPage::sheetWritten);
  connect(&work_, &LongWork::failed, this, &AttemptPage::problem);
  connect(figures_, &FigurePanel::problem, this, &AttemptPage::problem);
  connect(figures_, &FigurePanel::timeChosen, replay_.get(), &Replay::seek);
  connect(figures_, &FigurePanel::windowsChosen, timeline_, &TimelineBar::setMarked);
  connect(timeline_, &TimelineBar::timeChosen, replay_.get(), &Replay::seek);
  connect(force_, &TraceChart::timeChosen, replay_.get(), &Replay::seek);
  connect(speed_, &TraceChart::timeChosen, replay_.get(), &Replay::seek);

  connect(replay_.get(), &Replay::opened, this, [this] {
    figures_->setMomentsText("looking …");
    reader_->read(file_, judgedFigures(figures_->values()));
  });
  connect(replay_.get(), &Replay::positionChanged, this, [this] { showPosition(); });
  connect(replay_.get(), &Replay::failed, this, [this](const QString& reason) {
    reading_ = false;
    picture_->showText(reason);
    timeline_->setText("No timeline: the recording cannot be shown.");
    figures_->setMomentsText({});
    find_->show();
  });
  connect(reader_.get(), &RecordingReader::progress, this, [this](int percent) {
    if (percent < 50) timeline_->setText(QString("Reading the recording … %1 %").arg(2 * percent));
  });
  connect(reader_.get(), &RecordingReader::trackRead, this, &AttemptPage::takeTrack);
  connect(reader_.get(), &RecordingReader::momentsFound, this, &AttemptPage::takeMoments);
  connect(reader_.get(), &RecordingReader::failed, this, [this](const QString& reason) {
    reading_ = false;
    timeline_->setText(reason);
    figures_->setMomentsText({});
  });

  const auto key = [this](const QKeySequence& keys, auto action) {
    connect(new QShortcut(keys, this, nullptr, nullptr, Qt::WidgetWithChildrenShortcut), &QShortcut::activated, this,
            action);
  };
  key(Qt::Key_Space, [this] { replay_->togglePlaying(); });
  key(Qt::Key_Comma, [this] { replay_->stepBy(-1); });
  key(Qt::Key_Period, [this] { replay_->stepBy(1); });
}

void AttemptPage::setAttempt(std::shared_ptr<const CohortDocument> document, const analytics::AttemptRow& attempt) {
  document_ = std::move(document);
  // The same one after a reload, as it was: the replay goes on.
  const bool same = loaded_ && attempt_->uuid == attempt.uuid && attempt_->verifiedUtc == attempt.verifiedUtc &&
                    attempt_->chainHead == attempt.chainHead && attempt_->exclusionReason == attempt.exclusionReason;
  attempt_ = attempt;
  if (same) return;
  loaded_ = false;
  if (isVisible()) load();
}

void AttemptPage::clear() {
  document_.reset();
  attempt_.reset();
  loaded_ = false;
  reader_->stop();
  replay_->close();
  banner_->showText("Choose an attempt on the page Attempts: double-click it, or press Enter.");
  summary_->hide();
  figures_->clear();
  picture_->showText("No attempt is chosen.");
  find_->hide();
  timeline_->setText("No attempt is chosen.");
  force_->clear();
  speed_->clear();
}

void AttemptPage::showEvent(QShowEvent* event) {
  QWidget::showEvent(event);
  if (!loaded_ && attempt_) load();
}

void AttemptPage::hideEvent(QHideEvent* event) {
  QWidget::hideEvent(event);
  replay_->pause();
}

void AttemptPage::load() {
  loaded_ = true;
  reading_ = false;
  reader_->stop();
  replay_->close();
  banner_->showAttempt(*attempt_);
  force_->clear();
  speed_->clear();
  figures_->setAttempt(document_, *attempt_);
  const std::filesystem::path file = findRecording(*attempt_, document_->path(), settings::recordingPlaces());
  if (file.empty())
    showMissingRecording();
  else
    openRecording(file);
}

void AttemptPage::openRecording(const std::filesystem::path& file) {
  file_ = file;
  reading_ = true;
  find_->hide();
  picture_->showText("Opening " + QString::fromStdString(file.filename().string()) + " …");
  timeline_->setText("Checking the recording …");
  replay_->open(file, attempt_->uuid);
}

void AttemptPage::showMissingRecording() {
  const QString name = QString::fromStdString(attempt_->fileName);
  picture_->showText(
      (name.isEmpty()
           ? QString("The database names no file for this attempt.")
           : QString("%1 is not beside the database, nor in a folder where recordings were found before.").arg(name)) +
      "\nThe checkpoints stand; replay and timeline need the recording.");
  timeline_->setText("No timeline without the recording.");
  find_->show();
}

void AttemptPage::askForRecording() {
  if (!attempt_) return;
  const QString start = QFileInfo(QString::fromStdString(document_->path())).absolutePath();
  const QString file = QFileDialog::getOpenFileName(this, "Find " + QString::fromStdString(attempt_->fileName), start,
                                                    "Recordings (*.h5);;All files (*)");
  if (file.isEmpty()) return;
  settings::rememberRecordingFolder(QFileInfo(file).absolutePath());
  openRecording(file.toStdString());
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
  SheetRequest request;
  request.database = document_->path();
  request.attempt = *attempt_;
  request.summary = figures_->summary();
  request.events = figures_->events();
  request.moments = figures_->worstMoments();
  if (replay_->isOpen()) request.recording = file_;
  request.file = file;
  if (const analytics::Norm* norm = figures_->norm()) {
    request.norm = norm->name;
    request.normVersion = norm->version;
  }
  strip_->begin("Writing " + QString::fromStdString(file.filename().string()));
  work_.start([request, onePage](LongWork::Control& control) {
    return onePage ? writeOnePage(request, control) : writeGradeSheet(request, control);
  });
}

void AttemptPage::showPosition() {
  const double time = replay_->position().time;
  timeline_->setPosition(time);
  force_->setPosition(time);
  speed_->setPosition(time);
}

void AttemptPage::takeTrack(const AttemptTrack& track) {
  timeline_->setTrack(track);
  figures_->setEvents(track.events);
  force_->setTraces(track.seconds, track.bin, tracesOf(track, &HandTrace::force, 1.0));
  speed_->setTraces(track.seconds, track.bin, tracesOf(track, &HandTrace::speed, millimetres));
  showPosition();
}

bool AttemptPage::settled() const {
  return !reading_ && (!replay_->isOpen() || (replay_->position().settled && picture_->shown() > 0));
}

void AttemptPage::takeMoments(const std::vector<analytics::FigureMoments>& moments) {
  reading_ = false;
  figures_->setMoments(moments);
}

}  // namespace calot::gui
