// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/recording_view.h"

#include <algorithm>
#include <exception>
#include <QBoxLayout>
#include <QMetaObject>

#include "gui/attempt/widget_parts.h"
#include "gui/dashboard/dialogs.h"
#include "gui/view/thread_rank.h"
#include "gui/words/problem_words.h"

namespace calot::gui {
namespace {

struct BrokenOff {};

}  // namespace

RecordingView::RecordingView(Parts with, QWidget* parent)
    : QWidget(parent),
      reads_(with.timeline),
      picture_(new ScenePictureWidget),
      timeline_(new TimelineBar),
      replay_(std::make_unique<Replay>(
          [picture = picture_](std::shared_ptr<const SceneView> view) { picture->showView(std::move(view)); })) {
  auto* layout = parts::bare<QVBoxLayout>(this);
  layout->addWidget(picture_, 1);
  if (with.transport) layout->addWidget(new TransportBar(*replay_));
  layout->addWidget(timeline_);
  if (!with.timeline) timeline_->hide();
  connect(replay_.get(), &Replay::opened, this, [this] {
    busy_ = reads_;
    if (reads_) {
      back_ = std::make_shared<Link<RecordingView>>(*this);
      taskPool().start([back = back_, file = file_, figures = figures_] { read(back, file, figures); });
    }
    emit opened();
  });
  connect(replay_.get(), &Replay::positionChanged, this, [this] { timeline_->setPosition(replay_->position().time); });
  connect(replay_.get(), &Replay::failed, this, [this](const QString& reason) {
    picture_->showText(reason);
    fail("No timeline: the recording cannot be shown.");
  });
}

RecordingView::~RecordingView() {
  stopReading();
  replay_.reset();  // its thread uses the picture
}

bool RecordingView::open(const analytics::AttemptRow& attempt, const CohortDocument& document, const Figures& figures) {
  const std::filesystem::path file = findRecording(attempt, document.path(), settings::recordingPlaces());
  if (file.empty())
    close("The recording was not found. Open the attempt on its own page to say where it is.",
          "No timeline without the recording.");
  else
    openFile(file, attempt.uuid, figures);
  return !file.empty();
}

void RecordingView::openFile(const std::filesystem::path& file, const std::string& attempt, const Figures& figures) {
  close("Opening the recording …", "Checking the recording …");
  file_ = file;
  figures_ = figures;
  busy_ = true;
  replay_->open(file, attempt);
}

void RecordingView::close(const QString& text, const QString& timelineText) {
  stopReading();
  replay_->close();
  busy_ = false;
  file_.clear();
  track_.reset();
  picture_->showText(text);
  timeline_->setText(timelineText);
}

bool RecordingView::settled() const {
  return !busy_ && (!isOpen() || (replay_->position().settled && !picture_->picture().isNull()));
}

void RecordingView::hideEvent(QHideEvent* event) {
  QWidget::hideEvent(event);
  replay_->pause();
}

void RecordingView::stopReading() {
  if (back_) back_->cut();
  back_.reset();
}

void RecordingView::fail(const QString& timelineText) {
  busy_ = false;
  timeline_->setText(timelineText);
  emit failed();
}

void RecordingView::read(const Back& back, const std::filesystem::path& file, const Figures& figures) {
  stepBack(behindInterface);
  int shown = -1;
  const auto progress = [&](std::uint64_t done, std::uint64_t of) {
    bool wanted = false;
    back->pass([&](RecordingView&) { wanted = true; });
    if (!wanted) throw BrokenOff();
    const int percent = static_cast<int>(100 * done / std::max<std::uint64_t>(1, of));
    if (percent == std::exchange(shown, percent)) return;
    Link<RecordingView>::post(back, [percent](RecordingView& view) {
      if (!view.track_) view.timeline_->setText(QString("Reading the recording … %1 %").arg(percent));
    });
  };
  try {
    recorder::Recording recording(file);
    AttemptTrack track = readTrack(recording, progress);
    const bool results = track.none.empty();
    Link<RecordingView>::post(back, [track = std::move(track)](RecordingView& view) {
      view.timeline_->setTrack(track);
      emit view.trackRead(view.track_.emplace(track));
    });
    std::vector<analytics::FigureMoments> moments;
    if (results && !figures.empty()) moments = analytics::findMoments(recording, figures, progress);
    Link<RecordingView>::post(back, [moments = std::move(moments)](RecordingView& view) {
      view.busy_ = false;
      emit view.momentsFound(moments);
    });
  } catch (const BrokenOff&) {
  } catch (const std::exception& error) {
    Link<RecordingView>::post(
        back, [text = QString::fromStdString(problemText(error))](RecordingView& view) { view.fail(text); });
  }
}

}  // namespace calot::gui
