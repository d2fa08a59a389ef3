// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/attempt/replay_transport.h"

#include <array>
#include <QComboBox>
#include <QLocale>
#include <QMetaObject>
#include <QSignalBlocker>
#include <QSlider>
#include <QToolButton>
#include <utility>

#include "gui/attempt/widget_parts.h"

namespace calot::gui {

Replay::Replay(Sink sink) : sink_(std::move(sink)) {}

Replay::~Replay() { close(); }

void Replay::open(const std::filesystem::path& file, const std::string& attempt) {
  close();
  const Back back = back_ = std::make_shared<Link<Replay>>(*this);
  player_ = std::make_unique<ReplayPlayer>(
      file, attempt,
      ReplayPlayer::Receiver{[back](std::shared_ptr<const SceneView> view, const PlayerPosition& position) {
                               back->pass([&](Replay& replay) { replay.hear(back, std::move(view), position); });
                             },
                             [back](const std::string& fault) {
                               Link<Replay>::post(back, [text = QString::fromStdString(fault)](Replay& replay) {
                                 replay.open_ = false;
                                 emit replay.failed(text);
                               });
                             },
                             [back](std::shared_ptr<const SceneView> view) {
                               back->pass([&](Replay& replay) { replay.sink_(std::move(view)); });
                             }});
  setSpeed(speed_);
}

void Replay::close() {
  if (back_) back_->cut();
  back_.reset();
  // It may be in the middle of opening a file, or of a step.
  if (player_)
    taskPool().start([player = std::shared_ptr<ReplayPlayer>(std::move(player_))]() mutable { player.reset(); });
  newest_.reset();  // nobody else is left to touch it
  open_ = false;
  position_ = {};
}

void Replay::hear(const Back& back, std::shared_ptr<const SceneView> view, const PlayerPosition& position) {
  sink_(std::move(view));
  const std::lock_guard lock(mutex_);
  const bool waiting = newest_.has_value();
  newest_ = position;
  // One call is under way already: it takes this position.
  if (!waiting)
    QMetaObject::invokeMethod(
        this, [this, back] { take(back); }, Qt::QueuedConnection);
}

void Replay::take(const Back& back) {
  if (!back->stands()) return;
  {
    const std::lock_guard lock(mutex_);
    if (!newest_) return;
    position_ = *std::exchange(newest_, std::nullopt);
  }
  if (!std::exchange(open_, true)) emit opened();
  emit positionChanged();
}

QToolButton* transportButton(const char* name, const char* what, QStyle::StandardPixmap picture) {
  auto* const made = parts::named(name, new QToolButton);
  made->setAccessibleName(what);
  made->setToolTip(what);
  made->setIcon(theme::buttonIcon(picture));
  made->setFocusPolicy(Qt::TabFocus);
  return made;
}

QSlider* scrubBar(const char* name, const char* spokenName) {
  auto* const made = parts::named(name, new QSlider(Qt::Horizontal));
  made->setAccessibleName(spokenName);
  made->setRange(0, scrubSteps);
  return made;
}

QComboBox* speedChoice(const char* name, const char* spokenName) {
  constexpr std::array speeds{0.1, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0};
  static_assert(speeds.front() == slowestReplay && speeds.back() == fastestReplay);
  auto* const made = parts::named(name, new QComboBox);
  made->setAccessibleName(spokenName);
  for (const double speed : speeds) made->addItem(QLocale().toString(speed, 'g', 3) + QString::fromUtf8(" ×"), speed);
  made->setCurrentIndex(3);
  return made;
}

TransportBar::TransportBar(Replay& replay)
    : replay_(replay),
      play_(transportButton("play", "Play or pause (Space)", QStyle::SP_MediaPlay)),
      back_(transportButton("step-back", "One step back (,)", QStyle::SP_MediaSkipBackward)),
      forward_(transportButton("step-forward", "One step forward (.)", QStyle::SP_MediaSkipForward)),
      scrub_(scrubBar("scrub", "Moment of the replay")),
      speed_(speedChoice("speed", "Speed of the replay")),
      time_(parts::plainLabel("replay-time", false)) {
  back_->setAutoRepeat(true);
  forward_->setAutoRepeat(true);
  setLayout(parts::bare(parts::row({back_, play_, forward_, {scrub_, 1}, time_, speed_})));
  connect(play_, &QToolButton::clicked, this, [this] { replay_.togglePlaying(); });
  connect(back_, &QToolButton::clicked, this, [this] { replay_.stepBy(-1); });
  connect(forward_, &QToolButton::clicked, this, [this] { replay_.stepBy(1); });
  connect(speed_, &QComboBox::currentIndexChanged, this,
          [this] { replay_.setSpeed(speed_->currentData().toDouble()); });
  connect(scrub_, &QSlider::valueChanged, this, [this](int value) {
    if (replay_.isOpen()) replay_.seek(replay_.position().seconds * value / scrubSteps);
  });
  connect(&replay_, &Replay::opened, this, [this] { setReady(true); });
  connect(&replay_, &Replay::failed, this, [this] { setReady(false); });
  connect(&replay_, &Replay::positionChanged, this, [this] { show(replay_.position()); });
  setReady(false);
}

void TransportBar::setReady(bool ready) {
  for (QWidget* widget : std::initializer_list<QWidget*>{play_, back_, forward_, scrub_, speed_})
    widget->setEnabled(ready);
  if (!ready) time_->setText("–:––");
}

void TransportBar::show(const PlayerPosition& position) {
  play_->setIcon(theme::buttonIcon(position.playing ? QStyle::SP_MediaPause : QStyle::SP_MediaPlay));
  if (!scrub_->isSliderDown()) {
    const QSignalBlocker quiet(scrub_);
    const double share = position.seconds > 0.0 ? position.time / position.seconds : 0.0;
    scrub_->setValue(static_cast<int>(share * scrubSteps));
  }
  QString text = QString::fromStdString(timeText(position.time) + " / " + timeText(position.seconds));
  if (position.hopping)
    text += "  keyframes";
  else if (!position.settled)
    text += " …";
  time_->setText(text);
  time_->setToolTip(QString("Step %1 of %2").arg(position.step + 1).arg(position.steps));
}

}  // namespace calot::gui
