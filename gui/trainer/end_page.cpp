// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/end_page.h"

#include <algorithm>
#include <QListWidget>
#include <QLocale>
#include <QPushButton>
#include <utility>

#include "analytics/assess.h"
#include "analytics/checkpoints/replay_words.h"
#include "gui/attempt/figure_text.h"
#include "gui/attempt/verdict_card.h"
#include "gui/attempt/widget_parts.h"
#include "gui/trainer/run_panel.h"
#include "gui/view/scene_picture_widget.h"
#include "recorder/base/errors.h"

namespace calot::gui {
namespace {

QString figureWords(const FigureReport& figure) {
  QString text = figure.title + ": " + figure.now;
  if (!figure.norm.isEmpty()) text += QString::fromUtf8("\n    norm: ") + figure.norm;
  if (!figure.before.isEmpty()) text += QString::fromUtf8("\n    last time: ") + figure.before;
  return text;
}

/// Path of the stored recording, or the reason why it is not stored.
QString putIntoCohort(const std::filesystem::path& file, const std::filesystem::path& cohort, unsigned threads,
                      LongWork::Control& control) {
  analytics::AssessSettings settings;
  settings.threads = threads;
  settings.progress = [&](std::uint64_t step, std::uint64_t of) {
    control.progress(of == 0 ? 0.0 : static_cast<double>(step) / static_cast<double>(of), "Verifying");
  };
  const analytics::JudgedRecording found = analytics::assessRecording(file.string(), settings);
  if (!found.record) throw Error(ErrorKind::damaged, Where{file.string()}, analytics::wordsFor(found.report));
  control.progress(1.0, "Storing");
  analytics::CohortDatabase database(cohort.string(), analytics::CohortDatabase::Access::create);
  database.storeAttempt(*found.record, found.values);
  return badgeText(found.record->verification.verdict);
}

QString titleFor(Purpose purpose) {
  if (purpose == Purpose::controls) return "You have tried the controls";
  return purpose == Purpose::demonstration ? "The demonstration has ended" : "The attempt has ended";
}

}  // namespace

using parts::button;
using parts::say;
using parts::selectableLabel;

EndPage::EndPage(Setup setup)
    : setup_(std::move(setup)),
      title_(selectableLabel("endTitle")),
      syntheticMark_(selectableLabel("endSynthetic")),
      outcome_(selectableLabel("endOutcome")),
      norm_(selectableLabel("endNorm")),
      previous_(selectableLabel("endPrevious")),
      lesson_(parts::named("lesson", new QLabel)),
      figures_(selectableLabel("endFigures")),
      momentsTitle_(selectableLabel("momentsTitle")),
      storeText_(selectableLabel("storeText")),
      verdict_(new VerdictCard),
      moments_(parts::named("moments", new QListWidget)),
      store_(button("&Put into the cohort", "store")),
      back_(button("Go &back to 2 s before it", "endBack")),
      again_(button("Sta&rt again", "again")),
      next_(button("&Next task", "next")),
      scenes_(button("&Other scene", "endScenes")),
      picture_(new ScenePictureWidget),
      parentPicture_(new ScenePictureWidget),
      strip_(new WorkStrip(work_)) {
  const auto replayIn = [](ScenePictureWidget* picture) {
    return std::make_unique<Replay>(
        [picture](std::shared_ptr<const SceneView> view) { picture->showView(std::move(view)); });
  };
  replay_ = replayIn(picture_);
  parentReplay_ = replayIn(parentPicture_);
  pair_ = std::make_unique<PairReplay>(*parentReplay_, *replay_);
  replaySide_ = buildReplay();
  store_->setToolTip("Simulates the attempt again, which verifies it, and stores its figures");
  back_->setToolTip("Simulates the attempt again up to two seconds before the mistake, and goes on from there");
  setLayout(parts::bare(parts::column({{parts::row({{replaySide_, 3}, {buildWords(), 2}}), 1}, strip_})));

  connect(moments_, &QListWidget::itemClicked, this, &EndPage::replayMoment);
  connect(moments_, &QListWidget::itemActivated, this, &EndPage::replayMoment);
  connect(moments_, &QListWidget::currentRowChanged, this, [this](int at) { back_->setEnabled(at >= 0); });
  connect(replay_.get(), &Replay::failed, this, [this](const QString& reason) { picture_->showText(reason); });
  connect(parentReplay_.get(), &Replay::failed, this,
          [this](const QString& reason) { parentPicture_->showText(reason); });
  for (Replay* const replay : {replay_.get(), parentReplay_.get()})
    connect(replay, &Replay::opened, this, &EndPage::alignReplays);
  connect(verdict_, &VerdictCard::timeChosen, this, [this](double time) { playFrom(std::max(0.0, time - goBackBy)); });
  connect(back_, &QPushButton::clicked, this, [this] {
    if (const auto time = chosenBranch(*moments_)) emit backRequested(*time);
  });
  connect(again_, &QPushButton::clicked, this, &EndPage::againRequested);
  connect(next_, &QPushButton::clicked, this, &EndPage::nextRequested);
  connect(scenes_, &QPushButton::clicked, this, &EndPage::scenesRequested);
  connect(store_, &QPushButton::clicked, this, &EndPage::store);
  connect(&work_, &LongWork::done, this, [this](const QString& verdict) {
    const bool shown = storing_ == attempt_;  // meanwhile there may have been another attempt
    say(storeText_, (shown ? QString() : QString("The attempt before this one: ")) + verdict + ", in the cohort.");
    inCohort_ = inCohort_ || shown;
    showStoring();
    read();
    emit stored();
  });
  connect(&work_, &LongWork::failed, this, [this](const QString& reason) {
    say(storeText_, "Not in the cohort: " + reason);
    showStoring();
    emit problem(reason);
  });
  connect(&work_, &LongWork::cancelled, this, [this] {
    say(storeText_, "Broken off: the cohort is as it was.");
    showStoring();
  });
}

EndPage::~EndPage() {  // threads of replays use the pictures
  replay_.reset();
  parentReplay_.reset();
}

QWidget* EndPage::buildReplay() {
  moments_->setAccessibleName("Moments to see again");
  moments_->setWordWrap(true);
  moments_->setToolTip("A click replays the moment, from two seconds before it");
  const auto titled = [](const char* text) {
    auto* const label = new QLabel(text);
    parts::embolden(label);
    return label;
  };
  nowTitle_ = titled("This time");
  parentSide_ = parts::boxed(parts::column({titled("Before"), {parentPicture_, 1}}));
  QWidget* const nowSide = parts::boxed(parts::column({nowTitle_, {picture_, 1}}));
  transport_ = new TransportBar(*replay_);
  pairTransport_ = new PairTransport(*pair_);
  return parts::boxed(parts::column(
      {{parts::row({{parentSide_, 1}, {nowSide, 1}}), 3}, transport_, pairTransport_, momentsTitle_, {moments_, 1}}));
}

QWidget* EndPage::buildWords() {
  parts::enlarge(title_, 1.6);
  parts::embolden(syntheticMark_);
  syntheticMark_->setText("SYNTHETIC: made by a performer, no person's attempt");
  theme::setGround(*syntheticMark_, QColor(0xf0, 0xe4, 0x42), Qt::black);
  figures_->setAccessibleName("Figures that count");
  lesson_->setAccessibleName("Both attempts in figures, from where the branch left its parent");
  lesson_->setWordWrap(true);
  lesson_->setTextFormat(Qt::RichText);
  auto* const inside = new QWidget;
  inside->setLayout(parts::bare(parts::column(
      {syntheticMark_, outcome_, verdict_, lesson_, norm_, previous_, figures_, storeText_, parts::spring()})));
  QBoxLayout* const first = parts::row({back_, parts::spring(), store_});
  QBoxLayout* const second = parts::row({scenes_, again_, parts::spring(), parts::primary(next_)});
  QScrollArea* const scroll = parts::scrolled(inside);
  scroll->viewport()->setAutoFillBackground(false);  // the sheet shows
  inside->setAutoFillBackground(false);
  return parts::sheet(parts::column({title_, {scroll, 1}, first, second}));
}

void EndPage::setMode(recorder::Mode mode) {
  mode_ = mode;
  replaySide_->setVisible(mode == recorder::Mode::practice);
}

void EndPage::showAttempt(const TrainingStatus& status, const Ended& ended) {
  const bool practice = mode_ == recorder::Mode::practice;
  if (shown_ && shown_->attempt.parent.empty()) earlier_ = std::exchange(shown_, std::nullopt);
  shown_.reset();
  file_ = status.file;
  attempt_ = status.attempt;
  parent_ = status.parentFile;
  branchedAt_ = status.branchedAt;
  inCohort_ = false;
  kept_ = status.kept;
  synthetic_ = status.operatorKind != recorder::OperatorKind::human;
  title_->setText(titleFor(ended.purpose));
  syntheticMark_->setVisible(synthetic_);
  say(outcome_, ended.result);
  verdict_->hide();
  for (QLabel* const label : {previous_, lesson_, figures_, storeText_}) say(label, {});
  say(norm_, practice ? QString("Reading the figures …")
                      : QString("An assessment shows neither figures nor mistakes here. Whoever instructs finds them "
                                "in the dashboard, when the attempt is in the cohort."));
  next_->setVisible(ended.next);
  next_->setText(ended.purpose == Purpose::own ? "&Next task" : "&Begin the task");
  back_->setVisible(practice && !synthetic_ && !status.figures.errors->empty());
  showStoring();
  if (!practice) {
    again_->setFocus();
    return;
  }
  listErrors(*moments_, *status.figures.errors, ended.stepSeconds);
  moments_->setCurrentRow(0);
  momentsTitle_->setText(moments_->count() > 0 ? "What went wrong: a click shows it again." : "Nothing went wrong.");
  errors_ = status.figures.errors;
  openReplays(status);
  read();
  (moments_->count() > 0 ? static_cast<QWidget*>(moments_) : again_)->setFocus();
}

void EndPage::openReplays(const TrainingStatus& status) {
  const bool branch = !parent_.empty();
  pair_->clear();
  for (QWidget* const part : {parentSide_, nowTitle_, pairTransport_}) part->setVisible(branch);
  transport_->setVisible(!branch);
  limitPictures();
  picture_->showText("Opening the replay …");
  replay_->open(file_, attempt_);
  if (!branch) return;
  parentPicture_->showText("Opening the replay …");
  parentReplay_->open(parent_, status.parent);
}

/// Both stand where the branch left its parent.
void EndPage::alignReplays() {
  if (parent_.empty() || !replay_->isOpen() || !parentReplay_->isOpen()) return;
  pair_->align({branchedAt_, branchedAt_});
}

void EndPage::playFrom(double time) {
  if (!pair_->alignment()) return replay_->playFrom(time);
  pair_->goTo(time - branchedAt_);
  pair_->play(true);
}

void EndPage::replayMoment() {
  if (const auto time = chosenBranch(*moments_)) playFrom(*time);
}

void EndPage::read() {
  if (mode_ != recorder::Mode::practice) return;
  reading_ = true;
  const auto job = [this, file = file_, parent = parent_, cohort = setup_.cohort, earlier = earlier_] {
    AttemptFacts facts = readFacts(file, cohort);
    std::optional<AttemptFacts> before = previousInCohort(facts, cohort);
    const bool comparable = earlier && earlier->attempt.comparabilityKey == facts.attempt.comparabilityKey &&
                            earlier->attempt.synthetic == facts.attempt.synthetic;
    if (comparable && (!before || before->attempt.startUtc < earlier->attempt.startUtc)) before = earlier;
    std::optional<Lesson> lesson;
    if (!parent.empty()) lesson = lessonOf(parent, file);
    return [this, report = reportOf(std::move(facts), before, normsOf(cohort)), lesson] { showReport(report, lesson); };
  };
  background_.run(job, [this](const QString& reason) {
    reading_ = false;
    say(norm_, "No figures: " + reason);
  });
}

void EndPage::showReport(const AttemptReport& report, const std::optional<Lesson>& lesson) {
  reading_ = false;
  shown_ = report.facts;
  inCohort_ = report.facts.inCohort;
  verdict_->showSummary(report.summary);
  if (errors_) verdict_->showErrors(*errors_);
  if (lesson)
    say(lesson_, QString("<b>Over %1 s from the branch on</b>").arg(QLocale().toString(lesson->seconds, 'f', 1)) +
                     stretchTable(lesson->figures, {"before", "this time"}));
  say(norm_, report.norm);
  say(previous_, report.previous);
  QStringList figures;
  for (const FigureReport& figure : report.figures) figures += figureWords(figure);
  say(figures_, figures.join('\n'));
  showStoring();
}

void EndPage::showStoring() {
  store_->setVisible(!setup_.cohort.empty() && !synthetic_ && kept_);
  store_->setEnabled(!work_.busy() && !inCohort_);
  store_->setText(inCohort_ ? "Is in the cohort" : "&Put into the cohort");
  if (storeText_->text().isEmpty() && setup_.cohort.empty() && !synthetic_ && kept_)
    say(storeText_, "To keep figures and to hold them against a norm, name a cohort when the trainer starts.");
}

void EndPage::store() {
  storing_ = attempt_;
  strip_->begin("Putting the attempt into the cohort");
  work_.start([file = file_, cohort = setup_.cohort, threads = setup_.threads](LongWork::Control& control) {
    return putIntoCohort(file, cohort, threads, control);
  });
  showStoring();
}

/// Two pictures beside each other are as wide as high, or they would show the middle alone.
void EndPage::resizeEvent(QResizeEvent* event) {
  QWidget::resizeEvent(event);
  limitPictures();
}

void EndPage::limitPictures() {
  const int most = parent_.empty() ? QWIDGETSIZE_MAX : std::max(160, replaySide_->width() * 3 / 8);
  for (ScenePictureWidget* const picture : {picture_, parentPicture_}) picture->setMaximumHeight(most);
}

void EndPage::leave() {
  pair_->clear();
  replay_->close();
  parentReplay_->close();
}

bool EndPage::settled() const {
  const bool practice = mode_ == recorder::Mode::practice;
  return !reading_ && !work_.busy() &&
         (!practice || !replay_->isOpen() || (replay_->position().settled && picture_->shown() > 0)) &&
         (parent_.empty() || pair_->alignment());
}

}  // namespace calot::gui
