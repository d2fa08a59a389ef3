// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/rating_draft.h"

#include <algorithm>
#include <QCryptographicHash>
#include <QSettings>

#include "gui/words/problem_words.h"
#include "recorder/base/errors.h"

namespace calot::gui {

namespace fs = std::filesystem;

KnownForms readForms(const std::vector<fs::path>& folders) {
  std::map<std::string, fs::path> byName;
  for (const fs::path& root : folders) {
    std::error_code fault;
    for (fs::directory_iterator it(root / "forms", fault), end; !fault && it != end; it.increment(fault)) {
      if (it->path().extension() == ".json") byName.emplace(it->path().stem().string(), it->path());
    }
  }
  KnownForms known;
  for (const auto& entry : byName) {
    try {
      known.forms.push_back(analytics::readRatingForm(entry.second));
    } catch (const Error& error) {
      known.faults.emplace_back(problemText(error));
    }
  }
  return known;
}

void RatingDraft::store(const std::string& database, const std::string& attempt, const std::string& rater,
                        const std::string& participant, bool replace) const {
  if (form_.ofAttempts && attempt.empty()) throw Error(ErrorKind::invalid, "Choose the attempt that is rated.");
  if (form_.ofAttempts && rater.empty()) throw Error(ErrorKind::invalid, "Say who rates, by a pseudonym.");
  if (!form_.ofAttempts && participant.empty())
    throw Error(ErrorKind::invalid, "Choose the participant who fills in the form.");
  std::vector<std::pair<std::string, std::string>> given;
  for (const auto& [item, score] : answers_) given.emplace_back(item, score ? std::to_string(*score) : "-");
  analytics::Rating rating;
  rating.attempt = form_.ofAttempts ? attempt : std::string();
  rating.rater = form_.ofAttempts ? rater : std::string();
  rating.participant = form_.ofAttempts ? std::string() : participant;
  rating.answers = analytics::answersOf(form_, given);
  analytics::AssessmentDatabase(database, analytics::CohortDatabase::Access::write)
      .storeRating({form_.name, form_.version, form_.sha256, form_.text}, rating, replace);
}

std::optional<analytics::Rating> earlierRating(const std::vector<analytics::Rating>& ratings,
                                               const analytics::RatingForm& form, const std::string& attempt,
                                               const std::string& rater, const std::string& participant) {
  const auto at = std::find_if(ratings.begin(), ratings.end(), [&](const analytics::Rating& r) {
    if (r.form != form.name || r.formVersion != form.version) return false;
    return form.ofAttempts ? r.attempt == attempt && r.rater == rater
                           : r.attempt.empty() && r.participant == participant;
  });
  if (at == ratings.end()) return std::nullopt;
  return *at;
}

namespace {

QSettings drafts() { return {QSettings::IniFormat, QSettings::UserScope, "calot", "drafts"}; }

/// A group of the settings: no name stands there.
QString groupOf(const DraftSubject& s) {
  QCryptographicHash hash(QCryptographicHash::Sha256);
  for (const std::string& part :
       {s.database, s.form, std::to_string(s.formVersion), s.attempt, s.rater, s.participant}) {
    hash.addData(QByteArray::fromStdString(part));
    hash.addData(QByteArray(1, '\0'));
  }
  return QString::fromLatin1(hash.result().toHex());
}

constexpr const char* blankMark = "-";

}  // namespace

void keepDraft(const DraftSubject& subject, const DraftAnswers& answers) {
  QSettings store = drafts();
  store.beginGroup(groupOf(subject));
  store.remove("");
  for (const auto& [item, score] : answers)
    store.setValue(QString::fromStdString(item), score ? QString::number(*score) : QString(blankMark));
}

DraftAnswers keptDraft(const DraftSubject& subject) {
  QSettings store = drafts();
  store.beginGroup(groupOf(subject));
  DraftAnswers answers;
  for (const QString& item : store.childKeys()) {
    const QString text = store.value(item).toString();
    bool number = false;
    const int score = text.toInt(&number);
    if (number || text == blankMark) answers[item.toStdString()] = number ? std::optional(score) : std::nullopt;
  }
  return answers;
}

void dropDraft(const DraftSubject& subject) { drafts().remove(groupOf(subject)); }

}  // namespace calot::gui
