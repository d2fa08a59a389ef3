// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/pair_page.h"

#include <algorithm>
#include <cmath>
#include <QBoxLayout>
#include <QComboBox>
#include <QLabel>
#include <QLocale>
#include <QShortcut>
#include <QSignalBlocker>
#include <QSlider>
#include <QStyle>
#include <QTimer>
#include <QToolButton>
#include <utility>

#include "analytics/checkpoints/phases.h"
#include "gui/dashboard/attempt_banner.h"
#include "gui/dashboard/open_recording.h"
#include "gui/dashboard/settings.h"
#include "gui/dashboard/timeline_bar.h"
#include "gui/dashboard/words.h"
#include "gui/view/scene_picture_widget.h"

namespace calot::gui {
namespace {

constexpr int scrubSteps = 10000;
constexpr int tickMilliseconds = 33;
constexpr double farAway = 0.25;  // s (times speed) that a side may be off before it is sent to its place
constexpr int mostListed = 2000;  // attempts in a choice: a longer list is no choice

QString attemptText(const analytics::AttemptRow& attempt) {
  return QString("%1 · %2 · %3 · %4")
      .arg(operatorText(attempt), QString::fromStdString(attempt.scene), startText(attempt.startUtc),
           badgeText(attempt.verification.verdict));
}

}  // namespace

PairPage::PairPage(QWidget* parent) : QWidget(parent) {
  auto* layout = new QVBoxLayout(this);
  auto* row = new QHBoxLayout;
  for (std::size_t which = 0; which < 2; ++which) row->addWidget(buildSide(which), 1);
  layout->addLayout(row, 1);
  layout->addWidget(buildTransport());
  tick_ = new QTimer(this);
  connect(tick_, &QTimer::timeout, this, [this] { onTick(); });
  connect(new QShortcut(Qt::Key_Space, this, nullptr, nullptr, Qt::WidgetWithChildrenShortcut), &QShortcut::activated,
          this, [this] { play(!playing_); });
}

PairPage::~PairPage() {
  // Their threads use the pictures and this page.
  for (Side& side : sides_) {
    side.reader.reset();
    side.replay.reset();
  }
}

QWidget* PairPage::buildSide(std::size_t which) {
  Side& side = sides_[which];
  auto* made = new QWidget;
  auto* layout = new QVBoxLayout(made);
  layout->setContentsMargins(0, 0, 0, 0);
  side.choice = new QComboBox;
  side.choice->setObjectName(which == 0 ? "left-attempt" : "right-attempt");
  side.choice->setAccessibleName(which == 0 ? "Attempt on the left" : "Attempt on the right");
  side.choice->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
  side.choice->setMinimumContentsLength(20);
  side.banner = new AttemptBanner;
  side.picture = new ScenePictureWidget;
  side.timeline = new TimelineBar;
  side.replay = std::make_unique<Replay>(
      [picture = side.picture](std::shared_ptr<const SceneView> view) { picture->showView(std::move(view)); });
  side.reader = std::make_unique<RecordingReader>();
  layout->addWidget(side.choice);
  layout->addWidget(side.banner);
  layout->addWidget(side.picture, 1);
  layout->addWidget(side.timeline);
  connect(side.choice, &QComboBox::currentIndexChanged, this, [this, which] { openSide(which); });
  connect(side.replay.get(), &Replay::opened, this, [this, which] {
    Side& opened = sides_[which];
    opened.seconds = opened.replay->position().seconds;
    opened.reader->read(opened.file, {});
    fillAlignments();
  });
  connect(side.replay.get(), &Replay::positionChanged, this,
          [this, which] { sides_[which].timeline->setPosition(sides_[which].replay->position().time); });
  connect(side.replay.get(), &Replay::failed, this, [this, which](const QString& reason) {
    sides_[which].picture->showText(reason);
    sides_[which].timeline->setText("No timeline: the recording cannot be shown.");
  });
  connect(side.reader.get(), &RecordingReader::trackRead, this, [this, which](const AttemptTrack& track) {
    sides_[which].track = track;
    sides_[which].timeline->setTrack(track);
    fillAlignments();
  });
  connect(side.reader.get(), &RecordingReader::failed, side.timeline, &TimelineBar::setText);
  connect(side.timeline, &TimelineBar::timeChosen, this, [this, which](double time) {
    if (alignment_) goTo(alignment_->common(which, time));
  });
  return made;
}

QWidget* PairPage::buildTransport() {
  auto* made = new QWidget;
  auto* layout = new QHBoxLayout(made);
  layout->setContentsMargins(0, 0, 0, 0);
  from_ = new QComboBox;
  from_->setObjectName("align");
  from_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
  from_->setMinimumContentsLength(13);
  auto* label = new QLabel("In step &from");
  label->setBuddy(from_);
  play_ = new QToolButton;
  play_->setObjectName("pair-play");
  play_->setAccessibleName("Play or pause both");
  play_->setToolTip("Play or pause both (Space)");
  play_->setIcon(style()->standardIcon(QStyle::SP_MediaPlay));
  play_->setFocusPolicy(Qt::TabFocus);
  scrub_ = new QSlider(Qt::Horizontal);
  scrub_->setObjectName("pair-scrub");
  scrub_->setAccessibleName("Moment of both");
  scrub_->setRange(0, scrubSteps);
  time_ = new QLabel;
  time_->setObjectName("pair-time");
  speed_ = new QComboBox;
  speed_->setObjectName("pair-speed");
  speed_->setAccessibleName("Speed of both");
  for (const double speed : {0.1, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0})
    speed_->addItem(QLocale().toString(speed, 'g', 3) + QString::fromUtf8(" ×"), speed);
  speed_->setCurrentIndex(3);
  layout->addWidget(label);
  layout->addWidget(from_);
  layout->addWidget(play_);
  layout->addWidget(scrub_, 1);
  layout->addWidget(time_);
  layout->addWidget(speed_);
  connect(from_, &QComboBox::currentIndexChanged, this, [this] { align(); });
  connect(play_, &QToolButton::clicked, this, [this] { play(!playing_); });
  connect(speed_, &QComboBox::currentIndexChanged, this, [this] {
    for (Side& side : sides_) side.replay->setSpeed(speed_->currentData().toDouble());
    if (playing_) play(true);
  });
  connect(scrub_, &QSlider::valueChanged, this, [this](int value) {
    if (alignment_)
      goTo(alignment_->begin() + (alignment_->end() - alignment_->begin()) * static_cast<double>(value) / scrubSteps);
  });
  return made;
}

void PairPage::setDocument(std::shared_ptr<const CohortDocument> document) {
  document_ = std::move(document);
  filled_ = false;
  if (isVisible()) fillChoices();
}

void PairPage::showEvent(QShowEvent* event) {
  QWidget::showEvent(event);
  if (!filled_ && document_) fillChoices();
}

void PairPage::fillChoices() {
  filled_ = true;
  for (Side& side : sides_) {
    const QSignalBlocker quiet(side.choice);
    side.choice->clear();
    side.choice->addItem("Choose an attempt …", QString());
    const auto& attempts = document_->attempts();
    // The newest first.
    for (std::size_t i = attempts.size(); i-- > 0 && side.choice->count() <= mostListed;)
      side.choice->addItem(attemptText(attempts[i]), QString::fromStdString(attempts[i].uuid));
    if (!side.wanted.empty()) side.uuid = std::exchange(side.wanted, {});
    const int at = side.uuid.empty() ? 0 : side.choice->findData(QString::fromStdString(side.uuid));
    side.choice->setCurrentIndex(std::max(0, at));
  }
  for (std::size_t which = 0; which < 2; ++which) openSide(which);
}

void PairPage::hideEvent(QHideEvent* event) {
  QWidget::hideEvent(event);
  play(false);
}

void PairPage::setAttempt(std::size_t side, const std::string& uuid) {
  if (!isVisible()) {
    sides_[side].wanted = uuid;
    filled_ = false;  // is chosen when the page is shown
    return;
  }
  const int at = sides_[side].choice->findData(QString::fromStdString(uuid));
  if (at >= 0) sides_[side].choice->setCurrentIndex(at);
}

void PairPage::chooseTwo() {
  for (std::size_t which = 0; which < 2; ++which) {
    const auto at = static_cast<int>(2 - which);
    if (sides_[which].uuid.empty() && sides_[which].choice->count() > at) sides_[which].choice->setCurrentIndex(at);
  }
}

void PairPage::showMiddle() {
  if (alignment_) goTo(0.5 * (alignment_->begin() + alignment_->end()));
}

bool PairPage::settled() const {
  return std::all_of(sides_.begin(), sides_.end(), [](const Side& side) {
    return side.file.empty() || (side.track && side.replay->isOpen() && side.replay->position().settled);
  });
}

void PairPage::openSide(std::size_t which) {
  Side& side = sides_[which];
  const std::string uuid = side.choice->currentData().toString().toStdString();
  const analytics::AttemptRow* attempt = uuid.empty() ? nullptr : document_->attempt(uuid);
  if (attempt != nullptr && side.opened == uuid && side.replay->isOpen()) return;
  play(false);
  side.uuid = side.opened = uuid;
  side.reader->stop();
  side.replay->close();
  side.track.reset();
  alignment_.reset();
  if (attempt == nullptr) {
    side.banner->showText(" ");
    side.picture->showText("No attempt is chosen.");
    side.timeline->setText({});
    showTime();
    return;
  }
  side.banner->showAttempt(*attempt);
  side.file = findRecording(*attempt, document_->path(), settings::recordingPlaces());
  if (side.file.empty()) {
    side.picture->showText(QString::fromStdString(attempt->fileName) +
                           " was not found. Open the attempt on its own page to say where it is.");
    side.timeline->setText("No timeline without the recording.");
    return;
  }
  side.picture->showText("Opening " + QString::fromStdString(side.file.filename().string()) + " …");
  side.timeline->setText("Checking the recording …");
  side.replay->open(side.file, uuid);
}

void PairPage::fillAlignments() {
  if (!bothOpen()) return;
  {
    const QSignalBlocker quiet(from_);
    const int before = from_->currentIndex() < 0 ? -1 : from_->currentData().toInt();
    from_->clear();
    from_->addItem("their starts", static_cast<int>(Phase::none));
    if (sides_[0].track && sides_[1].track) {
      for (const Phase phase : commonPhases(*sides_[0].track, *sides_[1].track))
        from_->addItem(analytics::nameOf(phase), static_cast<int>(phase));
    }
    from_->setCurrentIndex(std::max(0, from_->findData(before)));
  }
  align();
}

void PairPage::align() {
  if (!bothOpen() || from_->currentIndex() < 0) return;
  const auto phase = static_cast<Phase>(from_->currentData().toInt());
  std::array<double, 2> offsets{};
  for (std::size_t which = 0; which < 2; ++which) {
    if (phase != Phase::none && sides_[which].track)
      offsets[which] = firstOf(*sides_[which].track, phase).value_or(0.0);
  }
  alignment_.emplace(std::array{sides_[0].seconds, sides_[1].seconds}, offsets);
  goTo(0.0);
}

void PairPage::goTo(double common) {
  if (!alignment_) return;
  common_ = std::clamp(common, alignment_->begin(), alignment_->end());
  for (std::size_t which = 0; which < 2; ++which) sides_[which].replay->seek(alignment_->own(which, common_));
  if (playing_)
    play(true);
  else
    showTime();
}

void PairPage::play(bool playing) {
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
      sides_[which].replay->playFrom(alignment_->own(which, common_));
    else
      sides_[which].replay->pause();
  }
  if (playing_)
    tick_->start(tickMilliseconds);
  else if (tick_ != nullptr)
    tick_->stop();
  showTime();
}

void PairPage::onTick() {
  if (!playing_ || !alignment_) return;
  const double speed = speed_->currentData().toDouble();
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - clockBegin_;
  common_ = std::min(alignment_->end(), clockCommon_ + speed * passed.count());
  for (std::size_t which = 0; which < 2; ++which) {
    Replay& replay = *sides_[which].replay;
    if (!replay.isOpen()) continue;
    const bool runs = alignment_->runs(which, common_);
    const PlayerPosition& at = replay.position();
    if (runs && !at.playing && at.step + 1 < at.steps) {
      replay.playFrom(alignment_->own(which, common_));  // it waited for its begin
    } else if (runs && at.settled && at.time - alignment_->own(which, common_) > farAway * std::max(1.0, speed)) {
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
    showTime();
  }
}

void PairPage::showTime() {
  play_->setIcon(style()->standardIcon(playing_ ? QStyle::SP_MediaPause : QStyle::SP_MediaPlay));
  for (QWidget* widget : {static_cast<QWidget*>(play_), static_cast<QWidget*>(scrub_), static_cast<QWidget*>(from_),
                          static_cast<QWidget*>(speed_)})
    widget->setEnabled(alignment_.has_value());
  if (!alignment_) {
    time_->setText(QString::fromUtf8("–:––"));
    return;
  }
  const double length = alignment_->end() - alignment_->begin();
  if (!scrub_->isSliderDown()) {
    const QSignalBlocker quiet(scrub_);
    scrub_->setValue(length > 0.0 ? static_cast<int>((common_ - alignment_->begin()) / length * scrubSteps) : 0);
  }
  const QString sign = common_ < 0.0 ? QString::fromUtf8("−") : QString();
  time_->setText(sign + QString::fromStdString(timeText(std::abs(common_)) + " / " + timeText(alignment_->end())));
}

}  // namespace calot::gui
