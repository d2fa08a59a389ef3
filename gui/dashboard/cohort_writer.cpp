// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/cohort_writer.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <map>
#include <QMetaObject>
#include <utility>

#include "analytics/cohort/cohort_database.h"
#include "gui/words/problem_words.h"

namespace calot::gui {

CohortWriter::CohortWriter(QObject* parent) : QObject(parent), back_(std::make_shared<Link<CohortWriter>>(*this)) {
  thread_.setMaxThreadCount(1);
}

CohortWriter::~CohortWriter() {
  back_->cut();
  thread_.waitForDone();
}

void CohortWriter::write(const std::string& database, Change change, std::function<void()> undone) {
  thread_.start([back = back_, database, change = std::move(change), undone = std::move(undone)] {
    QString fault;
    try {
      analytics::CohortDatabase cohort(database, analytics::CohortDatabase::Access::write);
      change(cohort);
    } catch (const std::exception& error) {
      fault = QString::fromStdString(problemText(error));
      undone();
    }
    back->pass([&](CohortWriter& writer) {
      QMetaObject::invokeMethod(
          &writer,
          [&writer, fault] {
            if (fault.isEmpty())
              emit writer.written();
            else
              emit writer.failed(fault);
          },
          Qt::QueuedConnection);
    });
  });
}

namespace {

std::vector<std::string> uuidsOf(const std::vector<analytics::AttemptRow>& attempts) {
  std::vector<std::string> uuids;
  uuids.reserve(attempts.size());
  for (const analytics::AttemptRow& attempt : attempts) uuids.push_back(attempt.uuid);
  return uuids;
}

}  // namespace

struct DecisionCommand::State {
  std::atomic<bool> failed = false;  ///< set on the writer's thread
};

DecisionCommand::DecisionCommand(CohortWriter& writer, std::string database, const QString& text,
                                 CohortWriter::Change redo, CohortWriter::Change undo)
    : QUndoCommand(text),
      writer_(writer),
      database_(std::move(database)),
      redo_(std::move(redo)),
      undo_(std::move(undo)),
      state_(std::make_shared<State>()) {}

void DecisionCommand::write(const CohortWriter::Change& change) {
  if (state_->failed) {
    setObsolete(true);  // what could not be done leaves nothing to undo
    return;
  }
  const auto apply = [state = state_, change](analytics::CohortDatabase& cohort) {
    if (!state->failed) change(cohort);
  };
  writer_.write(database_, apply, [state = state_] { state->failed = true; });
}

std::unique_ptr<DecisionCommand> exclusionCommand(CohortWriter& writer, const Decision& decision, bool exclude,
                                                  const std::string& reason) {
  const std::vector<std::string> uuids = uuidsOf(decision.attempts);
  const std::string by = decision.by;
  if (exclude) {
    return std::make_unique<DecisionCommand>(
        writer, decision.database, "exclusion",
        [=](analytics::CohortDatabase& cohort) { cohort.excludeAttempts(uuids, reason, by); },
        [=](analytics::CohortDatabase& cohort) { cohort.includeAttempts(uuids, "undone: " + reason, by); });
  }
  std::map<std::string, std::vector<std::string>> former;  // reason -> attempts
  for (const analytics::AttemptRow& attempt : decision.attempts)
    former[attempt.exclusionReason].push_back(attempt.uuid);
  return std::make_unique<DecisionCommand>(
      writer, decision.database, "inclusion",
      [=](analytics::CohortDatabase& cohort) { cohort.includeAttempts(uuids, reason, by); },
      [=](analytics::CohortDatabase& cohort) {
        for (const auto& [why, attempts] : former) cohort.excludeAttempts(attempts, why, by);
      });
}

std::unique_ptr<DecisionCommand> tagCommand(CohortWriter& writer, const Decision& decision, bool add,
                                            const std::string& tag) {
  std::vector<analytics::AttemptRow> changed = decision.attempts;
  std::erase_if(changed, [&](const analytics::AttemptRow& attempt) {
    return (std::find(attempt.tags.begin(), attempt.tags.end(), tag) != attempt.tags.end()) == add;
  });
  const std::vector<std::string> uuids = uuidsOf(changed);
  const auto change = [uuids, tag, by = decision.by](bool put) -> CohortWriter::Change {
    return [=](analytics::CohortDatabase& cohort) {
      if (put)
        cohort.tagAttempts(uuids, tag, by);
      else
        cohort.untagAttempts(uuids, tag, by);
    };
  };
  return std::make_unique<DecisionCommand>(writer, decision.database, add ? "tag" : "removal of a tag", change(add),
                                           change(!add));
}

}  // namespace calot::gui
