// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/end_page.h"

#include <algorithm>
#include <cmath>
#include <QListWidget>
#include <QPushButton>
#include <system_error>
#include <utility>

#include "analytics/assess.h"
#include "analytics/checkpoints/checkpoint.h"
#include "analytics/checkpoints/collector.h"
#include "analytics/checkpoints/replay_words.h"
#include "analytics/report/key_figures.h"
#include "gui/attempt/figure_text.h"
#include "gui/attempt/widget_parts.h"
#include "gui/trainer/run_panel.h"
#include "gui/view/scene_picture_widget.h"
#include "recorder/base/errors.h"
#include "recorder/recording/reader.h"

namespace calot::gui {
namespace {

using Access = analytics::CohortDatabase::Access;

bool isThere(const std::filesystem::path& cohort) {
  std::error_code ignored;
  return !cohort.empty() && std::filesystem::exists(cohort, ignored);
}

const analytics::CheckpointValue* sameFigure(const std::vector<analytics::CheckpointValue>& values,
                                             const analytics::CheckpointValue& as) {
  const auto at = std::find_if(values.begin(), values.end(), [&](const analytics::CheckpointValue& v) {
    return v.name == as.name && v.subject == as.subject && v.version == as.version;
  });
  return at == values.end() ? nullptr : &*at;
}

/// @param of the value whose checkpoint the number belongs to
QString withUnit(double number, const analytics::CheckpointValue& of) {
  const QString text = numberText(number, analytics::definitionOf(of)), unit = displayedValue(of).unit;
  return unit.isEmpty() ? text : text + ' ' + unit;
}

QString normWords(const FigureStanding& standing, const analytics::CheckpointValue& of) {
  QString text;
  if (standing.cut) text = "pass mark " + withUnit(*standing.cut, of);
  if (standing.band) {
    text += text.isEmpty() ? "half of the competent people " : ", half of the competent people ";
    text += numberText(standing.band->p25, analytics::definitionOf(of)) + " to " + withUnit(standing.band->p75, of);
  }
  if (standing.passed) text += *standing.passed ? ": reached" : ": falls short";
  if (standing.passed && standing.undecided) text += " (not decided by this simulation)";
  return text;
}

/// @param judges both attempts were completed: who did less of a task was not better at it
QString beforeWords(const analytics::CheckpointValue& now, const analytics::CheckpointValue& before, bool judges) {
  if (!before.value) return {};
  const QString then = valueText(before);
  if (!now.value) return then;
  const DisplayedValue a = displayedValue(before), b = displayedValue(now);
  const double change = b.number - a.number;
  constexpr double nothing = 1e-6;  // of what is shown: rounding, as of the path of a tip that stands still
  if (numberText(a.number) == numberText(b.number) || std::abs(change) < nothing) return then + ", the same";
  const QString by = withUnit(std::abs(change), now);
  const analytics::CheckpointDefinition* const definition = analytics::definitionOf(now);
  const auto direction = definition != nullptr ? definition->direction : analytics::Direction::none;
  if (!judges || direction == analytics::Direction::none)
    return then + (change > 0.0 ? ", now more by " : ", now less by ") + by;
  const bool better = (change < 0.0) == (direction == analytics::Direction::lower);
  return then + (better ? ", better by " : ", worse by ") + by;
}

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

}  // namespace

AttemptFacts readFacts(const std::filesystem::path& file, const std::filesystem::path& cohort) {
  AttemptFacts facts;
  recorder::Recording recording(file);
  const std::string uuid = recording.header().attempt;
  if (isThere(cohort)) {
    const analytics::CohortDatabase database(cohort.string(), Access::read);
    if (auto row = database.attempt(uuid)) {
      facts.attempt = std::move(*row);
      facts.values = database.values(uuid);
      facts.intervals = database.intervals(uuid);
      facts.inCohort = true;
      return facts;
    }
  }
  const recorder::ChainVerdict chain = recording.verifyChain();
  if (!chain.intact())
    throw Error(ErrorKind::refused, Where{file.string()}, "its content does not agree with its chain: no figures");
  recorder::ReplayReport own;
  own.outcome = recording.outcome();
  own.complete = recording.complete();
  own.steps = recording.stepCount();
  analytics::AttemptRecord& record = facts.attempt;
  record = analytics::recordOf(recording.header(), own, file.string());
  record.verification = {};  // nothing was re-simulated
  if (own.steps > 0) facts.values = analytics::valuesFromObservables(recording);
  return facts;
}

std::optional<AttemptFacts> previousInCohort(const AttemptFacts& now, const std::filesystem::path& cohort) {
  if (now.attempt.participant.empty() || !isThere(cohort)) return std::nullopt;
  const analytics::CohortDatabase database(cohort.string(), Access::read);
  std::optional<analytics::AttemptRow> newest;
  for (analytics::AttemptRow& row : database.listAttempts()) {  // by start
    if (row.uuid == now.attempt.uuid || row.startUtc > now.attempt.startUtc) continue;
    if (row.participant != now.attempt.participant || row.comparabilityKey != now.attempt.comparabilityKey) continue;
    if (!row.parent.empty() || !row.complete || row.synthetic != now.attempt.synthetic) continue;
    newest = std::move(row);
  }
  if (!newest) return std::nullopt;
  AttemptFacts facts;
  facts.values = database.values(newest->uuid);
  facts.attempt = std::move(*newest);
  facts.inCohort = true;
  return facts;
}

std::vector<analytics::Norm> normsOf(const std::filesystem::path& cohort) {
  if (!isThere(cohort)) return {};
  return analytics::CohortDatabase(cohort.string(), Access::read).norms();
}

AttemptReport reportOf(AttemptFacts now, const std::optional<AttemptFacts>& previous,
                       const std::vector<analytics::Norm>& norms) {
  AttemptReport report;
  const std::vector<const analytics::Norm*> fitting = normsFor(now.attempt, norms);
  std::optional<AttemptStanding> standing;
  if (!fitting.empty()) standing = standingOf(now.attempt, now.values, *fitting.front(), now.intervals);
  const bool judged = standing && standing->judged;
  report.summary = summaryOf(now.attempt, now.values, judged && standing->grade ? &*standing->grade : nullptr);
  if (!standing)
    report.norm = "No norm for this task, device and mode.";
  else if (judged)
    report.norm =
        QString("Norm %1: %2").arg(QString::fromStdString(standing->norm), QString::fromStdString(standing->verdict));
  else
    report.norm = QString("Norm %1: judged when the attempt is verified and in the cohort.")
                      .arg(QString::fromStdString(standing->norm));
  report.previous = previous ? "Last time: " + startText(previous->attempt.startUtc) + ", " +
                                   outcomeText(previous->attempt.outcome) + '.'
                             : QString("No earlier attempt at this task to compare with.");
  const bool judges = now.attempt.outcome == recorder::Outcome::completed && previous &&
                      previous->attempt.outcome == recorder::Outcome::completed;
  for (const analytics::KeyFigure& figure : analytics::keyFigures(now.values, nullptr)) {
    const analytics::CheckpointValue& value = figure.value;
    FigureReport& line = report.figures.emplace_back();
    line.title = QString::fromStdString(figure.title);
    line.now = value.value ? valueText(value) : QString::fromStdString(value.reason);
    const FigureStanding* const stands = standing ? entryOf(standing->figures, value) : nullptr;
    if (stands != nullptr) line.norm = normWords(*stands, value);
    const analytics::CheckpointValue* const then = previous ? sameFigure(previous->values, value) : nullptr;
    if (then != nullptr) line.before = beforeWords(value, *then, judges);
  }
  report.facts = std::move(now);
  return report;
}

using parts::button;
using parts::say;
using parts::selectableLabel;

EndPage::EndPage(Setup setup)
    : setup_(std::move(setup)),
      title_(selectableLabel("endTitle")),
      syntheticMark_(selectableLabel("endSynthetic")),
      outcome_(selectableLabel("endOutcome")),
      verdict_(selectableLabel("endVerdict")),
      norm_(selectableLabel("endNorm")),
      previous_(selectableLabel("endPrevious")),
      figures_(selectableLabel("endFigures")),
      momentsTitle_(selectableLabel("momentsTitle")),
      storeText_(selectableLabel("storeText")),
      moments_(parts::named("moments", new QListWidget)),
      store_(button("&Put into the cohort", "store")),
      back_(button("Go &back to 2 s before it", "endBack")),
      again_(button("Sta&rt again", "again")),
      next_(button("&Next task", "next")),
      scenes_(button("&Other scene", "endScenes")),
      picture_(new ScenePictureWidget),
      strip_(new WorkStrip(work_)) {
  replay_ = std::make_unique<Replay>(
      [picture = picture_](std::shared_ptr<const SceneView> view) { picture->showView(std::move(view)); });
  replaySide_ = buildReplay();
  store_->setToolTip("Simulates the attempt again, which verifies it, and stores its figures");
  back_->setToolTip("Simulates the attempt again up to two seconds before the mistake, and goes on from there");
  QBoxLayout* const buttons = parts::bare(parts::row({store_, parts::spring(), back_, again_, next_, scenes_}));
  setLayout(parts::bare(parts::column({{parts::row({{replaySide_, 3}, {buildWords(), 2}}), 1}, strip_, buttons})));
  replaySide_->setVisible(setup_.mode == recorder::Mode::practice);

  connect(moments_, &QListWidget::itemClicked, this, &EndPage::replayMoment);
  connect(moments_, &QListWidget::itemActivated, this, &EndPage::replayMoment);
  connect(moments_, &QListWidget::currentRowChanged, this, [this](int at) { back_->setEnabled(at >= 0); });
  connect(replay_.get(), &Replay::failed, this, [this](const QString& reason) { picture_->showText(reason); });
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

EndPage::~EndPage() { replay_.reset(); }  // its threads use the picture

QWidget* EndPage::buildReplay() {
  moments_->setAccessibleName("Moments to see again");
  moments_->setWordWrap(true);
  moments_->setToolTip("A click replays the moment, from two seconds before it");
  return parts::boxed(parts::column({{picture_, 3}, new TransportBar(*replay_), momentsTitle_, {moments_, 1}}));
}

QWidget* EndPage::buildWords() {
  parts::enlarge(title_, 1.5);
  parts::embolden(verdict_);
  parts::embolden(syntheticMark_);
  syntheticMark_->setText("SYNTHETIC: made by a performer, no person's attempt");
  theme::setGround(*syntheticMark_, QColor(0xf0, 0xe4, 0x42), Qt::black);
  figures_->setAccessibleName("Figures that count");
  auto* const inside = new QWidget;
  inside->setLayout(parts::column(
      {title_, syntheticMark_, outcome_, verdict_, norm_, previous_, figures_, storeText_, parts::spring()}));
  return parts::scrolled(inside);
}

void EndPage::showAttempt(const TrainingStatus& status, const QString& result, double stepSeconds, bool next) {
  const bool practice = setup_.mode == recorder::Mode::practice;
  if (shown_ && shown_->attempt.parent.empty()) earlier_ = std::exchange(shown_, std::nullopt);
  shown_.reset();
  file_ = status.file;
  attempt_ = status.attempt;
  inCohort_ = false;
  synthetic_ = status.operatorKind != recorder::OperatorKind::human;
  title_->setText("The attempt has ended");
  syntheticMark_->setVisible(synthetic_);
  say(outcome_, result);
  for (QLabel* const label : {verdict_, previous_, figures_, storeText_}) say(label, {});
  say(norm_, practice ? QString("Reading the figures …")
                      : QString("An assessment shows neither figures nor mistakes here. Whoever instructs finds them "
                                "in the dashboard, when the attempt is in the cohort."));
  next_->setVisible(next);
  back_->setVisible(practice && !synthetic_ && !status.figures.errors->empty());
  showStoring();
  if (!practice) {
    again_->setFocus();
    return;
  }
  listErrors(*moments_, *status.figures.errors, stepSeconds);
  moments_->setCurrentRow(0);
  momentsTitle_->setText(moments_->count() > 0 ? "What went wrong: a click shows it again." : "Nothing went wrong.");
  picture_->showText("Opening the replay …");
  replay_->open(file_, attempt_);
  read();
  (moments_->count() > 0 ? static_cast<QWidget*>(moments_) : again_)->setFocus();
}

void EndPage::replayMoment() {
  if (const auto time = chosenBranch(*moments_)) replay_->playFrom(*time);
}

void EndPage::read() {
  if (setup_.mode != recorder::Mode::practice) return;
  reading_ = true;
  const auto job = [this, file = file_, cohort = setup_.cohort, earlier = earlier_] {
    AttemptFacts facts = readFacts(file, cohort);
    std::optional<AttemptFacts> before = previousInCohort(facts, cohort);
    const bool comparable = earlier && earlier->attempt.comparabilityKey == facts.attempt.comparabilityKey &&
                            earlier->attempt.synthetic == facts.attempt.synthetic;
    if (comparable && (!before || before->attempt.startUtc < earlier->attempt.startUtc)) before = earlier;
    return [this, report = reportOf(std::move(facts), before, normsOf(cohort))] { showReport(report); };
  };
  background_.run(job, [this](const QString& reason) {
    reading_ = false;
    say(norm_, "No figures: " + reason);
  });
}

void EndPage::showReport(const AttemptReport& report) {
  reading_ = false;
  shown_ = report.facts;
  inCohort_ = report.facts.inCohort;
  QStringList verdict;
  for (const std::string& sentence : report.summary.errors) verdict += QString::fromStdString(sentence);
  if (!report.summary.criticalView.empty()) verdict.prepend(QString::fromStdString(report.summary.criticalView));
  say(verdict_, verdict.join('\n'));
  say(norm_, report.norm);
  say(previous_, report.previous);
  QStringList figures;
  for (const FigureReport& figure : report.figures) figures += figureWords(figure);
  say(figures_, figures.join('\n'));
  showStoring();
}

void EndPage::showStoring() {
  store_->setVisible(!setup_.cohort.empty() && !synthetic_);
  store_->setEnabled(!work_.busy() && !inCohort_);
  store_->setText(inCohort_ ? "Is in the cohort" : "&Put into the cohort");
  if (storeText_->text().isEmpty() && setup_.cohort.empty() && !synthetic_)
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

void EndPage::leave() { replay_->close(); }

bool EndPage::settled() const {
  const bool practice = setup_.mode == recorder::Mode::practice;
  return !reading_ && !work_.busy() &&
         (!practice || !replay_->isOpen() || (replay_->position().settled && picture_->shown() > 0));
}

}  // namespace calot::gui
