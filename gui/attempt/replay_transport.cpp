// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/attempt/replay_transport.h"

#include <array>
#include <QBoxLayout>
#include <QComboBox>
#include <QLabel>
#include <QLocale>
#include <QMetaObject>
#include <QSignalBlocker>
#include <QSlider>
#include <QStyle>
#include <QToolButton>
#include <utility>

#include "gui/attempt/replay_player.h"
#include "gui/attempt/widget_parts.h"

namespace calot::gui {

Replay::Replay(Sink sink, QObject* parent) : QObject(parent), sink_(std::move(sink)) {}

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

namespace {

constexpr std::array speeds{0.1, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0};
constexpr int scrubSteps = 10000;
static_assert(speeds.front() == slowestReplay && speeds.back() == fastestReplay);

}  // namespace

TransportBar::TransportBar(Replay& replay, QWidget* parent) : QWidget(parent), replay_(replay) {
  auto* layout = parts::bare<QHBoxLayout>(this);
  const auto button = [&](const char* name, const char* what, QStyle::StandardPixmap icon) {
    auto* made = parts::named(name, new QToolButton);
    made->setAccessibleName(what);
    made->setToolTip(what);
    made->setIcon(theme::buttonIcon(icon));
    made->setFocusPolicy(Qt::TabFocus);
    layout->addWidget(made);
    return made;
  };
  back_ = button("step-back", "One step back (,)", QStyle::SP_MediaSkipBackward);
  play_ = button("play", "Play or pause (Space)", QStyle::SP_MediaPlay);
  forward_ = button("step-forward", "One step forward (.)", QStyle::SP_MediaSkipForward);
  back_->setAutoRepeat(true);
  forward_->setAutoRepeat(true);
  scrub_ = parts::named("scrub", new QSlider(Qt::Horizontal));
  scrub_->setAccessibleName("Moment of the replay");
  scrub_->setRange(0, scrubSteps);
  layout->addWidget(scrub_, 1);
  time_ = parts::plainLabel("replay-time", false);
  layout->addWidget(time_);
  speed_ = parts::named("speed", new QComboBox);
  speed_->setAccessibleName("Speed of the replay");
  for (const double speed : speeds) speed_->addItem(QLocale().toString(speed, 'g', 3) + QString::fromUtf8(" ×"), speed);
  speed_->setCurrentIndex(3);
  layout->addWidget(speed_);

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
  for (QWidget* widget : {static_cast<QWidget*>(play_), static_cast<QWidget*>(back_), static_cast<QWidget*>(forward_),
                          static_cast<QWidget*>(scrub_), static_cast<QWidget*>(speed_)})
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
