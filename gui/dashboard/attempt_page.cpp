// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/attempt_page.h"

#include <QBoxLayout>
#include <QComboBox>
#include <QFileDialog>
#include <QFileInfo>
#include <QLabel>
#include <QPushButton>
#include <QShortcut>
#include <QSignalBlocker>
#include <QSplitter>
#include <QTableView>
#include <QTabWidget>

#include "analytics/checkpoints/registry.h"
#include "gui/dashboard/attempt_banner.h"
#include "gui/dashboard/band_delegate.h"
#include "gui/dashboard/open_recording.h"
#include "gui/dashboard/settings.h"
#include "gui/dashboard/table_view.h"
#include "gui/dashboard/timeline_bar.h"
#include "gui/dashboard/trace_chart.h"
#include "gui/dashboard/transport_bar.h"
#include "gui/view/scene_picture_widget.h"
#include "recorder/errors.h"

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
  picture_ = new ScenePictureWidget;
  replay_ = std::make_unique<Replay>(
      [picture = picture_](std::shared_ptr<const SceneView> view) { picture->showView(std::move(view)); });
  reader_ = std::make_unique<RecordingReader>();

  auto* layout = new QVBoxLayout(this);
  banner_ = new AttemptBanner;
  layout->addWidget(banner_);
  auto* upper = new QSplitter(Qt::Horizontal);
  upper->addWidget(buildFigures());
  upper->addWidget(buildReplay());
  upper->setSizes({720, 520});
  upper->setStretchFactor(0, 3);
  upper->setStretchFactor(1, 2);
  upper->setChildrenCollapsible(false);
  layout->addWidget(upper, 1);
  timeline_ = new TimelineBar;
  force_ = new TraceChart("force-trace", "Force on the hand (N): left solid, right dashed");
  speed_ = new TraceChart("speed-trace", "Speed of the tip (mm/s)");
  for (QWidget* row : {static_cast<QWidget*>(timeline_), static_cast<QWidget*>(force_), static_cast<QWidget*>(speed_)})
    layout->addWidget(row);
  connectParts();
  clear();
}

AttemptPage::~AttemptPage() {
  // Their threads use the picture and this page.
  reader_.reset();
  replay_.reset();
}

QWidget* AttemptPage::buildFigures() {
  figureTable_ = makeTable(figures_, "attempt-checkpoints", "Checkpoints of the attempt");
  figureTable_->setItemDelegateForColumn(CheckpointTableModel::normColumn, new BandDelegate(figureTable_));
  setWidths(*figureTable_, {190, 76, 100, 236, 100, 130, 130, 100, 60});
  eventTable_ = makeTable(events_, "events", "Events of the attempt");
  setWidths(*eventTable_, {80});
  auto* tabs = new QTabWidget;
  tabs->addTab(figureTable_, "&Checkpoints");
  tabs->addTab(eventTable_, "E&vents");

  norm_ = new QComboBox;
  norm_->setObjectName("norm");
  norm_->setAccessibleName("Norm that the attempt is held against");
  verdict_ = new QLabel;
  verdict_->setObjectName("verdict-of-norm");
  verdict_->setWordWrap(true);
  verdict_->setTextFormat(Qt::PlainText);
  auto* label = new QLabel("&Norm");
  label->setBuddy(norm_);
  auto* row = new QHBoxLayout;
  row->addWidget(label);
  row->addWidget(norm_);
  row->addWidget(verdict_, 1);
  auto* made = new QWidget;
  auto* layout = new QVBoxLayout(made);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->addLayout(row);
  layout->addWidget(tabs, 1);
  return made;
}

QWidget* AttemptPage::buildReplay() {
  find_ = new QPushButton("&Find the recording …");
  find_->setObjectName("find-recording");
  auto* made = new QWidget;
  auto* layout = new QVBoxLayout(made);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->addWidget(picture_, 1);
  layout->addWidget(find_, 0, Qt::AlignHCenter);
  layout->addWidget(new TransportBar(*replay_));
  return made;
}

void AttemptPage::connectParts() {
  connect(find_, &QPushButton::clicked, this, &AttemptPage::askForRecording);
  connect(norm_, &QComboBox::currentIndexChanged, this, [this] { showStanding(); });
  connect(figureTable_, &QTableView::clicked, this, [this](const QModelIndex& at) { showFigure(at.row()); });
  for (const Qt::Key key : {Qt::Key_Return, Qt::Key_Enter}) {
    connect(new QShortcut(key, figureTable_, nullptr, nullptr, Qt::WidgetShortcut), &QShortcut::activated, this,
            [this] {
              if (figureTable_->currentIndex().isValid()) showFigure(figureTable_->currentIndex().row());
            });
  }
  const auto showEvent = [this](const QModelIndex& at) { replay_->seek(events_.at(at.row()).time); };
  connect(eventTable_, &QTableView::clicked, this, showEvent);
  connect(eventTable_, &QTableView::activated, this, showEvent);
  connect(timeline_, &TimelineBar::timeChosen, replay_.get(), &Replay::seek);
  connect(force_, &TraceChart::timeChosen, replay_.get(), &Replay::seek);
  connect(speed_, &TraceChart::timeChosen, replay_.get(), &Replay::seek);

  connect(replay_.get(), &Replay::opened, this, [this] {
    figures_.setMomentsText("looking …");
    reader_->read(file_, judgedFigures(values_));
  });
  connect(replay_.get(), &Replay::positionChanged, this, [this] { showPosition(); });
  connect(replay_.get(), &Replay::failed, this, [this](const QString& reason) {
    reading_ = false;
    picture_->showText(reason);
    timeline_->setText("No timeline: the recording cannot be shown.");
    figures_.setMomentsText({});
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
    figures_.setMomentsText({});
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
  wanted_.reset();
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
  figures_.setValues({});
  events_.setEvents({});
  {
    const QSignalBlocker quiet(norm_);
    norm_->clear();
  }
  norm_->setEnabled(false);
  verdict_->clear();
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
  cycle_.forget();
  reader_->stop();
  replay_->close();
  banner_->showAttempt(*attempt_);
  events_.setEvents({});
  force_->clear();
  speed_->clear();
  try {
    values_ = document_->values(attempt_->uuid);
  } catch (const Error& error) {
    values_.clear();
    emit problem(QString::fromUtf8(error.what()));
  }
  figures_.setValues(values_);
  {
    const QSignalBlocker quiet(norm_);
    norm_->clear();
    for (const analytics::Norm* norm : normsFor(*attempt_, document_->norms()))
      norm_->addItem(QString("%1, version %2").arg(QString::fromStdString(norm->name)).arg(norm->version));
  }
  norm_->setEnabled(norm_->count() > 0);
  showStanding();
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

void AttemptPage::showStanding() {
  const auto norms = attempt_ ? normsFor(*attempt_, document_->norms()) : std::vector<const analytics::Norm*>();
  const int at = norm_->currentIndex();
  if (at < 0 || static_cast<std::size_t>(at) >= norms.size()) {
    verdict_->setText("There is no norm for attempts of this kind (calot norm create).");
    figures_.setStandings({});
    return;
  }
  const AttemptStanding standing = standingOf(*attempt_, values_, *norms[static_cast<std::size_t>(at)]);
  verdict_->setText(QString::fromStdString(standing.verdict));
  figures_.setStandings(standing.figures);
}

void AttemptPage::showFigure(int row) {
  const analytics::FigureMoments* found = figures_.moments(row);
  if (found == nullptr) return;
  std::vector<std::pair<double, double>> windows;
  for (const analytics::Moment& moment : found->moments) windows.emplace_back(moment.begin, moment.end);
  timeline_->setMarked(std::move(windows));
  if (const auto time = cycle_.next(*found)) replay_->seek(*time);
}

void AttemptPage::goToFigure(const std::string& checkpoint, const std::string& subject) {
  for (int row = 0; row < figures_.rowCount(); ++row) {
    const analytics::CheckpointValue& value = figures_.value(row);
    if (value.name != checkpoint || value.subject != subject) continue;
    figureTable_->selectRow(row);
    figureTable_->scrollTo(figures_.index(row, 0));
    if (figures_.moments(row) != nullptr)
      showFigure(row);
    else
      wanted_ = {checkpoint, subject};
    return;
  }
}

void AttemptPage::showPosition() {
  const double time = replay_->position().time;
  timeline_->setPosition(time);
  force_->setPosition(time);
  speed_->setPosition(time);
}

void AttemptPage::takeTrack(const AttemptTrack& track) {
  timeline_->setTrack(track);
  events_.setEvents(track.events);
  force_->setTraces(track.seconds, track.bin, tracesOf(track, &HandTrace::force, 1.0));
  speed_->setTraces(track.seconds, track.bin, tracesOf(track, &HandTrace::speed, millimetres));
  showPosition();
}

void AttemptPage::showWorst() {
  int chosen = -1;
  for (int row = 0; row < figures_.rowCount(); ++row) {
    const analytics::FigureMoments* found = figures_.moments(row);
    if (found == nullptr || found->moments.empty()) continue;
    const FigureStanding* standing = figures_.standing(row);
    const bool weak = standing != nullptr && standing->passed && !*standing->passed;
    if (chosen < 0 || weak) chosen = row;
    if (weak) break;
  }
  if (chosen < 0) return;
  figureTable_->selectRow(chosen);
  showFigure(chosen);
}

bool AttemptPage::settled() const {
  return !reading_ && (!replay_->isOpen() || (replay_->position().settled && picture_->shown() > 0));
}

void AttemptPage::takeMoments(const std::vector<analytics::FigureMoments>& moments) {
  reading_ = false;
  figures_.setMomentsText({});
  figures_.setMoments(moments);
  if (const auto wanted = std::exchange(wanted_, std::nullopt)) goToFigure(wanted->first, wanted->second);
}

}  // namespace calot::gui
