// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/pair_page.h"

#include <algorithm>
#include <QLocale>

#include "gui/attempt/figure_text.h"
#include "gui/attempt/stretch_figures.h"
#include "gui/words/event_words.h"

namespace calot::gui {
namespace {

constexpr int mostListed = 2000;  // attempts in a choice: a longer list is no choice

QString attemptText(const AttemptLines& lines, int row) {
  return QString("%1 · %2 · %3 · %4")
      .arg(lines.cell(row, AttemptLines::operatorColumn), lines.cell(row, AttemptLines::sceneColumn),
           lines.cell(row, AttemptLines::startColumn), lines.cell(row, AttemptLines::verificationColumn));
}

/// Data of an entry of the choice to align by; others are phases.
constexpr int byParting = -2;

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
      pair_(std::make_unique<PairReplay>(sides_[0]->replay(), sides_[1]->replay())),
      traces_(new TraceChart("pair-traces", "Both attempts: left solid, right dashed")),
      trace_(parts::choice("pair-trace", 10)),
      from_(parts::choice("align", 13)),
      figures_(parts::named("pair-figures", new QLabel)) {
  traces_->setMinimumHeight(theme::inType(96));
  trace_->addItems(
      {"force, left hand (N)", "force, right hand (N)", "speed, left tip (mm/s)", "speed, right tip (mm/s)"});
  figures_->setTextFormat(Qt::RichText);
  figures_->setWordWrap(true);
  figures_->setAccessibleName(
      "Both in figures, from the moment that they are aligned by to the end of the shorter one");
  QBoxLayout* const transport =
      parts::row({{"&Trace", trace_}, {"In &step from", from_}, {new PairTransport(*pair_), 1}});
  setLayout(parts::column({{parts::row({{sides_[0], 1}, {sides_[1], 1}}), 1}, traces_, figures_, transport}));
  connect(traces_, &TraceChart::timeChosen, this, [this](double time) {
    if (const auto& both = pair_->alignment()) pair_->goTo(both->begin() + time);
  });
  begin_ = sides_[0]->choiceBox();
  onKey(*this, Qt::Key_Space, [this] { pair_->play(!pair_->playing()); });
  for (std::size_t which = 0; which < 2; ++which) {
    connect(sides_[which], &PairSide::changing, this, [this] {
      pair_->clear();
      traces_->clear();
      figures_->clear();
      from_->setEnabled(false);
    });
    connect(sides_[which], &RecordingView::opened, this, [this] { fillAlignments(); });
    connect(sides_[which], &RecordingView::trackRead, this, [this] { fillAlignments(); });
    connect(&sides_[which]->timeline(), &TimelineBar::timeChosen, this, [this, which](double time) {
      if (const auto& both = pair_->alignment()) pair_->goTo(both->common(which, time));
    });
  }
  connect(trace_, &QComboBox::currentIndexChanged, this, [this] { showTraces(); });
  connect(from_, &QComboBox::currentIndexChanged, this, [this] { align(); });
  connect(pair_.get(), &PairReplay::changed, this, [this] {
    if (const auto& both = pair_->alignment()) traces_->setPosition(pair_->common() - both->begin());
  });
}

PairPage::~PairPage() = default;

void PairPage::read() {
  for (PairSide* const side : sides_) side->setDocument(document_);
}

void PairPage::hideEvent(QHideEvent* event) {
  QWidget::hideEvent(event);
  pair_->play(false);
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
  if (const auto& both = pair_->alignment()) pair_->goTo(0.5 * (both->begin() + both->end()));
}

bool PairPage::settled() const { return sides_[0]->settled() && sides_[1]->settled(); }

void PairPage::fillAlignments() {
  if (!bothOpen()) return;
  {
    const QSignalBlocker quiet(from_);
    const QVariant before = from_->currentData();
    from_->clear();
    from_->addItem("their starts", static_cast<int>(Phase::none));
    if (sides_[0]->track() && sides_[1]->track()) {
      if (partingTime(*sides_[0]->track(), *sides_[1]->track())) from_->insertItem(0, "where they part", byParting);
      for (const Phase phase : commonPhases(*sides_[0]->track(), *sides_[1]->track()))
        from_->addItem(QString::fromStdString(wordFor(phase)), static_cast<int>(phase));
    }
    from_->setCurrentIndex(std::max(0, from_->findData(from_->itemData(0) == byParting ? byParting : before)));
    from_->setEnabled(true);
  }
  align();
}

void PairPage::align() {
  if (!bothOpen() || from_->currentIndex() < 0) return;
  const int by = from_->currentData().toInt();
  std::array<double, 2> offsets{};
  if (sides_[0]->track() && sides_[1]->track()) {
    if (by == byParting) offsets.fill(partingTime(*sides_[0]->track(), *sides_[1]->track()).value_or(0.0));
    for (std::size_t which = 0; which < 2 && by != byParting; ++which)
      offsets[which] = firstOf(*sides_[which]->track(), static_cast<Phase>(by)).value_or(0.0);
  }
  pair_->align(offsets);
  showTraces();
  showFigures();
}

void PairPage::showFigures() {
  const auto& both = pair_->alignment();
  if (!both || !sides_[0]->track() || !sides_[1]->track()) return figures_->clear();
  const double seconds = both->shared();
  const std::array tracks{&*sides_[0]->track(), &*sides_[1]->track()};
  figures_->setText(QString("<b>Both, over %1 s from there</b>").arg(QLocale().toString(seconds, 'f', 1)) +
                    stretchTable(stretchFigures(tracks, both->offsets(), seconds), {"left", "right"}));
}

void PairPage::showTraces() {
  const auto& both = pair_->alignment();
  if (!both || !sides_[0]->track() || !sides_[1]->track()) return;
  const double length = both->end() - both->begin();
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
      const double common = both->begin() + (static_cast<double>(i) + 0.5) * bin;
      double value = 0.0;  // before its begin and behind its end
      if (both->runs(side, common) && track.bin > 0.0) {
        const auto at = static_cast<std::size_t>(both->own(side, common) / track.bin);
        if (at < values.size()) value = values[at] * (speed ? millimetresOfMetre : 1.0);
      }
      lines[side].push_back(value);
    }
  }
  traces_->setTraces(length, bin, std::move(lines));
  traces_->setPosition(pair_->common() - both->begin());
}

}  // namespace calot::gui
