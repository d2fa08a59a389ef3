// SPDX-License-Identifier: GPL-3.0-or-later

#include "gui/dashboard/cohort_document.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <map>
#include <numeric>
#include <QMetaObject>
#include <set>
#include <string>
#include <utility>

#include "analytics/cohort/cohort_database.h"
#include "gui/attempt/figure_text.h"
#include "gui/words/problem_words.h"

namespace calot::gui {
namespace {

QString tagsText(const std::vector<std::string>& tags) {
  QStringList words;
  for (const std::string& tag : tags) words += QString::fromStdString(tag);
  return words.join(", ");
}

QString cellText(const analytics::AttemptRow& attempt, int column) {
  switch (column) {
    case AttemptLines::attemptColumn:
      return QString::fromStdString(attempt.uuid).left(8);
    case AttemptLines::operatorColumn:
      return operatorText(attempt);
    case AttemptLines::groupColumn:
      return QString::fromStdString(attempt.group);
    case AttemptLines::sceneColumn:
      return QString::fromStdString(attempt.scene);
    case AttemptLines::modeColumn:
      return modeText(attempt.mode);
    case AttemptLines::outcomeColumn:
      return outcomeText(attempt.outcome) + (attempt.excluded ? ", excluded" : "");
    case AttemptLines::startColumn:
      return startText(attempt.startUtc);
    case AttemptLines::verificationColumn:
      return badgeText(attempt.verification.verdict);
    case AttemptLines::syntheticColumn:
      return attempt.synthetic ? QStringLiteral("synthetic") : QString();
    case AttemptLines::tagsColumn:
      return tagsText(attempt.tags);
    default:
      return {};
  }
}

}  // namespace

AttemptLines::AttemptLines(std::vector<analytics::AttemptRow> attempts) : attempts_(std::move(attempts)) {
  lines_.reserve(attempts_.size());
  std::set<std::string> tags;
  for (const analytics::AttemptRow& attempt : attempts_) {
    Line& line = lines_.emplace_back();
    QString text = QString::fromStdString(attempt.uuid) + '\n' + QString::fromStdString(attempt.profile) + '\n' +
                   QString::fromStdString(attempt.fileName);
    for (int column = 0; column < columnTotal; ++column) {
      line.cells[at(column)] = cellText(attempt, column);
      text += '\n' + line.cells[at(column)];
    }
    line.search = text.toLower();
    tags.insert(attempt.tags.begin(), attempt.tags.end());
  }
  for (const std::string& tag : tags) tags_ += QString::fromStdString(tag);
  std::vector<int> order(attempts_.size());
  for (int column = 0; column < columnTotal; ++column) {
    // A start is stored to the second and shown to the minute.
    const auto compare = [&](int a, int b) {
      return column == startColumn ? attempts_[at(a)].startUtc.compare(attempts_[at(b)].startUtc)
                                   : cell(a, column).compare(cell(b, column), Qt::CaseInsensitive);
    };
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](int a, int b) { return compare(a, b) < 0; });
    std::vector<int>& ranks = ranks_[at(column)];
    ranks.resize(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
      const bool same = i > 0 && compare(order[i - 1], order[i]) == 0;
      ranks[at(order[i])] = same ? ranks[at(order[i - 1])] : static_cast<int>(i);
    }
  }
}

FigureValues::FigureValues(const std::function<void(const Take&)>& each) {
  std::map<std::pair<std::string, std::string>, std::size_t> index;
  std::vector<Figure> figures;
  std::vector<std::vector<analytics::AttemptValue>> values;
  std::vector<bool> hasValue;
  each([&](const analytics::AttemptValue& value) {
    const auto [at, isNew] = index.try_emplace({value.value.name, value.value.subject}, figures.size());
    if (isNew) {
      figures.push_back({value.value.name, value.value.subject});
      values.emplace_back();
      hasValue.push_back(false);
    }
    values[at->second].push_back(value);
    if (value.value.value) hasValue[at->second] = true;
  });
  for (std::size_t i = 0; i < figures.size(); ++i) {
    if (!hasValue[i]) continue;
    figures_.push_back(std::move(figures[i]));
    values_.push_back(std::move(values[i]));
  }
}

using Access = analytics::CohortDatabase::Access;

CohortDocument::CohortDocument(const std::string& path)
    : database_(path, Access::read), lines_(std::make_shared<const AttemptLines>(database_.listAttempts())) {}

const analytics::AttemptRow* CohortDocument::attempt(const std::string& uuid) const {
  const auto at = std::find_if(attempts().begin(), attempts().end(),
                               [&](const analytics::AttemptRow& attempt) { return attempt.uuid == uuid; });
  return at == attempts().end() ? nullptr : &*at;
}

std::shared_ptr<const FigureValues> CohortDocument::figureValues() const {
  const std::lock_guard lock(valuesMutex_);
  if (!values_) {
    const analytics::CohortDatabase database(path(), Access::read);  // a connection is of one thread
    values_ =
        std::make_shared<const FigureValues>([&](const FigureValues::Take& take) { database.eachValue({}, take); });
  }
  return values_;
}

const std::vector<analytics::Norm>& CohortDocument::norms() const {
  if (!norms_) norms_ = analytics::AssessmentDatabase(path(), Access::read).norms();
  return *norms_;
}

std::vector<analytics::RegisteredProtocol> CohortDocument::protocols() const {
  return analytics::AssessmentDatabase(path(), Access::read).protocols();
}

std::vector<std::string> CohortDocument::participants() const {
  std::vector<std::string> names;
  for (const analytics::Participant& participant : database_.participants()) names.push_back(participant.pseudonym);
  return names;
}

std::vector<analytics::Rating> CohortDocument::ratings() const {
  return analytics::AssessmentDatabase(path(), Access::read).ratings();
}

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
