// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/ratings_page.h"

#include <QButtonGroup>
#include <QCryptographicHash>
#include <QGroupBox>
#include <QRadioButton>
#include <QScrollArea>
#include <QSettings>

#include "gui/dashboard/dialogs.h"
#include "recorder/base/errors.h"
#include "recorder/base/files.h"

namespace calot::gui {

/// Identity of a rating, and of its draft: attempt and rater of a form about attempts, the participant of the others.
struct RatingPage::Subject {
  std::string database, form;
  std::uint32_t formVersion = 1;
  std::string attempt, rater, participant;
};

namespace {

namespace fs = std::filesystem;
using Answers = std::map<std::string, std::optional<int>>;  // by item

/// Drafts that are not stored yet are kept among the user's settings: a rater who is called away goes on where they
/// were.
QSettings drafts() { return {QSettings::IniFormat, QSettings::UserScope, "calot", "drafts"}; }

/// A group of the settings: no name stands there.
QString groupOf(const auto& subject) {
  QCryptographicHash hash(QCryptographicHash::Sha256);
  for (const std::string& part : {subject.database, subject.form, std::to_string(subject.formVersion), subject.attempt,
                                  subject.rater, subject.participant}) {
    hash.addData(QByteArray::fromStdString(part));
    hash.addData(QByteArray(1, '\0'));
  }
  return QString::fromLatin1(hash.result().toHex());
}

std::string textOf(std::optional<int> score) { return score ? std::to_string(*score) : "-"; }

void keepDraft(const QString& group, const Answers& answers) {
  QSettings store = drafts();
  store.beginGroup(group);
  store.remove("");
  for (const auto& [item, score] : answers)
    store.setValue(QString::fromStdString(item), QString::fromStdString(textOf(score)));
}

/// Empty: there is none.
Answers keptDraft(const QString& group) {
  QSettings store = drafts();
  store.beginGroup(group);
  Answers answers;
  for (const QString& item : store.childKeys()) {
    const QString text = store.value(item).toString();
    bool number = false;
    const int score = text.toInt(&number);
    if (number || text == "-") answers[item.toStdString()] = number ? std::optional(score) : std::nullopt;
  }
  return answers;
}

/// Stores a rating as `calot rate` does. @throws Error (invalid) for an item without answer, all blank, or a missing
/// name; (refused) as CohortDatabase::storeRating
void storeRating(const analytics::RatingForm& form, const auto& subject, const Answers& answers, bool replace) {
  if (form.ofAttempts && subject.attempt.empty()) throw Error(ErrorKind::invalid, "Choose the attempt that is rated.");
  if (form.ofAttempts && subject.rater.empty()) throw Error(ErrorKind::invalid, "Say who rates, by a pseudonym.");
  if (!form.ofAttempts && subject.participant.empty())
    throw Error(ErrorKind::invalid, "Choose the participant who fills in the form.");
  std::vector<std::pair<std::string, std::string>> given;
  for (const auto& [item, score] : answers) given.emplace_back(item, textOf(score));
  analytics::Rating rating;
  rating.attempt = subject.attempt;
  rating.rater = subject.rater;
  rating.participant = subject.participant;
  rating.answers = analytics::answersOf(form, given);
  analytics::CohortDatabase(subject.database, analytics::CohortDatabase::Access::write)
      .storeRating({form.name, form.version, form.sha256, form.text}, rating, replace);
}

/// Earlier answers of this rater or participant, which are to be changed.
std::optional<analytics::Rating> earlierRating(const std::vector<analytics::Rating>& ratings,
                                               const analytics::RatingForm& form, const auto& subject) {
  for (const analytics::Rating& r : ratings) {
    if (r.form != form.name || r.formVersion != form.version || r.attempt != subject.attempt) continue;
    if (form.ofAttempts ? r.rater == subject.rater : r.participant == subject.participant) return r;
  }
  return std::nullopt;
}

constexpr int blank = -1000;  // button of an item that is left blank: no form's score

QString scoreText(const analytics::RatingForm& form, int score) {
  const auto at = static_cast<std::size_t>(score - form.least);
  QString text = QString::number(score);
  if (at < form.words.size()) text += QString::fromUtf8(" – ") + QString::fromStdString(form.words[at]);
  return text;
}

}  // namespace

RatingPage::RatingPage()
    : choice_(parts::choice("form", 12)),
      source_(parts::plainLabel("form-source")),
      banner_(new AttemptBanner),
      raterLabel_(new QLabel("Rated b&y")),
      rater_(parts::named("rater", new QLineEdit)),
      participantLabel_(new QLabel("Part&icipant")),
      participant_(parts::named("rating-participant", new QComboBox)),
      area_(parts::named("form-area", new QScrollArea)),
      state_(parts::plainLabel("rating-state")),
      store_(parts::named("store-rating", new QPushButton("&Store"))),
      next_(parts::named("store-next", new QPushButton("Store, &next"))),
      reveal_(parts::named("reveal", new QCheckBox("Sho&w who it was"))),
      replay_(new RecordingView({.timeline = false})) {
  raterLabel_->setBuddy(rater_);
  participantLabel_->setBuddy(participant_);
  rater_->setMaxLength(64);
  rater_->setPlaceholderText("pseudonym");
  reveal_->setToolTip("Who rates blinded judges what was done, not who did it");
  area_->setWidgetResizable(true);
  next_->setToolTip("Store it and go to the next attempt (Ctrl+Return)");
  QBoxLayout* const head =
      parts::row({{"Fo&rm", choice_, 2}, raterLabel_, {rater_, 1}, participantLabel_, {participant_, 1}});
  QWidget* const form = parts::boxed(
      parts::column({head, reveal_, banner_, source_, {area_, 1}, parts::row({{state_, 1}, store_, next_})}));
  setLayout(parts::column({{makeSplitter(Qt::Horizontal, {{replay_, 1}, {form, 1}}), 1}}));
  connectParts();
  begin_ = choice_;
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
  onKey(*this, Qt::CTRL | Qt::Key_Return, storeAndGo);
  onKey(*this, Qt::Key_Comma, [this] { replay_->replay().stepBy(-1); });
  onKey(*this, Qt::Key_Period, [this] { replay_->replay().stepBy(1); });
}

void RatingPage::readForms(const std::vector<fs::path>& folders) {
  QStringList titles;
  for (const auto& entry : recorder::filesIn(folders, "forms")) {
    const QString fault = faultOf([&] {
      const analytics::RatingForm& form = forms_.emplace_back(analytics::readRatingForm(entry.second));
      titles += QString::fromStdString(form.name + ": " + form.title);
    });
    if (fault_.isEmpty()) fault_ = fault;
  }
  refill(*choice_, titles);
  showForm();
}

void RatingPage::openReplay() {
  if (!document_ || !attempt_ || !isVisible() || shown_ == attempt_->uuid) return;
  shown_ = attempt_->uuid;
  replay_->open(*attempt_, *document_);
}

RatingPage::Subject RatingPage::subject() const {
  const analytics::RatingForm& shown = *form();
  return {document_ ? document_->path() : std::string(),
          shown.name,
          shown.version,
          shown.ofAttempts && attempt_ ? attempt_->uuid : std::string(),
          shown.ofAttempts ? rater_->text().toStdString() : std::string(),
          shown.ofAttempts ? std::string() : participant_->currentText().toStdString()};
}

void RatingPage::read() {
  if (rater_->text().isEmpty()) rater_->setText(settings::person());
  QStringList people;
  tryTo([&] {
    for (const analytics::Participant& person : document_->database().participants())
      people += QString::fromStdString(person.pseudonym);
  });
  refill(*participant_, people);
  showEarlier();
  openReplay();
}

void RatingPage::setAttempt(const analytics::AttemptRow& attempt) {
  const bool another = !attempt_ || attempt_->uuid != attempt.uuid;
  attempt_ = attempt;
  showSubject();
  if (another) outdate();
}

void RatingPage::chooseForm(const QString& name) {
  if (const int at = choice_->findText(name + ':', Qt::MatchStartsWith); at >= 0) choice_->setCurrentIndex(at);
}

const analytics::RatingForm* RatingPage::form() const {
  const int at = choice_->currentIndex();
  return at < 0 ? nullptr : &forms_[static_cast<std::size_t>(at)];
}

void RatingPage::showSubject() {
  const bool ofAttempts = form() == nullptr || form()->ofAttempts;
  for (QWidget* widget : std::initializer_list<QWidget*>{rater_, raterLabel_, reveal_, replay_})
    widget->setVisible(ofAttempts);
  banner_->setVisible(ofAttempts && (reveal_->isChecked() || !attempt_));
  for (QWidget* widget : std::initializer_list<QWidget*>{participant_, participantLabel_})
    widget->setVisible(!ofAttempts);
  if (!attempt_)
    banner_->showText("Select the attempt that is rated on the page Attempts.");
  else
    banner_->showAttempt(*attempt_);
}

void RatingPage::showForm() {
  groups_.clear();
  auto* content = new QWidget;
  auto* layout = new QVBoxLayout(content);
  const analytics::RatingForm* shown = form();
  if (shown == nullptr) {
    source_->setText(fault_.isEmpty() ? "No forms were found (CALOT_ASSETS)." : fault_);
  } else {
    source_->setText(QString("Version %1. %2").arg(shown->version).arg(QString::fromStdString(shown->source)));
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
  auto* text = parts::plainLabel("");
  text->setText(QString::fromStdString(item.text));
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
    auto* words = parts::plainLabel((item.key + "-anchors").c_str());
    words->setText(anchors.join('\n'));
    layout.addWidget(words);
  }
  layout.addSpacing(6);
  groups_.emplace_back(item.key, buttons);
  connect(buttons, &QButtonGroup::idClicked, this, [this, key = item.key](int id) {
    answers_[key] = id == blank ? std::nullopt : std::optional(id);
    keepDraft(groupOf(subject()), answers_);
    showState();
  });
}

void RatingPage::showEarlier() {
  replaces_ = false;
  answers_.clear();
  const analytics::RatingForm* const shown = form();
  if (shown == nullptr) {
    showState();
    return;
  }
  std::optional<analytics::Rating> earlier;
  if (document_) tryTo([&] { earlier = earlierRating(document_->assessment().ratings(), *shown, subject()); });
  replaces_ = earlier.has_value();
  // Answers that were begun and not stored are newer than the stored ones.
  Answers answers = keptDraft(groupOf(subject()));
  if (answers.empty() && earlier) {
    for (const analytics::FormItem& item : shown->items()) {
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
    answers_[key] = at->second;
  }
  showState();
}

void RatingPage::showState() {
  const std::size_t items = form() == nullptr ? 0 : form()->items().size();
  store_->setEnabled(items > 0 && document_ && answers_.size() == items);
  next_->setEnabled(store_->isEnabled());
  store_->setText(replaces_ ? "Replace what was &stored" : "&Store");
  QString text;
  if (items > 0) text = QString("%1 of %2 items are answered.").arg(answers_.size()).arg(items);
  if (replaces_) text += " This form was filled in before; storing replaces it.";
  state_->setText(text);
}

bool RatingPage::store() {
  return tryTo([this] {
    storeRating(*form(), subject(), answers_, replaces_);
    drafts().remove(groupOf(subject()));
    replaces_ = true;
    showState();
    state_->setText("Stored. " + state_->text());
  });
}

}  // namespace calot::gui
