// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/attempt/replay.h"

#include <QMetaObject>
#include <utility>

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
                               back->pass([&](Replay& replay) {
                                 QMetaObject::invokeMethod(
                                     &replay,
                                     [&replay, back, text = QString::fromStdString(fault)] {
                                       if (!back->stands()) return;
                                       replay.open_ = false;
                                       emit replay.failed(text);
                                     },
                                     Qt::QueuedConnection);
                               });
                             }});
  player_->setSpeed(speed_);
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

void Replay::seek(double time) {
  if (player_) player_->seek(time);
}
void Replay::stepBy(int steps) {
  if (player_) player_->stepBy(steps);
}
void Replay::play() {
  if (player_) player_->play();
}
void Replay::playFrom(double time) {
  if (player_) player_->playFrom(time);
}
void Replay::pause() {
  if (player_) player_->pause();
}
void Replay::togglePlaying() {
  if (open_ && position_.playing)
    pause();
  else
    play();
}
void Replay::setSpeed(double speed) {
  speed_ = speed;
  if (player_) player_->setSpeed(speed);
}

}  // namespace calot::gui
