// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/recording_view.h"

#include <algorithm>
#include <cmath>

#include "gui/attempt/recording_file.h"
#include "gui/attempt/widget_parts.h"
#include "gui/dashboard/dialogs.h"

namespace calot::gui {
namespace {

/// Progress of reading, in steps, for a work.
auto stepsOf(LongWork::Control& control) {
  return [&control](std::uint64_t done, std::uint64_t of) {
    control.progress(static_cast<double>(done) / static_cast<double>(std::max<std::uint64_t>(1, of)), {});
  };
}

}  // namespace

RecordingView::RecordingView(Parts with)
    : reads_(with.timeline),
      picture_(new ScenePictureWidget(2)),
      free_(new FreeView),
      toggle_(parts::named("free-view-toggle", new QPushButton("Free view"))),
      timeline_(new TimelineBar),
      replay_(std::make_unique<Replay>([picture = picture_, free = free_](std::shared_ptr<const SceneView> view) {
        free->follow(view);
        picture->showView(std::move(view));
      })) {
  free_->hide();
  QBoxLayout* const rows = parts::bare(parts::column({{parts::row({{picture_, 1}, {free_, 1}}), 1}}));
  toggle_->setCheckable(true);
  toggle_->setToolTip("A second picture beside the endoscope's, from anywhere (V): drag it to turn it");
  connect(toggle_, &QPushButton::toggled, free_, &QWidget::setVisible);
  QBoxLayout* const controls = parts::bare(parts::row({{new TransportBar(*replay_), 1}, toggle_}));
  rows->addWidget(parts::boxed(controls));
  if (!with.transport) rows->itemAt(rows->count() - 1)->widget()->hide();
  rows->addWidget(timeline_);
  setLayout(rows);
  if (!with.timeline) timeline_->hide();
  connect(replay_.get(), &Replay::opened, this, [this] {
    busy_ = reads_;
    if (reads_) startTrack();
    emit opened();
  });
  connect(replay_.get(), &Replay::positionChanged, this, [this] { timeline_->setPosition(replay_->position().time); });
  connect(replay_.get(), &Replay::failed, this, [this](const QString& reason) {
    say(blinded_ ? "This film cannot be shown." : reason);
    fail("No timeline: the recording cannot be shown.");
  });
  connect(picture_, &ScenePictureWidget::pictureShown, this,
          [this](quint64 /*step*/, double time) { emit pictureShown(time); });
  connect(&work_, &LongWork::progressed, this, [this](double share) {
    if (!track_) timeline_->setText(QString("Reading the recording … %1 %").arg(static_cast<int>(100.0 * share)));
  });
  connect(&work_, &LongWork::failed, this, &RecordingView::fail);
  connect(&work_, &LongWork::done, this, [this] { std::exchange(take_, {})(); });
}

RecordingView::~RecordingView() { replay_.reset(); }  // its thread uses the picture

void RecordingView::open(const analytics::AttemptRow& attempt, const CohortDocument& document, const Figures& figures) {
  close("Looking for the recording …", "Looking for the recording …");
  busy_ = true;
  const auto lost = [this] {
    close("The recording was not found, neither beside the cohort nor in the folders that the settings name.",
          "No timeline without the recording.");
    emit missing();
  };
  finder_.run(
      [this, attempt, figures, lost, database = document.path(), places = settings::recordingPlaces()] {
        return [this, lost, figures, uuid = attempt.uuid, file = findRecording(attempt, database, places)] {
          if (file.empty())
            lost();
          else
            openFile(file, uuid, figures);
        };
      },
      [lost](const QString&) { lost(); });
}

void RecordingView::openFile(const std::filesystem::path& file, const std::string& attempt, const Figures& figures) {
  close("Opening the recording …", "Checking the recording …");
  file_ = file;
  figures_ = figures;
  busy_ = true;
  replay_->open(file, attempt);
}

void RecordingView::close(const QString& text, const QString& timelineText) {
  finder_.forget();
  work_.cancel();
  replay_->close();
  busy_ = false;
  file_.clear();
  track_.reset();
  say(text);
  free_->forget({});
  timeline_->setText(timelineText);
}

bool RecordingView::settled() const {
  if (busy_ || !isOpen()) return !busy_;
  const PlayerPosition& at = replay_->position();
  return at.settled && std::abs(picture_->time() - at.time) < 1e-6;
}

void RecordingView::toggleFreeView() { toggle_->toggle(); }

void RecordingView::hideEvent(QHideEvent* event) {
  QWidget::hideEvent(event);
  replay_->pause();
}

void RecordingView::say(const QString& text) {
  text_ = text;
  picture_->showText(text);
}

void RecordingView::fail(const QString& timelineText) {
  busy_ = false;
  timeline_->setText(timelineText);
  emit failed();
}

void RecordingView::startTrack() {
  const auto track = std::make_shared<AttemptTrack>();
  take_ = [this, track] {
    timeline_->setTrack(*track);
    emit trackRead(track_.emplace(*track));
    if (track_) startMoments();  // a slot may have closed it
  };
  work_.start([track, file = file_](LongWork::Control& control) {
    recorder::Recording recording(file);
    *track = readTrack(recording, stepsOf(control));
    return QString();
  });
}

void RecordingView::startMoments() {
  const auto moments = std::make_shared<std::vector<analytics::FigureMoments>>();
  take_ = [this, moments] {
    busy_ = false;
    emit momentsFound(*moments);
  };
  work_.start(
      [moments, file = file_, figures = track_->none.empty() ? figures_ : Figures()](LongWork::Control& control) {
        if (figures.empty()) return QString();
        recorder::Recording recording(file);
        *moments = analytics::findMoments(recording, figures, stepsOf(control)).figures;
        return QString();
      });
}

}  // namespace calot::gui
