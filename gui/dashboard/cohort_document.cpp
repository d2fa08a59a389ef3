// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/cohort_document.h"

#include <algorithm>
#include <exception>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "analytics/assessment/verdict.h"
#include "gui/attempt/figure_text.h"
#include "gui/words/problem_words.h"

namespace calot::gui {

QStringList textsOf(const std::vector<std::string>& texts) {
  QStringList made;
  for (const std::string& text : texts) made += QString::fromStdString(text);
  return made;
}

QString faultOf(const std::function<void()>& call) {
  try {
    call();
    return {};
  } catch (const std::exception& error) {
    return QString::fromStdString(problemText(error));
  }
}

namespace {

using Row = analytics::AttemptRow;

struct ColumnText {
  const char* title;
  QString (*of)(const Row& attempt, const analytics::CheckpointValue* critical);
};

/// The verdict's first sentence; where it has none, that.
QString safetyText(const analytics::CheckpointValue* critical) {
  if (critical == nullptr || !critical->value) return "not assessed";
  return QString::fromStdString(analytics::errorSentence(Severity::critical, critical));
}

/// In the order of AttemptLines::Column.
using Critical = const analytics::CheckpointValue*;
constexpr std::array<ColumnText, AttemptLines::columnTotal> columns{{
    {"Start", [](const Row& a, Critical) { return startText(a.startUtc); }},
    {"Participant or profile", [](const Row& a, Critical) { return operatorText(a); }},
    {"Group", [](const Row& a, Critical) { return QString::fromStdString(a.group); }},
    {"Scene", [](const Row& a, Critical) { return QString::fromStdString(a.scene); }},
    {"Outcome", [](const Row& a, Critical) { return outcomeText(a.outcome) + (a.excluded ? ", excluded" : ""); }},
    {"Safety", [](const Row&, Critical critical) { return safetyText(critical); }},
    {"Verification", [](const Row& a, Critical) { return badgeText(a.verification.verdict); }},
    {"Mode", [](const Row& a, Critical) { return modeText(a.mode); }},
    {"Synthetic", [](const Row& a, Critical) { return QString(a.synthetic ? "synthetic" : ""); }},
    {"Tags", [](const Row& a, Critical) { return textsOf(a.tags).join(", "); }},
    {"Attempt", [](const Row& a, Critical) { return QString::fromStdString(a.uuid).left(8); }},
}};

}  // namespace

AttemptLines::AttemptLines(std::vector<analytics::AttemptRow> attempts,
                           const std::map<std::string, analytics::CheckpointValue>& critical)
    : attempts_(std::move(attempts)) {
  lines_.reserve(attempts_.size());
  std::set<std::string> tags;
  for (const analytics::AttemptRow& attempt : attempts_) {
    Line& line = lines_.emplace_back();
    const auto value = critical.find(attempt.uuid);
    QString text = QString::fromStdString(attempt.uuid) + '\n' + QString::fromStdString(attempt.profile) + '\n' +
                   QString::fromStdString(attempt.fileName);
    for (int column = 0; column < columnTotal; ++column) {
      line.cells[at(column)] = columns[at(column)].of(attempt, value == critical.end() ? nullptr : &value->second);
      text += '\n' + line.cells[at(column)];
    }
    line.search = text.toLower();
    tags.insert(attempt.tags.begin(), attempt.tags.end());
  }
  tags_ = textsOf({tags.begin(), tags.end()});
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

QString AttemptLines::title(int column) { return columns[at(column)].title; }

FigureValues::FigureValues(const std::function<void(const Take&)>& each) {
  std::map<std::pair<std::string, std::string>, std::size_t> index;
  each([&](const analytics::AttemptValue& value) {
    const auto [at, isNew] = index.try_emplace({value.value.name, value.value.subject}, figures_.size());
    if (isNew) {
      figures_.push_back({value.value.name, value.value.subject});
      values_.emplace_back();
    }
    values_[at->second].push_back(value);
  });
  // Without any value there is nothing to look at.
  const auto isMissing = [](const analytics::AttemptValue& value) { return !value.value.value; };
  for (std::size_t i = figures_.size(); i-- > 0;) {
    if (!std::ranges::all_of(values_[i], isMissing)) continue;
    figures_.erase(figures_.begin() + static_cast<std::ptrdiff_t>(i));
    values_.erase(values_.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

CohortDocument::CohortDocument(const std::string& path)
    : database_(path, analytics::CohortDatabase::Access::read),
      lines_(std::make_shared<const AttemptLines>(database_.listAttempts(),
                                                  database_.valuesOf(analytics::criticalErrors))) {}

const analytics::AttemptRow* CohortDocument::attempt(const std::string& uuid) const {
  const auto at = std::ranges::find(attempts(), uuid, &analytics::AttemptRow::uuid);
  return at == attempts().end() ? nullptr : &*at;
}

std::shared_ptr<const FigureValues> CohortDocument::figureValues() const {
  const std::lock_guard lock(valuesMutex_);
  if (!values_) {
    const analytics::CohortDatabase database(path(),
                                             analytics::CohortDatabase::Access::read);  // a connection is of one thread
    values_ =
        std::make_shared<const FigureValues>([&](const FigureValues::Take& take) { database.eachValue({}, take); });
  }
  return values_;
}

const std::vector<analytics::Norm>& CohortDocument::norms() const {
  if (!norms_) norms_ = assessment().norms();
  return *norms_;
}

void CohortWriter::write(const std::string& database, Change change, std::function<void()> undone) {
  thread_.start([this, database, change = std::move(change), undone = std::move(undone)] {
    const QString fault = faultOf([&] {
      analytics::CohortDatabase cohort(database, analytics::CohortDatabase::Access::write);
      change(cohort);
    });
    if (!fault.isEmpty()) undone();
    const auto report = [this, fault] {
      if (fault.isEmpty())
        emit written();
      else
        emit failed(fault);
    };
    QMetaObject::invokeMethod(this, report, Qt::QueuedConnection);
  });
}

}  // namespace calot::gui
