// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/attempt/transport_bar.h"

#include <algorithm>
#include <array>
#include <QBoxLayout>
#include <QComboBox>
#include <QLabel>
#include <QLocale>
#include <QSignalBlocker>
#include <QSlider>
#include <QStyle>
#include <QToolButton>

#include "gui/attempt/attempt_track.h"
#include "gui/attempt/theme.h"

namespace calot::gui {
namespace {

constexpr std::array speeds{0.1, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0};
constexpr int scrubSteps = 10000;
static_assert(speeds.front() == slowestReplay && speeds.back() == fastestReplay);

}  // namespace

TransportBar::TransportBar(Replay& replay, QWidget* parent) : QWidget(parent), replay_(replay) {
  auto* layout = new QHBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  const auto button = [&](const char* name, const char* what, QStyle::StandardPixmap icon) {
    auto* made = new QToolButton;
    made->setObjectName(name);
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
  scrub_ = new QSlider(Qt::Horizontal);
  scrub_->setObjectName("scrub");
  scrub_->setAccessibleName("Moment of the replay");
  scrub_->setRange(0, scrubSteps);
  layout->addWidget(scrub_, 1);
  time_ = new QLabel;
  time_->setObjectName("replay-time");
  time_->setTextFormat(Qt::PlainText);
  layout->addWidget(time_);
  speed_ = new QComboBox;
  speed_->setObjectName("speed");
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
