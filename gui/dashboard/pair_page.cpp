// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/pair_page.h"

#include <algorithm>
#include <cmath>
#include <QSlider>
#include <QStyle>
#include <QToolButton>

#include "gui/attempt/figure_text.h"
#include "gui/words/event_words.h"

namespace calot::gui {
namespace {

constexpr int mostListed = 2000;  // attempts in a choice: a longer list is no choice

QString attemptText(const AttemptLines& lines, int row) {
  return QString("%1 · %2 · %3 · %4")
      .arg(lines.cell(row, AttemptLines::operatorColumn), lines.cell(row, AttemptLines::sceneColumn),
           lines.cell(row, AttemptLines::startColumn), lines.cell(row, AttemptLines::verificationColumn));
}

constexpr int tickMilliseconds = 33;
constexpr double farAway = 0.25;  // s (times speed) that a side may be off before it is sent to its place

}  // namespace

PairSide::PairSide(const QString& name)
    : RecordingView({.transport = false}), choice_(parts::choice("", 20)), banner_(new AttemptBanner) {
  choice_->setObjectName(name + "-attempt");
  choice_->setAccessibleName("Attempt on the " + name);
  banner_->makeNarrow();
  auto* rows = static_cast<QBoxLayout*>(layout());
  rows->insertWidget(0, choice_);
  rows->insertWidget(1, banner_);
  setTabOrder(choice_, &timeline());
  connect(choice_, &QComboBox::currentIndexChanged, this, [this] { openChosen(); });
}

void PairSide::setDocument(std::shared_ptr<const CohortDocument> document) {
  document_ = std::move(document);
  {
    const QSignalBlocker quiet(choice_);
    choice_->clear();
    choice_->addItem("Choose an attempt …", QString());
    const auto& attempts = document_->attempts();
    for (std::size_t i = attempts.size(); i-- > 0 && choice_->count() <= mostListed;)
      choice_->addItem(attemptText(*document_->lines(), static_cast<int>(i)), QString::fromStdString(attempts[i].uuid));
    if (!wanted_.empty()) uuid_ = std::exchange(wanted_, {});
    const int at = uuid_.empty() ? 0 : choice_->findData(QString::fromStdString(uuid_));
    choice_->setCurrentIndex(std::max(0, at));
  }
  openChosen();
}

void PairSide::choose(const std::string& uuid) {
  if (!isVisible()) {
    wanted_ = uuid;
    return;
  }
  const int at = choice_->findData(QString::fromStdString(uuid));
  if (at >= 0) choice_->setCurrentIndex(at);
}

void PairSide::chooseAnother(int n) {
  if (uuid_.empty() && choice_->count() > n) choice_->setCurrentIndex(n);
}

void PairSide::openChosen() {
  const std::string uuid = choice_->currentData().toString().toStdString();
  const analytics::AttemptRow* attempt = uuid.empty() ? nullptr : document_->attempt(uuid);
  if (attempt != nullptr && opened_ == uuid && isOpen()) return;
  uuid_ = opened_ = uuid;
  emit changing();
  if (attempt == nullptr) {
    banner_->showText(" ");
    close("No attempt is chosen.");
  } else {
    banner_->showAttempt(*attempt);
    open(*attempt, *document_);
  }
}

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

std::optional<double> firstOf(const AttemptTrack& track, Phase phase) {
  const auto at =
      std::find_if(track.phases.begin(), track.phases.end(), [&](const TrackPhase& p) { return p.phase == phase; });
  if (at == track.phases.end()) return std::nullopt;
  return at->begin;
}

std::vector<Phase> commonPhases(const AttemptTrack& a, const AttemptTrack& b) {
  std::vector<Phase> phases;
  for (const Phase phase : {Phase::identification, Phase::clipping, Phase::cutting, Phase::dissection}) {
    if (firstOf(a, phase) && firstOf(b, phase)) phases.push_back(phase);
  }
  return phases;
}

PairPage::PairPage()
    : sides_{new PairSide("left"), new PairSide("right")},
      traces_(new TraceChart("pair-traces", "Both attempts: left solid, right dashed")),
      trace_(parts::choice("pair-trace", 10)),
      from_(parts::choice("align", 13)),
      speed_(speedChoice("pair-speed", "Speed of both")),
      play_(transportButton("pair-play", "Play or pause both (Space)", QStyle::SP_MediaPlay)),
      scrub_(scrubBar("pair-scrub", "Moment of both")),
      time_(parts::named("pair-time", new QLabel)) {
  traces_->setMinimumHeight(theme::inType(96));
  trace_->addItems(
      {"force, left hand (N)", "force, right hand (N)", "speed, left tip (mm/s)", "speed, right tip (mm/s)"});
  play_->setAccessibleName("Play or pause both");
  QBoxLayout* const transport =
      parts::row({{"&Trace", trace_}, {"In &step from", from_}, play_, {scrub_, 1}, time_, speed_});
  setLayout(parts::column({{parts::row({{sides_[0], 1}, {sides_[1], 1}}), 1}, traces_, transport}));
  connect(traces_, &TraceChart::timeChosen, this, [this](double time) {
    if (alignment_) goTo(alignment_->begin() + time);
  });
  begin_ = sides_[0]->choiceBox();
  connect(&tick_, &QTimer::timeout, this, [this] { onTick(); });
  onKey(*this, Qt::Key_Space, [this] { play(!playing_); });
  for (std::size_t which = 0; which < 2; ++which) {
    connect(sides_[which], &PairSide::changing, this, [this] {
      play(false);
      alignment_.reset();
      traces_->clear();
      showTime();
    });
    connect(sides_[which], &RecordingView::opened, this, [this] { fillAlignments(); });
    connect(sides_[which], &RecordingView::trackRead, this, [this] { fillAlignments(); });
    connect(&sides_[which]->timeline(), &TimelineBar::timeChosen, this, [this, which](double time) {
      if (alignment_) goTo(alignment_->common(which, time));
    });
  }
  connect(trace_, &QComboBox::currentIndexChanged, this, [this] { showTraces(); });
  connect(from_, &QComboBox::currentIndexChanged, this, [this] { align(); });
  connect(play_, &QToolButton::clicked, this, [this] { play(!playing_); });
  connect(speed_, &QComboBox::currentIndexChanged, this, [this] {
    for (PairSide* const side : sides_) side->replay().setSpeed(speed_->currentData().toDouble());
    if (playing_) play(true);
  });
  connect(scrub_, &QSlider::valueChanged, this, [this](int value) {
    if (alignment_)
      goTo(alignment_->begin() + (alignment_->end() - alignment_->begin()) * static_cast<double>(value) / scrubSteps);
  });
}

void PairPage::read() {
  for (PairSide* const side : sides_) side->setDocument(document_);
}

void PairPage::hideEvent(QHideEvent* event) {
  QWidget::hideEvent(event);
  play(false);
}

void PairPage::setAttempt(std::size_t side, const std::string& uuid) {
  sides_[side]->choose(uuid);
  if (!isVisible()) outdate();  // it is opened when the page is shown
}

void PairPage::chooseTwo() {
  sides_[0]->chooseAnother(2);
  sides_[1]->chooseAnother(1);
}

void PairPage::showMiddle() {
  if (alignment_) goTo(0.5 * (alignment_->begin() + alignment_->end()));
}

bool PairPage::settled() const { return sides_[0]->settled() && sides_[1]->settled(); }

void PairPage::fillAlignments() {
  if (!bothOpen()) return;
  {
    const QSignalBlocker quiet(from_);
    const int before = from_->currentIndex() < 0 ? -1 : from_->currentData().toInt();
    from_->clear();
    from_->addItem("their starts", static_cast<int>(Phase::none));
    if (sides_[0]->track() && sides_[1]->track()) {
      for (const Phase phase : commonPhases(*sides_[0]->track(), *sides_[1]->track()))
        from_->addItem(QString::fromStdString(wordFor(phase)), static_cast<int>(phase));
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
    if (phase != Phase::none && sides_[which]->track())
      offsets[which] = firstOf(*sides_[which]->track(), phase).value_or(0.0);
  }
  alignment_.emplace(std::array{replay(0).position().seconds, replay(1).position().seconds}, offsets);
  showTraces();
  goTo(0.0);
}

void PairPage::showTraces() {
  if (!alignment_ || !sides_[0]->track() || !sides_[1]->track()) return;
  const double length = alignment_->end() - alignment_->begin();
  const int which = trace_->currentIndex();
  const auto hand = static_cast<std::size_t>(which % 2);
  const bool speed = which >= 2;
  constexpr double millimetresOfMetre = 1000.0;
  const double bin = length / static_cast<double>(maxBins);
  std::array<std::vector<double>, 2> lines;
  for (std::size_t side = 0; side < 2; ++side) {
    const AttemptTrack& track = *sides_[side]->track();
    const std::vector<double>& values = speed ? track.hand[hand].speed : track.hand[hand].force;
    for (std::uint64_t i = 0; i < maxBins; ++i) {
      const double common = alignment_->begin() + (static_cast<double>(i) + 0.5) * bin;
      double value = 0.0;  // before its begin and behind its end
      if (alignment_->runs(side, common) && track.bin > 0.0) {
        const auto at = static_cast<std::size_t>(alignment_->own(side, common) / track.bin);
        if (at < values.size()) value = values[at] * (speed ? millimetresOfMetre : 1.0);
      }
      lines[side].push_back(value);
    }
  }
  traces_->setTraces(length, bin, std::move(lines));
  traces_->setPosition(common_ - alignment_->begin());
}

void PairPage::goTo(double common) {
  if (!alignment_) return;
  common_ = std::clamp(common, alignment_->begin(), alignment_->end());
  for (std::size_t which = 0; which < 2; ++which) sides_[which]->replay().seek(alignment_->own(which, common_));
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
      sides_[which]->replay().playFrom(alignment_->own(which, common_));
    else
      sides_[which]->replay().pause();
  }
  if (playing_)
    tick_.start(tickMilliseconds);
  else
    tick_.stop();
  showTime();
}

void PairPage::onTick() {
  if (!playing_ || !alignment_) return;
  const double speed = speed_->currentData().toDouble();
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - clockBegin_;
  common_ = std::min(alignment_->end(), clockCommon_ + speed * passed.count());
  for (std::size_t which = 0; which < 2; ++which) {
    Replay& replay = sides_[which]->replay();
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
  play_->setIcon(theme::buttonIcon(playing_ ? QStyle::SP_MediaPause : QStyle::SP_MediaPlay));
  for (QWidget* widget : std::initializer_list<QWidget*>{play_, scrub_, from_, speed_})
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
  traces_->setPosition(common_ - alignment_->begin());
  const QString sign = common_ < 0.0 ? QString::fromUtf8("−") : QString();
  time_->setText(sign + QString::fromStdString(timeText(std::abs(common_)) + " / " + timeText(alignment_->end())));
}

}  // namespace calot::gui
