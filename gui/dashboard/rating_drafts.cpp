// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/rating_drafts.h"

#include <QCryptographicHash>
#include <QSettings>

namespace calot::gui {
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
