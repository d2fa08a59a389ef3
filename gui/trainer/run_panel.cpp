// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/run_panel.h"

#include <algorithm>
#include <cmath>
#include <QAccessible>
#include <QApplication>
#include <QGridLayout>
#include <QLabel>
#include <QListWidget>
#include <QLocale>
#include <QProgressBar>
#include <QPushButton>
#include <QRegularExpression>
#include <QStackedWidget>
#include <QTextToSpeech>
#include <utility>

#include "gui/attempt/widget_parts.h"

namespace calot::gui {

using parts::button;
using parts::plainLabel;
using parts::say;

namespace {

// Okabe and Ito's blue on a ground of its own: the words carry the meaning.
constexpr const char* hintStyle =
    "QLabel { background: #e3eef6; color: #10263a; border-left: 5px solid #0072b2; padding: 8px; }";

constexpr const char* assistantKeys = "assistantKeys";

/// Remedy where nothing can be read aloud.
constexpr const char* remedy = "; install qt6-speech-speechd-plugin and speech-dispatcher, or qt6-speech-flite-plugin";

QWidget* keyPage(bool mouse, bool scope, bool pauses) {
  auto* const grid = new QGridLayout;
  grid->setVerticalSpacing(3);
  grid->setColumnStretch(1, 1);
  int row = 0;
  for (const KeyHelp& help : keyHelp(mouse, scope, pauses)) {
    auto* const keys = new QLabel(QString::fromStdString(help.keys));
    parts::embolden(keys);
    auto* const what = new QLabel(QString::fromStdString(help.what));
    what->setWordWrap(true);
    if (help.assistant) {
      keys->setObjectName(assistantKeys);
      what->setObjectName(assistantKeys);
    }
    grid->addWidget(keys, row, 0, Qt::AlignTop);
    grid->addWidget(what, row, 1, Qt::AlignTop);
    ++row;
  }
  grid->setRowStretch(row, 1);
  return parts::boxed(grid);
}

}  // namespace

void listErrors(QListWidget& list, const std::vector<analytics::ErrorLine>& errors, double stepSeconds) {
  list.clear();
  for (const analytics::ErrorLine& error : errors) {
    auto* const item = new QListWidgetItem(errorText(error), &list);
    item->setData(Qt::UserRole, branchTime(error.time, stepSeconds));
  }
  list.setVisible(!errors.empty());
}

std::optional<double> chosenBranch(const QListWidget& list) {
  const QListWidgetItem* const item = list.currentItem();
  return item == nullptr ? std::nullopt : std::optional(item->data(Qt::UserRole).toDouble());
}

RunPanel::RunPanel(bool mouse, bool scope)
    : mouse_(mouse),
      scope_(scope),
      stage_(plainLabel("stage", false)),
      modeLabel_(plainLabel("mode", false)),
      time_(plainLabel("time", false)),
      late_(plainLabel("late")),
      technical_(plainLabel("technical")),
      phase_(plainLabel("phase")),
      score_(plainLabel("score")),
      hint_(plainLabel("hint")),
      pointer_(plainLabel("pointer")),
      result_(parts::selectableLabel("result")),
      hand_{plainLabel("left"), plainLabel("right")},
      assistant_(plainLabel("assistant")),
      progress_(parts::named("progress", new QProgressBar)),
      lower_(new QStackedWidget),
      mistakesTitle_(plainLabel("mistakesTitle")),
      list_(parts::named("mistakes", new QListWidget)),
      back_(button("Go &back to 2 s before it", "back")),
      mistakes_(parts::boxed(parts::column({mistakesTitle_, {list_, 1}, back_}))),
      pause_(button("&Pause", "pause")),
      finish_(button("&End the attempt", "finish")),
      restart_(button("Sta&rt again", "restart")),
      scenes_(button("&Other scene", "otherScene")) {
  setMinimumWidth(theme::inType(270));
  setMaximumWidth(theme::inType(320));
  parts::embolden(stage_);
  parts::embolden(phase_);
  parts::enlarge(time_, 2.0);
  hint_->setStyleSheet(hintStyle);
  technical_->hide();
  QPalette trouble = QApplication::palette();
  trouble.setColor(QPalette::WindowText, theme::trouble());
  late_->setPalette(trouble);
  progress_->setRange(0, 100);
  list_->setAccessibleName("Mistakes");
  list_->setWordWrap(true);
  back_->setToolTip("Simulates the attempt again up to two seconds before the mistake, and goes on from there");

  mistakesTitle_->setAlignment(Qt::AlignTop | Qt::AlignLeft);  // also where there is no list below it
  lower_->addWidget(mistakes_);
  setMode(mode_);
  auto* const buttons = new QGridLayout;
  buttons->addWidget(pause_, 0, 0);
  buttons->addWidget(finish_, 0, 1);
  buttons->addWidget(restart_, 1, 0);
  buttons->addWidget(scenes_, 1, 1);
  QBoxLayout* const rows = parts::column({parts::row({{stage_, 1}, modeLabel_}), progress_, time_, late_, technical_});
  parts::fill(rows, {parts::space(6), phase_, score_, hint_, pointer_, result_});
  parts::fill(rows, {parts::space(6), hand_[0], hand_[1], assistant_, parts::space(10), {lower_, 1}, buttons});
  setLayout(rows);

  connect(pause_, &QPushButton::clicked, this, &RunPanel::pauseRequested);
  connect(finish_, &QPushButton::clicked, this, &RunPanel::finishRequested);
  connect(restart_, &QPushButton::clicked, this, &RunPanel::restartRequested);
  connect(scenes_, &QPushButton::clicked, this, &RunPanel::scenesRequested);
  connect(back_, &QPushButton::clicked, this, &RunPanel::goBack);
  connect(list_, &QListWidget::itemActivated, this, &RunPanel::goBack);
  connect(list_, &QListWidget::currentRowChanged, this, [this](int row) { back_->setEnabled(row >= 0); });
}

void RunPanel::show(const TrainingStatus& status, const PanelText& text, double stepSeconds) {
  announce(stage_, text.stage);
  say(modeLabel_, text.mode);
  say(time_, text.time);
  say(late_, text.late);
  technical_->setText(text.technical);
  say(phase_, text.phase);
  say(score_, text.score);
  announce(hint_, text.hint);
  announce(pointer_, text.pointer);
  say(result_, text.result);
  for (std::size_t h = 0; h < handCount; ++h) say(hand_[h], text.hand[h]);
  say(assistant_, text.assistant);
  for (QLabel* const keys : keys_->findChildren<QLabel*>(assistantKeys)) keys->setVisible(!text.assistant.isEmpty());
  progress_->setVisible(status.stage == Stage::takingParent);
  progress_->setValue(static_cast<int>(std::floor(100.0 * status.progress)));

  const bool runs = status.stage == Stage::running || status.stage == Stage::paused;
  const bool practice = mode_ == recorder::Mode::practice;
  pause_->setText(status.stage == Stage::paused ? "&Go on" : "&Pause");
  pause_->setVisible(practice);
  pause_->setEnabled(runs);
  finish_->setEnabled(runs);
  // Mistakes are a score: an assessment shows none.
  const bool looksBack = practice && (status.stage == Stage::paused || status.stage == Stage::ended);
  lower_->setCurrentWidget(looksBack ? mistakes_ : keys_);
  if (looksBack) showErrors(status, stepSeconds);
}

/// Its keys are those of the mode.
void RunPanel::setMode(recorder::Mode mode) {
  mode_ = mode;
  delete keys_;
  keys_ = parts::scrolled(keyPage(mouse_, scope_, mode == recorder::Mode::practice));
  lower_->addWidget(keys_);
}

void RunPanel::setTechnical(bool shown) { technical_->setVisible(shown); }

void RunPanel::showHintIn(QLayout* place) {
  auto* const own = static_cast<QBoxLayout*>(layout());
  if (place == nullptr)
    own->insertWidget(own->indexOf(pointer_), hint_);
  else
    place->addWidget(hint_);
}

/// Numbers alone that go on are not worth being read aloud.
void RunPanel::announce(QLabel* label, const QString& text) {
  static const QRegularExpression numbers("[0-9]+");
  const bool news = !text.isEmpty() && QString(text).remove(numbers) != label->text().remove(numbers);
  say(label, text);
  if (!news) return;
  QAccessibleEvent alert(label, QAccessible::Alert);
  QAccessible::updateAccessibility(&alert);
  emit announced(label->objectName(), text);
}

void RunPanel::showErrors(const TrainingStatus& status, double stepSeconds) {
  const bool none = status.figures.errors->empty();
  mistakesTitle_->setText(!none                           ? "What went wrong:"
                          : status.stage == Stage::paused ? "Nothing went wrong so far."
                                                          : "Nothing went wrong.");
  if (listed_ == status.figures.errors) return;
  listed_ = status.figures.errors;
  listErrors(*list_, *listed_, stepSeconds);
  back_->setVisible(!none);
  // The newest one is the one to be undone, mostly.
  const auto newest =
      std::max_element(listed_->begin(), listed_->end(), [](const auto& a, const auto& b) { return a.time < b.time; });
  list_->setCurrentRow(static_cast<int>(newest - listed_->begin()));
}

void RunPanel::goBack() {
  if (const auto time = chosenBranch(*list_)) emit backRequested(*time);
}

Voice::Voice(QObject* parent) : QObject(parent) {
  if (QTextToSpeech::availableEngines().isEmpty()) return;
  speech_ = new QTextToSpeech(this);
  // The words are English whatever the system speaks.
  const QList<QLocale> locales = speech_->availableLocales();
  const auto english = std::find_if(locales.begin(), locales.end(),
                                    [](const QLocale& locale) { return locale.language() == QLocale::English; });
  if (english != locales.end() && speech_->locale().language() != QLocale::English) speech_->setLocale(*english);
  connect(speech_, &QTextToSpeech::stateChanged, this, [this](QTextToSpeech::State state) {
    if (state == QTextToSpeech::Ready) sayNext();
  });
  connect(speech_, &QTextToSpeech::errorOccurred, this, [this] {
    waiting_.clear();
    present_.clear();
    emit failed(fault());
  });
}

QString Voice::fault() const {
  if (speech_ == nullptr) return QString("no speech synthesis is installed") + remedy;
  if (speech_->state() != QTextToSpeech::Error) return {};
  const QString why = speech_->errorString().simplified();
  return "speech synthesis \"" + speech_->engine() + "\" does not work" + (why.isEmpty() ? "" : ": " + why) + remedy;
}

void Voice::say(const QString& subject, const QString& words) {
  if (!fault().isEmpty()) return;
  const auto same =
      std::find_if(waiting_.begin(), waiting_.end(), [&](const News& news) { return news.subject == subject; });
  if (same != waiting_.end()) {
    same->words = words;
    return;
  }
  if (present_ == subject) {
    // A replaced sentence is not finished, and its replacement goes first.
    waiting_.push_front({subject, words});
    speech_->stop();
    // An engine that was silent already has no change of state to tell.
    if (present_ == subject && speech_->state() == QTextToSpeech::Ready) sayNext();
    return;
  }
  waiting_.push_back({subject, words});
  if (present_.isEmpty()) sayNext();
}

void Voice::stop() {
  waiting_.clear();
  if (speech_ != nullptr) speech_->stop();
  present_.clear();
}

void Voice::sayNext() {
  present_.clear();
  if (waiting_.empty()) return;
  const News news = std::move(waiting_.front());
  waiting_.pop_front();
  present_ = news.subject;
  speech_->say(news.words);
}

}  // namespace calot::gui
