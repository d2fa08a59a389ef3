// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/decisions.h"

#include <algorithm>
#include <atomic>
#include <map>
#include <memory>
#include <QAction>
#include <QKeySequence>
#include <QUndoCommand>
#include <QUndoStack>
#include <utility>

#include "analytics/assessment/norm.h"

namespace calot::gui {
namespace {

class DecisionCommand : public QUndoCommand {
 public:
  /// @param writer outlives this
  DecisionCommand(CohortWriter& writer, std::string database, Decision decision)
      : QUndoCommand(decision.text), writer_(writer), database_(std::move(database)), decision_(std::move(decision)) {}
  void redo() override {
    if (!std::exchange(decision_.made, false)) write(decision_.make);
  }
  void undo() override {
    write(decision_.undo);
    if (decision_.takenBack) decision_.takenBack();
  }

 private:
  void write(const Decision::Change& change) {
    if (*failed_) {
      setObsolete(true);  // what could not be done leaves nothing to undo
      return;
    }
    const auto apply = [failed = failed_, change](analytics::CohortDatabase& cohort) {
      if (!*failed) change(cohort);
    };
    writer_.write(database_, apply, [failed = failed_] { *failed = true; });
  }

  CohortWriter& writer_;
  std::string database_;
  Decision decision_;
  std::shared_ptr<std::atomic<bool>> failed_ = std::make_shared<std::atomic<bool>>(false);  ///< by the writer's thread
};

/// "attempt 3f2a1b9c", "3 attempts"
QString attemptsText(const std::vector<std::string>& uuids) {
  return uuids.size() == 1 ? "attempt " + QString::fromStdString(uuids.front()).left(8)
                           : QString("%1 attempts").arg(uuids.size());
}

/// An action whose text follows the stack's. @param word "&Undo"
QAction* actionOf(QUndoStack& stack, const char* word, QKeySequence::StandardKey key, void (QUndoStack::*act)(),
                  void (QUndoStack::*possible)(bool), void (QUndoStack::*named)(const QString&)) {
  auto* const action = new QAction(word, &stack);
  action->setShortcut(key);
  action->setEnabled(false);
  QObject::connect(action, &QAction::triggered, &stack, act);
  QObject::connect(&stack, possible, action, &QAction::setEnabled);
  QObject::connect(&stack, named, action, [action, word](const QString& text) {
    action->setText(text.isEmpty() ? QString(word) : QString(word) + ": " + QString(text).replace('&', "&&"));
  });
  return action;
}

}  // namespace

Decision exclusionDecision(const std::vector<analytics::AttemptRow>& attempts, bool exclude, const std::string& reason,
                           const std::string& by) {
  std::vector<std::string> uuids;
  std::map<std::string, std::vector<std::string>> former;  // reason -> attempts
  for (const analytics::AttemptRow& attempt : attempts) {
    if (attempt.withdrawn || attempt.excluded == exclude) continue;
    uuids.push_back(attempt.uuid);
    former[attempt.exclusionReason].push_back(attempt.uuid);
  }
  if (exclude) {
    return {"exclude " + attemptsText(uuids),
            [=](analytics::CohortDatabase& cohort) { cohort.excludeAttempts(uuids, reason, by); },
            [=](analytics::CohortDatabase& cohort) { cohort.includeAttempts(uuids, "undone: " + reason, by); }};
  }
  return {"include " + attemptsText(uuids),
          [=](analytics::CohortDatabase& cohort) { cohort.includeAttempts(uuids, reason, by); },
          [=](analytics::CohortDatabase& cohort) {
            for (const auto& entry : former) cohort.excludeAttempts(entry.second, entry.first, by);
          }};
}

Decision tagDecision(const std::vector<analytics::AttemptRow>& attempts, bool add, const std::string& tag,
                     const std::string& by) {
  std::vector<std::string> uuids;
  for (const analytics::AttemptRow& attempt : attempts) {
    const bool has = std::find(attempt.tags.begin(), attempt.tags.end(), tag) != attempt.tags.end();
    if (has != add) uuids.push_back(attempt.uuid);
  }
  const auto change = [uuids, tag, by](bool put) -> Decision::Change {
    return [=](analytics::CohortDatabase& cohort) {
      if (put)
        cohort.tagAttempts(uuids, tag, by);
      else
        cohort.untagAttempts(uuids, tag, by);
    };
  };
  const QString word = QString::fromStdString(tag);
  return {(add ? "tag " + word + " on " : "tag " + word + " off ") + attemptsText(uuids), change(add), change(!add)};
}

Decision groupDecision(const std::string& participant, const std::string& group, const std::string& before) {
  const auto change = [participant](const std::string& to) -> Decision::Change {
    return [participant, to](analytics::CohortDatabase& cohort) {
      analytics::ParticipantChange made;
      made.group = to;
      cohort.setParticipant(participant, made);
    };
  };
  return {"group of " + QString::fromStdString(participant), change(group), change(before)};
}

Decision ratingDecision(const analytics::StoredDocument& form, const analytics::Rating& rating,
                        const std::optional<analytics::Rating>& before, const QString& name) {
  const auto store = [form](const analytics::Rating& what, bool replace) -> Decision::Change {
    return [=](analytics::CohortDatabase& cohort) { cohort.storeRating(form, what, replace); };
  };
  const Decision::Change remove = [rating](analytics::CohortDatabase& cohort) { cohort.removeRating(rating); };
  return {"rating of " + name, store(rating, before.has_value()), before ? store(*before, true) : remove};
}

Decision normDecision(const analytics::Norm& norm) {
  const auto version = std::make_shared<std::uint32_t>(norm.version);  // the writer's thread alone reads and sets it
  return {"norm " + QString::fromStdString(norm.name),
          [norm, version](analytics::CohortDatabase& cohort) { *version = cohort.storeNorm(norm); },
          [norm, version](analytics::CohortDatabase& cohort) { cohort.removeNorm(norm.name, *version, norm.by); },
          true};
}

Decisions::Decisions(QObject* parent)
    : QObject(parent),
      stack_(new QUndoStack(this)),
      undo_(actionOf(*stack_, "&Undo", QKeySequence::Undo, &QUndoStack::undo, &QUndoStack::canUndoChanged,
                     &QUndoStack::undoTextChanged)),
      redo_(actionOf(*stack_, "&Redo", QKeySequence::Redo, &QUndoStack::redo, &QUndoStack::canRedoChanged,
                     &QUndoStack::redoTextChanged)) {
  connect(&writer_, &CohortWriter::written, this, &Decisions::written);
  connect(&writer_, &CohortWriter::failed, this, &Decisions::failed);
}

void Decisions::take(const std::string& database, const Decision& decision) {
  stack_->push(new DecisionCommand(writer_, database, decision));
}

void Decisions::forget() { stack_->clear(); }

}  // namespace calot::gui
