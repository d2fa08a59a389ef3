// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/ratings_page.h"

#include <algorithm>
#include <QBoxLayout>
#include <QButtonGroup>
#include <QCheckBox>
#include <QComboBox>
#include <QGroupBox>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QRadioButton>
#include <QScrollArea>
#include <QShortcut>
#include <QSignalBlocker>
#include <QSplitter>

#include "gui/attempt/attempt_recording.h"
#include "gui/attempt/replay_transport.h"
#include "gui/attempt/widget_parts.h"
#include "gui/dashboard/page_parts.h"
#include "gui/dashboard/settings.h"
#include "gui/view/scene_picture_widget.h"
#include "gui/words/problem_words.h"
#include "recorder/base/errors.h"

namespace calot::gui {
namespace {

constexpr int blank = -1000;  // button of an item that is left blank: no form's score

QString scoreText(const analytics::RatingForm& form, int score) {
  const auto at = static_cast<std::size_t>(score - form.least);
  QString text = QString::number(score);
  if (at < form.words.size()) text += QString::fromUtf8(" – ") + QString::fromStdString(form.words[at]);
  return text;
}

}  // namespace

RatingPage::RatingPage(QWidget* parent) : QWidget(parent) {
  replayPart_ = buildReplay();
  auto* parts = new QSplitter(Qt::Horizontal);
  parts->addWidget(replayPart_);
  parts->addWidget(buildForm());
  parts->setStretchFactor(0, 1);
  parts->setStretchFactor(1, 1);
  parts->setChildrenCollapsible(false);
  auto* layout = new QVBoxLayout(this);
  layout->addWidget(parts, 1);
  connectParts();
  setProperty(beginProperty, QVariant::fromValue<QObject*>(choice_));
}

RatingPage::~RatingPage() { replay_.reset(); }  // its thread uses the picture

QWidget* RatingPage::buildReplay() {
  picture_ = new ScenePictureWidget;
  replay_ = std::make_unique<Replay>(
      [picture = picture_](std::shared_ptr<const SceneView> view) { picture->showView(std::move(view)); });
  auto* made = new QWidget;
  auto* layout = parts::bare<QVBoxLayout>(made);
  layout->addWidget(picture_, 1);
  layout->addWidget(new TransportBar(*replay_));
  connect(replay_.get(), &Replay::opened, this, [this] { opening_ = false; });
  connect(replay_.get(), &Replay::failed, this, [this](const QString& reason) {
    opening_ = false;
    picture_->showText(reason);
  });
  return made;
}

QWidget* RatingPage::buildForm() {
  auto* made = new QWidget;
  auto* layout = parts::bare<QVBoxLayout>(made);
  auto* row = new QHBoxLayout;
  const auto add = [&](QLabel* label, QWidget* field, int stretch) {
    label->setBuddy(field);
    row->addWidget(label);
    row->addWidget(field, stretch);
  };
  choice_ = parts::choice("form", 12);
  add(new QLabel("Fo&rm"), choice_, 2);
  rater_ = parts::named("rater", new QLineEdit);
  rater_->setMaxLength(64);
  rater_->setPlaceholderText("pseudonym");
  raterLabel_ = new QLabel("Rated b&y");
  add(raterLabel_, rater_, 1);
  participant_ = parts::named("rating-participant", new QComboBox);
  participantLabel_ = new QLabel("Part&icipant");
  add(participantLabel_, participant_, 1);
  layout->addLayout(row);
  reveal_ = parts::named("reveal", new QCheckBox("Sho&w who it was"));
  reveal_->setToolTip("Who rates blinded judges what was done, not who did it");
  layout->addWidget(reveal_);
  banner_ = new AttemptBanner;
  layout->addWidget(banner_);
  source_ = new QLabel;
  source_->setTextFormat(Qt::PlainText);
  source_->setWordWrap(true);
  layout->addWidget(source_);
  area_ = parts::named("form-area", new QScrollArea);
  area_->setWidgetResizable(true);
  layout->addWidget(area_, 1);
  auto* lower = new QHBoxLayout;
  state_ = parts::plainLabel("rating-state");
  store_ = parts::named("store-rating", new QPushButton("&Store"));
  next_ = parts::named("store-next", new QPushButton("Store, &next"));
  next_->setToolTip("Store it and go to the next attempt (Ctrl+Return)");
  lower->addWidget(state_, 1);
  lower->addWidget(store_);
  lower->addWidget(next_);
  layout->addLayout(lower);
  return made;
}

void RatingPage::connectParts() {
  connect(choice_, &QComboBox::currentIndexChanged, this, [this] { showForm(); });
  connect(participant_, &QComboBox::currentIndexChanged, this, [this] { showEarlier(); });
  connect(rater_, &QLineEdit::editingFinished, this, [this] {
    settings::setPerson(rater_->text());
    showEarlier();
  });
  connect(store_, &QPushButton::clicked, this, [this] { store(); });
  const auto storeAndGo = [this] {
    if (store_->isEnabled() && store()) emit nextWanted();
  };
  connect(next_, &QPushButton::clicked, this, storeAndGo);
  connect(reveal_, &QCheckBox::toggled, this, [this] { showSubject(); });
  const auto key = [this](const QKeySequence& keys, auto action) {
    connect(new QShortcut(keys, this, nullptr, nullptr, Qt::WidgetWithChildrenShortcut), &QShortcut::activated, this,
            action);
  };
  key(Qt::CTRL | Qt::Key_Return, storeAndGo);
  key(Qt::Key_Comma, [this] { replay_->stepBy(-1); });
  key(Qt::Key_Period, [this] { replay_->stepBy(1); });
}

void RatingPage::setForms(KnownForms forms) {
  draft_.reset();  // it names a form of the former list
  forms_ = std::move(forms);
  {
    const QSignalBlocker quiet(choice_);
    choice_->clear();
    for (const analytics::RatingForm& form : forms_.forms)
      choice_->addItem(QString::fromStdString(form.name + ": " + form.title));
  }
  showForm();
}

void RatingPage::setDocument(std::shared_ptr<const CohortDocument> document) {
  document_ = std::move(document);
  read_ = false;
  if (isVisible()) readPeople();
}

void RatingPage::showEvent(QShowEvent* event) {
  QWidget::showEvent(event);
  if (!read_ && document_) readPeople();
  openReplay();
}

void RatingPage::hideEvent(QHideEvent* event) {
  QWidget::hideEvent(event);
  replay_->pause();
}

quint64 RatingPage::replayShown() const { return picture_->shown(); }
bool RatingPage::settled() const {
  return !opening_ && (!replay_->isOpen() || (replay_->position().settled && !picture_->picture().isNull()));
}

void RatingPage::openReplay() {
  if (!document_ || !attempt_ || !isVisible() || shown_ == attempt_->uuid) return;
  shown_ = attempt_->uuid;
  replay_->close();
  const std::filesystem::path file = findRecording(*attempt_, document_->path(), settings::recordingPlaces());
  if (file.empty()) {
    picture_->showText("The recording was not found. Open the attempt on its own page to say where it is.");
    return;
  }
  picture_->showText("Opening the recording …");
  opening_ = true;
  replay_->open(file, attempt_->uuid);
}

DraftSubject RatingPage::draftSubject() const {
  const analytics::RatingForm& shown = *form();
  return {document_ ? document_->path() : std::string(),
          shown.name,
          shown.version,
          shown.ofAttempts && attempt_ ? attempt_->uuid : std::string(),
          shown.ofAttempts ? rater_->text().toStdString() : std::string(),
          shown.ofAttempts ? std::string() : participant_->currentText().toStdString()};
}

void RatingPage::readPeople() {
  read_ = true;
  if (rater_->text().isEmpty()) rater_->setText(settings::person());
  {
    const QSignalBlocker quiet(participant_);
    const QString before = participant_->currentText();
    participant_->clear();
    try {
      for (const std::string& name : document_->participants()) participant_->addItem(QString::fromStdString(name));
    } catch (const Error& error) {
      emit problem(QString::fromStdString(problemText(error)));
    }
    participant_->setCurrentIndex(std::max(0, participant_->findText(before)));
  }
  showEarlier();
}

void RatingPage::setAttempt(const analytics::AttemptRow& attempt) {
  const bool another = !attempt_ || attempt_->uuid != attempt.uuid;
  attempt_ = attempt;
  showSubject();
  if (another && isVisible()) showEarlier();
  openReplay();
  if (another) read_ = read_ && isVisible();
}

void RatingPage::chooseForm(const QString& name) {
  if (const int at = choice_->findText(name + ':', Qt::MatchStartsWith); at >= 0) choice_->setCurrentIndex(at);
}

const analytics::RatingForm* RatingPage::form() const {
  const int at = choice_->currentIndex();
  return at < 0 ? nullptr : &forms_.forms[static_cast<std::size_t>(at)];
}

void RatingPage::showSubject() {
  const bool ofAttempts = form() == nullptr || form()->ofAttempts;
  for (QWidget* widget :
       {static_cast<QWidget*>(rater_), static_cast<QWidget*>(raterLabel_), static_cast<QWidget*>(reveal_), replayPart_})
    widget->setVisible(ofAttempts);
  banner_->setVisible(ofAttempts && (reveal_->isChecked() || !attempt_));
  for (QWidget* widget : {static_cast<QWidget*>(participant_), static_cast<QWidget*>(participantLabel_)})
    widget->setVisible(!ofAttempts);
  if (!attempt_)
    banner_->showText("Select the attempt that is rated on the page Attempts.");
  else
    banner_->showAttempt(*attempt_);
}

void RatingPage::showForm() {
  groups_.clear();
  draft_.reset();
  auto* content = new QWidget;
  auto* layout = new QVBoxLayout(content);
  const analytics::RatingForm* shown = form();
  if (shown == nullptr) {
    source_->setText(forms_.faults.empty() ? QString("No forms were found (CALOT_ASSETS).")
                                           : QString::fromStdString(forms_.faults.front()));
  } else {
    source_->setText(QString("Version %1. %2").arg(shown->version).arg(QString::fromStdString(shown->source)));
    draft_.emplace(*shown);
    for (const analytics::FormSection& section : shown->sections) {
      auto* box = new QGroupBox(QString::fromStdString(section.name));
      auto* boxLayout = new QVBoxLayout(box);
      for (const analytics::FormItem& item : section.items) addItem(*boxLayout, item);
      layout->addWidget(box);
    }
  }
  layout->addStretch(1);
  area_->setWidget(content);  // deletes the former one
  showSubject();
  showEarlier();
}

void RatingPage::addItem(QVBoxLayout& layout, const analytics::FormItem& item) {
  auto* text = new QLabel(QString::fromStdString(item.text));
  text->setTextFormat(Qt::PlainText);
  text->setWordWrap(true);
  parts::embolden(text);
  layout.addWidget(text);
  auto* buttons = new QButtonGroup(text);
  auto* row = new QHBoxLayout;
  const analytics::RatingForm& shown = *form();
  const auto add = [&](int id, const QString& label, const QString& tip) {
    auto* button = new QRadioButton(label);
    button->setObjectName(QString::fromStdString(item.key) + '=' + (id == blank ? "-" : QString::number(id)));
    button->setAccessibleName(QString::fromStdString(item.text) + ": " + label);
    button->setToolTip(tip);
    buttons->addButton(button, id);
    row->addWidget(button);
  };
  for (int score = shown.least; score <= shown.most; ++score) {
    const auto anchor = static_cast<std::size_t>(score - shown.least);
    add(score, scoreText(shown, score),
        anchor < item.anchors.size() ? QString::fromStdString(item.anchors[anchor]) : QString());
  }
  add(blank, "left blank", "Nothing can be said");
  row->addStretch(1);
  layout.addLayout(row);
  QStringList anchors;
  for (std::size_t i = 0; i < item.anchors.size(); ++i) {
    if (!item.anchors[i].empty())
      anchors += QString("%1: %2").arg(shown.least + static_cast<int>(i)).arg(QString::fromStdString(item.anchors[i]));
  }
  if (!anchors.isEmpty()) {
    auto* words = new QLabel(anchors.join('\n'));
    words->setObjectName(QString::fromStdString(item.key) + "-anchors");
    words->setTextFormat(Qt::PlainText);
    words->setWordWrap(true);
    layout.addWidget(words);
  }
  layout.addSpacing(6);
  groups_.emplace_back(item.key, buttons);
  connect(buttons, &QButtonGroup::idClicked, this, [this, key = item.key](int id) {
    draft_->answer(key, id == blank ? std::nullopt : std::optional(id));
    keepDraft(draftSubject(), draft_->answers());
    showState();
  });
}

void RatingPage::showEarlier() {
  replaces_ = false;
  if (!draft_) {
    showState();
    return;
  }
  const analytics::RatingForm& shown = *form();
  std::optional<analytics::Rating> earlier;
  if (document_) {
    try {
      earlier = earlierRating(document_->ratings(), shown, attempt_ ? attempt_->uuid : std::string(),
                              rater_->text().toStdString(), participant_->currentText().toStdString());
    } catch (const Error& error) {
      emit problem(QString::fromStdString(problemText(error)));
    }
  }
  replaces_ = earlier.has_value();
  draft_.emplace(shown);
  // What was begun and not stored is newer than what was stored.
  DraftAnswers answers = keptDraft(draftSubject());
  if (answers.empty() && earlier) {
    for (const analytics::FormItem& item : shown.items()) {
      const auto at = earlier->answers.find(item.key);
      answers[item.key] = at == earlier->answers.end() ? std::nullopt : std::optional(at->second);
    }
  }
  for (const auto& [key, buttons] : groups_) {
    // A group without a choice: exclusive ones keep theirs.
    buttons->setExclusive(false);
    for (QAbstractButton* button : buttons->buttons()) button->setChecked(false);
    buttons->setExclusive(true);
    const auto at = answers.find(key);
    if (at == answers.end()) continue;
    QAbstractButton* button = buttons->button(at->second.value_or(blank));
    if (button == nullptr) continue;  // a score of another scale
    button->setChecked(true);
    draft_->answer(key, at->second);
  }
  showState();
}

void RatingPage::showState() {
  store_->setEnabled(draft_ && document_ && draft_->complete());
  next_->setEnabled(store_->isEnabled());
  store_->setText(replaces_ ? "Replace what was &stored" : "&Store");
  if (!draft_) {
    state_->clear();
    return;
  }
  QString text = QString("%1 of %2 items are answered.").arg(draft_->answered()).arg(draft_->form().items().size());
  if (replaces_) text += " This form was filled in before; storing replaces it.";
  state_->setText(text);
}

bool RatingPage::store() {
  try {
    draft_->store(document_->path(), attempt_ ? attempt_->uuid : std::string(), rater_->text().toStdString(),
                  participant_->currentText().toStdString(), replaces_);
    dropDraft(draftSubject());
    replaces_ = true;
    showState();
    state_->setText("Stored. " + state_->text());
    return true;
  } catch (const Error& error) {
    emit problem(QString::fromStdString(problemText(error)));
    return false;
  }
}

}  // namespace calot::gui
