// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/attempt/pair_replay.h"

#include <algorithm>
#include <cmath>
#include <QComboBox>
#include <QLabel>
#include <QSignalBlocker>
#include <QSlider>
#include <QToolButton>

#include "gui/attempt/widget_parts.h"
#include "gui/words/event_words.h"

namespace calot::gui {
namespace {

constexpr int tickMilliseconds = 33;
constexpr double farAway = 0.25;  // s (times speed) that a side may be off before it is sent to its place

}  // namespace

PairAlignment::PairAlignment(std::array<double, 2> seconds, std::array<double, 2> offsets)
    : seconds_(seconds),
      offsets_(offsets),
      begin_(std::min(-offsets[0], -offsets[1])),
      end_(std::max(seconds[0] - offsets[0], seconds[1] - offsets[1])) {}

double PairAlignment::own(std::size_t which, double common) const {
  return std::clamp(common + offsets_[which], 0.0, seconds_[which]);
}

bool PairAlignment::runs(std::size_t which, double common) const {
  const double time = common + offsets_[which];
  return time >= 0.0 && time < seconds_[which];
}

double PairAlignment::shared() const {
  return std::max(0.0, std::min(seconds_[0] - offsets_[0], seconds_[1] - offsets_[1]));
}

PairReplay::PairReplay(Replay& left, Replay& right) : replay_{&left, &right} {
  connect(&tick_, &QTimer::timeout, this, [this] { onTick(); });
}

void PairReplay::align(std::array<double, 2> offsets) {
  alignment_.emplace(std::array{replay_[0]->position().seconds, replay_[1]->position().seconds}, offsets);
  goTo(0.0);
}

void PairReplay::clear() {
  play(false);
  alignment_.reset();
  emit changed();
}

void PairReplay::goTo(double common) {
  if (!alignment_) return;
  common_ = std::clamp(common, alignment_->begin(), alignment_->end());
  for (std::size_t which = 0; which < 2; ++which) replay_[which]->seek(alignment_->own(which, common_));
  if (playing_)
    play(true);
  else
    emit changed();
}

void PairReplay::play(bool playing) {
  playing_ = playing && alignment_;
  if (playing_ && common_ >= alignment_->end()) {
    playing_ = false;
    goTo(alignment_->begin());
    playing_ = true;
  }
  clockBegin_ = std::chrono::steady_clock::now();
  clockCommon_ = common_;
  for (std::size_t which = 0; which < 2; ++which) {
    if (playing_ && alignment_->runs(which, common_))
      replay_[which]->playFrom(alignment_->own(which, common_));
    else
      replay_[which]->pause();
  }
  if (playing_)
    tick_.start(tickMilliseconds);
  else
    tick_.stop();
  emit changed();
}

void PairReplay::setSpeed(double speed) {
  speed_ = speed;
  for (Replay* const replay : replay_) replay->setSpeed(speed);
  if (playing_) play(true);
}

void PairReplay::onTick() {
  if (!playing_ || !alignment_) return;
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - clockBegin_;
  common_ = std::min(alignment_->end(), clockCommon_ + speed_ * passed.count());
  for (std::size_t which = 0; which < 2; ++which) {
    Replay& replay = *replay_[which];
    if (!replay.isOpen()) continue;
    const bool runs = alignment_->runs(which, common_);
    const PlayerPosition& at = replay.position();
    if (runs && !at.playing && at.step + 1 < at.steps) {
      replay.playFrom(alignment_->own(which, common_));  // it waited for its begin
    } else if (runs && at.settled && at.time - alignment_->own(which, common_) > farAway * std::max(1.0, speed_)) {
      replay.seek(alignment_->own(which, common_));
    } else if (!runs && at.playing) {
      // Pictures are a little late: it stands at its very end, or at its begin.
      replay.pause();
      replay.seek(alignment_->own(which, common_));
    }
  }
  if (common_ >= alignment_->end()) {
    play(false);
    goTo(alignment_->end());
  } else {
    emit changed();
  }
}

PairTransport::PairTransport(PairReplay& pair)
    : pair_(pair),
      play_(transportButton("pair-play", "Play or pause both (Space)", QStyle::SP_MediaPlay)),
      scrub_(scrubBar("pair-scrub", "Moment of both")),
      time_(parts::named("pair-time", new QLabel)),
      speed_(speedChoice("pair-speed", "Speed of both")) {
  play_->setAccessibleName("Play or pause both");
  setLayout(parts::bare(parts::row({play_, {scrub_, 1}, time_, speed_})));
  connect(&pair_, &PairReplay::changed, this, &PairTransport::show);
  connect(play_, &QToolButton::clicked, this, [this] { pair_.play(!pair_.playing()); });
  connect(speed_, &QComboBox::currentIndexChanged, this, [this] { pair_.setSpeed(speed_->currentData().toDouble()); });
  connect(scrub_, &QSlider::valueChanged, this, [this](int value) {
    const std::optional<PairAlignment>& both = pair_.alignment();
    if (both) pair_.goTo(both->begin() + (both->end() - both->begin()) * static_cast<double>(value) / scrubSteps);
  });
  show();
}

void PairTransport::show() {
  const std::optional<PairAlignment>& both = pair_.alignment();
  play_->setIcon(theme::buttonIcon(pair_.playing() ? QStyle::SP_MediaPause : QStyle::SP_MediaPlay));
  for (QWidget* const part : std::initializer_list<QWidget*>{play_, scrub_, speed_}) part->setEnabled(both.has_value());
  if (!both) {
    time_->setText(QString::fromUtf8("–:––"));
    return;
  }
  const double length = both->end() - both->begin(), common = pair_.common();
  if (!scrub_->isSliderDown()) {
    const QSignalBlocker quiet(scrub_);
    scrub_->setValue(length > 0.0 ? static_cast<int>((common - both->begin()) / length * scrubSteps) : 0);
  }
  const QString sign = common < 0.0 ? QString::fromUtf8("−") : QString();
  time_->setText(sign + QString::fromStdString(timeText(std::abs(common)) + " / " + timeText(both->end())));
}

}  // namespace calot::gui
