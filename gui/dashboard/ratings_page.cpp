// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/ratings_page.h"

#include <algorithm>
#include <cmath>
#include <QListView>
#include <QPointer>

#include "gui/dashboard/rating_form_view.h"
#include "recorder/base/files.h"

namespace calot::gui {
namespace {

bool isOf(const analytics::Rating& rating, const RatingSubject& subject) {
  return rating.form == subject.form && rating.formVersion == subject.formVersion &&
         rating.attempt == subject.attempt && rating.rater == subject.rater &&
         rating.participant == subject.participant;
}

int percent(double share) { return static_cast<int>(std::floor(100.0 * share + 1e-9)); }

}  // namespace

RatingPage::RatingPage()
    : name_(drafts::rater()),
      choice_(parts::choice("form", 10)),
      raterLabel_(new QLabel("Rated b&y")),
      rater_(parts::named("rater", new QLineEdit(name_))),
      participantLabel_(new QLabel("Part&icipant")),
      participant_(parts::choice("rating-participant", 8)),
      whichLabel_(new QLabel("Fi&lms")),
      which_(parts::choice("rating-films", 8)),
      reveal_(parts::named("reveal", new QCheckBox("Sho&w who it was"))),
      progress_(parts::plainLabel("rating-progress")),
      list_(parts::named("rating-queue", new QListView)),
      banner_(new AttemptBanner),
      film_(new RecordingView({.timeline = false})),
      source_(parts::plainLabel("form-source")),
      view_(new RatingFormView),
      state_(parts::plainLabel("rating-state")),
      store_(parts::named("store-rating", new QPushButton("&Store"))),
      next_(parts::named("store-next", new QPushButton("Store, &next"))) {
  next_->setToolTip("Store it and go to the next film (Enter in the form, Ctrl+Return everywhere)");
  list_->setModel(&films_);
  list_->setUniformItemSizes(true);
  list_->setEditTriggers(QAbstractItemView::NoEditTriggers);
  list_->setAccessibleName("Films to rate");
  list_->setMinimumWidth(theme::inType(90));
  banner_->makeNarrow();
  left_ = parts::boxed(parts::column({progress_, {list_, 1}}));
  middle_ = parts::boxed(parts::column({banner_, {film_, 1}}));
  QWidget* const right =
      parts::boxed(parts::column({source_, {view_, 1}, state_, parts::row({parts::spring(), store_, next_})}));
  QSplitter* const all = makeSplitter(Qt::Horizontal, {{left_, 0}, {middle_, 3}, {right, 2}});
  all->setSizes({theme::inType(110), 780, 460});
  setLayout(parts::column({buildHead(), {all, 1}}));
  connectParts();
  setSelected({});
  begin_ = view_;
}

QBoxLayout* RatingPage::buildHead() {
  raterLabel_->setBuddy(rater_);
  participantLabel_->setBuddy(participant_);
  whichLabel_->setBuddy(which_);
  rater_->setMaxLength(64);
  rater_->setPlaceholderText("pseudonym");
  rater_->setToolTip("Stands with the ratings alone: no other page takes it up");
  which_->addItems({"every attempt", QString()});
  reveal_->setToolTip("Who rates blinded judges what was done, not who did it");
  return parts::row({{"Fo&rm", choice_, 2},
                     raterLabel_,
                     {rater_, 1},
                     participantLabel_,
                     {participant_, 1},
                     whichLabel_,
                     {which_, 1},
                     reveal_});
}

void RatingPage::connectParts() {
  connect(choice_, &QComboBox::currentIndexChanged, this, [this] { showForm(); });
  connect(participant_, &QComboBox::currentIndexChanged, this, [this] { showAnswers(); });
  connect(which_, &QComboBox::currentIndexChanged, this, [this] { fillQueue(); });
  connect(rater_, &QLineEdit::editingFinished, this, &RatingPage::setRater);
  connect(reveal_, &QCheckBox::toggled, this, [this](bool shown) {
    film_->setBlinded(!shown);
    showSubject();
    if (shown && !film_->isOpen()) {
      shown_.clear();  // to say why it cannot be shown
      openFilm();
    }
  });
  connect(list_->selectionModel(), &QItemSelectionModel::currentRowChanged, this, [this](const QModelIndex& at) {
    if (!at.isValid()) return;
    if (const std::string& uuid = queue_[static_cast<std::size_t>(at.row())]; uuid != current_) goTo(uuid);
  });
  film_->setBlinded(true);
  connect(film_, &RecordingView::opened, this, [this] {
    seen_.setLength(film_->replay().position().seconds);
    showState();
  });
  connect(film_, &RecordingView::pictureShown, this, &RatingPage::takePicture);
  connect(view_, &RatingFormView::answered, this, [this] {
    drafts::keepAnswers(subject(), view_->answers());
    drafts::keepForm(form()->name);
    showState();
  });
  connect(store_, &QPushButton::clicked, this, [this] { store(false); });
  const auto storeAndGo = [this] {
    if (next_->isEnabled()) store(true);
  };
  connect(next_, &QPushButton::clicked, this, storeAndGo);
  onKey(*this, Qt::CTRL | Qt::Key_Return, storeAndGo);
  for (const Qt::Key key : {Qt::Key_Return, Qt::Key_Enter}) onKey(*view_, key, storeAndGo);
  onKey(*this, Qt::CTRL | Qt::Key_Space, [this] { film_->replay().togglePlaying(); });
  onKey(*this, Qt::Key_Comma, [this] { film_->replay().stepBy(-1); });
  onKey(*this, Qt::Key_Period, [this] { film_->replay().stepBy(1); });
}

void RatingPage::readForms(const std::vector<std::filesystem::path>& folders) {
  QStringList titles;
  for (const auto& entry : recorder::filesIn(folders, "forms")) {
    const QString fault = faultOf([&] {
      const analytics::RatingForm& form = forms_.emplace_back(analytics::readRatingForm(entry.second));
      titles += QString::fromStdString(form.name + ": " + form.title);
    });
    if (fault_.isEmpty()) fault_ = fault;
  }
  refill(*choice_, titles);
  chooseForm(drafts::form());
  showForm();
}

void RatingPage::read() {
  QStringList people;
  tryTo([&] {
    for (const analytics::Participant& person : document_->database().participants())
      people += QString::fromStdString(person.pseudonym);
    ratings_ = document_->assessment().ratings();
  });
  refill(*participant_, people);
  dropStored();
  fillQueue();
}

/// Answers that are in the cohort now are no draft any more.
void RatingPage::dropStored() {
  for (const auto& entry : waiting_) {
    const RatingSubject& about = entry.first;
    const auto there = std::ranges::find_if(ratings_, [&](const analytics::Rating& r) { return isOf(r, about); });
    if (there != ratings_.end() && there->answers == entry.second.answers) drafts::dropAnswers(about);
  }
  waiting_.clear();
}

void RatingPage::setSelected(std::vector<std::string> uuids) {
  selected_ = std::move(uuids);
  which_->setItemText(1, QString("the %1 selected").arg(selected_.size()));
  which_->setItemData(1, "Those that are selected on the page Attempts", Qt::ToolTipRole);
  if (which_->currentIndex() == 1) fillQueue();
}

void RatingPage::chooseForm(const QString& name) {
  if (const int at = choice_->findText(name + ':', Qt::MatchStartsWith); at >= 0) choice_->setCurrentIndex(at);
}

const analytics::RatingForm* RatingPage::form() const {
  const int at = choice_->currentIndex();
  return at < 0 ? nullptr : &forms_[static_cast<std::size_t>(at)];
}

RatingSubject RatingPage::subject() const {
  const analytics::RatingForm& shown = *form();
  return {document_ ? document_->path() : std::string(),
          shown.name,
          shown.version,
          shown.ofAttempts ? current_ : std::string(),
          shown.ofAttempts ? name_.toStdString() : std::string(),
          shown.ofAttempts ? std::string() : participant_->currentText().toStdString()};
}

std::optional<analytics::Rating> RatingPage::stored() const {
  const RatingSubject about = subject();
  const auto found = std::ranges::find_if(ratings_, [&](const analytics::Rating& r) { return isOf(r, about); });
  return found == ratings_.end() ? std::nullopt : std::optional(*found);
}

int RatingPage::number() const {
  const auto at = std::ranges::find(queue_, current_);
  return at == queue_.end() ? 0 : static_cast<int>(at - queue_.begin()) + 1;
}

void RatingPage::setRater() {
  const QString name = rater_->text().trimmed();
  if (name == name_) return;
  const bool first = name_.isEmpty();
  const SeenFilm before = seen_;
  keepSeen();
  name_ = name;
  drafts::keepRater(name);
  shown_.clear();  // each rater sees the films
  if (first && form() != nullptr && drafts::seen(subject()).kept().isEmpty()) {
    // A film that was watched before the name was typed was seen all the same.
    drafts::keepSeen(subject(), before);
    shown_ = current_;
  }
  fillQueue();
}

void RatingPage::showForm() {
  const analytics::RatingForm* shown = form();
  view_->setForm(shown);
  source_->setText(shown != nullptr
                       ? QString("Version %1. %2").arg(shown->version).arg(QString::fromStdString(shown->source))
                   : fault_.isEmpty() ? "No forms were found: Calot is not installed completely."
                                      : fault_);
  showSubject();
  fillQueue();
}

void RatingPage::fillQueue() {
  if (!document_ || form() == nullptr) {
    showAnswers();
    return;
  }
  const bool some = which_->currentIndex() == 1;
  queue_ = some && selected_.empty()
               ? std::vector<std::string>()
               : filmQueue(document_->attempts(), name_.toStdString(), some ? selected_ : std::vector<std::string>());
  rated_.clear();
  RatingSubject about = subject();
  for (const analytics::Rating& r : ratings_) {
    about.attempt = r.attempt;
    if (!r.attempt.empty() && isOf(r, about)) rated_.insert(r.attempt);
  }
  markRated();
  if (number() == 0) current_ = drafts::film(subject());  // a rater goes on where they were
  if (number() > 0)
    goTo(current_);
  else if (const auto open = std::ranges::find_if(queue_, [&](const auto& uuid) { return !rated_.contains(uuid); });
           open != queue_.end())
    goTo(*open);
  else
    goTo(queue_.empty() ? std::string() : queue_.front());
}

void RatingPage::markRated() {
  QStringList names;
  names.reserve(static_cast<qsizetype>(queue_.size()));
  std::size_t done = 0;
  for (std::size_t i = 0; i < queue_.size(); ++i) {
    const bool rated = rated_.contains(queue_[i]);
    done += rated ? 1 : 0;
    names += (rated ? QString::fromUtf8("✓ Film %1") : QString("Film %1")).arg(i + 1);
  }
  if (names != films_.stringList()) films_.setStringList(names);
  progress_->setText(queue_.empty() ? QString("no films") : QString("%1 of %2 rated").arg(done).arg(queue_.size()));
  progress_->setToolTip("Films that you have rated with this form");
}

void RatingPage::goTo(const std::string& uuid) {
  if (uuid != current_) keepSeen();
  current_ = uuid;
  if (form() != nullptr && ofFilms() && !uuid.empty()) drafts::keepFilm(subject());
  if (const int row = number() - 1; row >= 0) list_->setCurrentIndex(films_.index(row));
  showSubject();
  showAnswers();
  openFilm();
}

void RatingPage::goToNext() {
  const auto from = static_cast<std::size_t>(std::max(0, number() - 1));
  for (std::size_t i = 1; i <= queue_.size(); ++i) {
    const std::string& uuid = queue_[(from + i) % queue_.size()];
    if (rated_.contains(uuid)) continue;
    goTo(uuid);
    view_->setFocus(Qt::OtherFocusReason);  // begins with the first item
    return;
  }
  showState();
}

void RatingPage::openFilm() {
  if (!document_ || !isVisible() || !ofFilms() || shown_ == current_) return;
  shown_ = current_;
  ran_ = false;
  seen_ = drafts::seen(subject());
  const analytics::AttemptRow* const attempt = document_->attempt(current_);
  if (attempt == nullptr)
    film_->close("There is no film to rate.");
  else
    film_->open(*attempt, *document_);
  showState();
}

void RatingPage::takePicture(double time) {
  // The picture that is on its way when the film stops was of the film as it ran.
  const bool runs = film_->replay().isOpen() && film_->replay().position().playing;
  if (!std::exchange(ran_, runs) && !runs) return;
  const double before = seen_.share();
  seen_.show(time);
  if (seen_.share() == before) return;
  if (before < SeenFilm::enough && seen_.suffices()) keepSeen();
  showState();
}

void RatingPage::keepSeen() {
  if (document_ && form() != nullptr && ofFilms() && !shown_.empty() && shown_ == current_)
    drafts::keepSeen(subject(), seen_);
}

void RatingPage::hideEvent(QHideEvent* event) {
  keepSeen();
  CohortPage::hideEvent(event);
}

void RatingPage::showSubject() {
  const bool films = ofFilms();
  for (QWidget* widget :
       std::initializer_list<QWidget*>{rater_, raterLabel_, which_, whichLabel_, reveal_, left_, middle_})
    widget->setVisible(films);
  for (QWidget* widget : std::initializer_list<QWidget*>{participant_, participantLabel_}) widget->setVisible(!films);
  const analytics::AttemptRow* const attempt = document_ ? document_->attempt(current_) : nullptr;
  banner_->setVisible(films && reveal_->isChecked() && attempt != nullptr);
  if (attempt != nullptr) banner_->showAttempt(*attempt);
}

void RatingPage::showAnswers() {
  if (form() == nullptr) {
    showState();
    return;
  }
  // Answers that were begun and not stored are newer than the stored ones.
  FormAnswers answers = drafts::answers(subject());
  if (const std::optional<analytics::Rating> before = stored(); before && answers.empty()) {
    for (const analytics::FormItem& item : form()->items()) {
      const auto at = before->answers.find(item.key);
      answers[item.key] = at == before->answers.end() ? std::nullopt : std::optional(at->second);
    }
  }
  view_->setAnswers(answers);
  showState();
}

void RatingPage::showState() {
  const bool named = form() != nullptr && document_ &&
                     (ofFilms() ? !name_.isEmpty() && number() > 0 : participant_->currentIndex() >= 0);
  const bool seen = !ofFilms() || seen_.suffices();
  store_->setEnabled(view_->complete() && named && seen);
  next_->setEnabled(store_->isEnabled());
  next_->setVisible(ofFilms());
  const bool replaces = named && stored().has_value();
  store_->setText(replaces ? "Replace what was &stored" : "&Store");
  QStringList text;
  if (!queue_.empty() && rated_.size() >= queue_.size() && ofFilms()) text += "Every film is rated.";
  if (view_->items() > 0)
    text += QString("%1 of %2 items are answered.").arg(view_->answers().size()).arg(view_->items());
  if (ofFilms() && number() > 0)
    text += QString("%1 % of the film seen%2.")
                .arg(percent(seen_.share()))
                .arg(seen ? QString() : QString(", %1 % are needed").arg(percent(SeenFilm::enough)));
  if (ofFilms() && name_.isEmpty()) text += "Say who rates.";
  if (replaces) text += "Stored before; storing replaces it.";
  state_->setText(text.join(' '));
}

void RatingPage::store(bool goOn) {
  const RatingSubject about = subject();
  const analytics::RatingForm& with = *form();
  tryTo([&] {
    analytics::Rating rating = ratingOf(with, about, view_->answers());
    if (with.ofAttempts) rating.filmSeen = seen_.share();
    const std::optional<analytics::Rating> before = stored();
    Decision decision = ratingDecision(
        {with.name, with.version, with.sha256, with.text}, rating, before,
        with.ofAttempts ? QString("film %1").arg(number()) : "by " + QString::fromStdString(about.participant));
    // Answers that are taken back can be changed and stored again.
    decision.takenBack = [page = QPointer(this), about, answers = view_->answers()] {
      if (!page) return;
      std::erase_if(page->waiting_, [&](const auto& entry) { return isOf(entry.second, about); });
      drafts::keepAnswers(about, answers);
      if (!about.attempt.empty()) page->goTo(about.attempt);
    };
    keepSeen();
    waiting_.emplace_back(about, rating);
    std::erase_if(ratings_, [&](const analytics::Rating& r) { return isOf(r, about); });
    ratings_.push_back(rating);
    if (with.ofAttempts) rated_.insert(about.attempt);
    emit decided(decision);
    markRated();
    goTo(current_);
    if (goOn) goToNext();
  });
}

}  // namespace calot::gui
