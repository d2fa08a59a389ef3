// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/rating_queue.h"

#include <algorithm>
#include <cmath>
#include <QCryptographicHash>
#include <QSettings>
#include <set>
#include <utility>

#include "recorder/base/errors.h"

namespace calot::gui {
namespace {

QByteArray hashOf(std::initializer_list<std::string> parts) {
  QCryptographicHash hash(QCryptographicHash::Sha256);
  for (const std::string& part : parts) {
    hash.addData(QByteArray::fromStdString(part));
    hash.addData(QByteArray(1, '\0'));
  }
  return hash.result();
}

std::string textOf(std::optional<int> score) { return score ? std::to_string(*score) : "-"; }

}  // namespace

std::vector<std::string> filmQueue(const std::vector<analytics::AttemptRow>& attempts, const std::string& rater,
                                   const std::vector<std::string>& only) {
  const std::set<std::string> named(only.begin(), only.end());
  std::vector<std::pair<QByteArray, std::string>> films;
  for (const analytics::AttemptRow& a : attempts) {
    const bool consented = std::ranges::none_of(a.leftOut, [](const auto& out) { return out.rule == "consent"; });
    const bool wanted = named.empty() || named.contains(a.uuid);
    if (!a.excluded && !analytics::isMotion(a) && consented && wanted)
      films.emplace_back(hashOf({rater, a.uuid}), a.uuid);
  }
  std::ranges::sort(films);
  std::vector<std::string> queue;
  queue.reserve(films.size());
  for (auto& film : films) queue.push_back(std::move(film.second));
  return queue;
}

void SeenFilm::setLength(double seconds) {
  seconds_.resize(static_cast<std::size_t>(std::max(1.0, std::ceil(seconds - 1e-6))), '0');
  known_ = true;
}

void SeenFilm::show(double time) {
  if (!known_) return;
  const auto second = static_cast<std::size_t>(std::max(0.0, std::ceil(time - 1e-6) - 1.0));
  seconds_[std::min(second, seconds_.size() - 1)] = '1';
}

double SeenFilm::share() const {
  if (!known_) return 0.0;
  return static_cast<double>(std::ranges::count(seconds_, '1')) / static_cast<double>(seconds_.size());
}

analytics::Rating ratingOf(const analytics::RatingForm& form, const RatingSubject& subject,
                           const FormAnswers& answers) {
  if (form.ofAttempts && subject.attempt.empty()) throw Error(ErrorKind::invalid, "Choose the film that is rated.");
  if (form.ofAttempts && subject.rater.empty()) throw Error(ErrorKind::invalid, "Say who rates, by a pseudonym.");
  if (!form.ofAttempts && subject.participant.empty())
    throw Error(ErrorKind::invalid, "Choose the participant who fills in the form.");
  std::vector<std::pair<std::string, std::string>> given;
  for (const auto& [item, score] : answers) given.emplace_back(item, textOf(score));
  analytics::Rating rating;
  rating.form = form.name;
  rating.formVersion = form.version;
  rating.attempt = subject.attempt;
  rating.rater = subject.rater;
  rating.participant = subject.participant;
  rating.answers = analytics::answersOf(form, given);
  return rating;
}

}  // namespace calot::gui

namespace calot::gui::drafts {
namespace {

constexpr const char* raterKey = "rater";
constexpr const char* formKey = "form";

QSettings store() { return {QSettings::IniFormat, QSettings::UserScope, "calot", "drafts"}; }

QString groupOf(const RatingSubject& s) {
  return QString::fromLatin1(
      hashOf({s.database, s.form, std::to_string(s.formVersion), s.attempt, s.rater, s.participant}).toHex());
}

/// The same film is seen once for all forms.
QString filmKey(const RatingSubject& s) {
  return "films/" + QString::fromLatin1(hashOf({s.database, s.attempt, s.rater}).toHex());
}

QString lastKey(const RatingSubject& s) { return "last/" + QString::fromLatin1(hashOf({s.database, s.rater}).toHex()); }

}  // namespace

FormAnswers answers(const RatingSubject& subject) {
  QSettings drafts = store();
  drafts.beginGroup(groupOf(subject));
  FormAnswers answers;
  for (const QString& item : drafts.childKeys()) {
    const QString text = drafts.value(item).toString();
    bool number = false;
    const int score = text.toInt(&number);
    if (number || text == "-") answers[item.toStdString()] = number ? std::optional(score) : std::nullopt;
  }
  return answers;
}

void dropAnswers(const RatingSubject& subject) { store().remove(groupOf(subject)); }

void keepAnswers(const RatingSubject& subject, const FormAnswers& answers) {
  dropAnswers(subject);
  QSettings drafts = store();
  drafts.beginGroup(groupOf(subject));
  for (const auto& [item, score] : answers)
    drafts.setValue(QString::fromStdString(item), QString::fromStdString(textOf(score)));
}

SeenFilm seen(const RatingSubject& subject) { return SeenFilm(store().value(filmKey(subject)).toString()); }

void keepSeen(const RatingSubject& subject, const SeenFilm& film) { store().setValue(filmKey(subject), film.kept()); }

std::string film(const RatingSubject& subject) { return store().value(lastKey(subject)).toString().toStdString(); }
void keepFilm(const RatingSubject& subject) {
  store().setValue(lastKey(subject), QString::fromStdString(subject.attempt));
}

QString form() { return store().value(formKey).toString(); }
void keepForm(const std::string& name) { store().setValue(formKey, QString::fromStdString(name)); }
QString rater() { return store().value(raterKey).toString(); }
void keepRater(const QString& name) { store().setValue(raterKey, name); }

}  // namespace calot::gui::drafts
