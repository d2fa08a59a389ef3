// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/cohort_document.h"

#include <algorithm>
#include <cmath>
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

/// Known of an attempt beside its row.
struct Known {
  std::array<const analytics::CheckpointValue*, severityCount> errors{};  ///< null: none is stored
  const analytics::CheckpointValue* criticalView = nullptr;
  QString trend;
};

struct ColumnText {
  const char* title;
  QString (*of)(const Row& attempt, const Known& known);
};

/// The verdict's first sentence; where it has none, that.
QString safetyText(const analytics::CheckpointValue* critical) {
  if (critical == nullptr || !critical->value) return "not assessed";
  return QString::fromStdString(analytics::errorSentence(Severity::critical, critical));
}

QString viewText(const analytics::CheckpointValue* view) {
  return view == nullptr || !view->value ? QString() : QString("%1 of 6").arg(std::lround(*view->value));
}

/// "1 critical, 9 minor"
QString errorsText(const Known& known) {
  QStringList parts;
  for (std::size_t s = 0; s < severityCount; ++s) {
    const analytics::CheckpointValue* const value = known.errors[s];
    if (value == nullptr || !value->value) return {};
    if (const long count = std::lround(*value->value); count > 0)
      parts += QString("%1 %2").arg(count).arg(analytics::nameOf(analytics::errorCheckpoints()[s].first));
  }
  return parts.isEmpty() ? QString("none") : parts.join(", ");
}

/// In the order of AttemptLines::Column.
constexpr std::array<ColumnText, AttemptLines::columnTotal> columns{{
    {"Participant or profile", [](const Row& a, const Known&) { return operatorText(a); }},
    {"Group", [](const Row& a, const Known&) { return QString::fromStdString(a.group); }},
    {"Task", [](const Row& a, const Known&) { return QString::fromStdString(a.scene); }},
    {"When", [](const Row& a, const Known&) { return startText(a.startUtc); }},
    {"Safety", [](const Row&, const Known& known) { return safetyText(known.errors[0]); }},
    {"Critical view", [](const Row&, const Known& known) { return viewText(known.criticalView); }},
    {"Errors", [](const Row&, const Known& known) { return errorsText(known); }},
    {"Trend", [](const Row&, const Known& known) { return known.trend; }},
    {"Outcome", [](const Row& a, const Known&) { return outcomeText(a.outcome) + (a.excluded ? ", excluded" : ""); }},
    {"Verification", [](const Row& a, const Known&) { return badgeText(a.verification.verdict); }},
    {"Mode", [](const Row& a, const Known&) { return modeText(a.mode); }},
    {"Synthetic", [](const Row& a, const Known&) { return QString(a.synthetic ? "synthetic" : ""); }},
    {"Tags", [](const Row& a, const Known&) { return textsOf(a.tags).join(", "); }},
    {"Attempt", [](const Row& a, const Known&) { return QString::fromStdString(a.uuid).left(8); }},
}};

/// Critical errors of the last three of a participant's attempts that compare: "2, 1, 0 critical".
std::vector<QString> trendsOf(const std::vector<Row>& attempts, const AttemptLines::Values& critical) {
  std::map<std::pair<std::string, std::string>, std::vector<std::size_t>> series;
  for (std::size_t i = 0; i < attempts.size(); ++i) {
    const Row& a = attempts[i];
    const auto value = critical.find(a.uuid);
    if (!a.participant.empty() && value != critical.end() && value->second.value)
      series[{a.participant, a.comparabilityKey}].push_back(i);
  }
  std::vector<QString> trends(attempts.size());
  for (auto& entry : series) {
    std::vector<std::size_t>& rows = entry.second;
    std::stable_sort(rows.begin(), rows.end(),
                     [&](std::size_t a, std::size_t b) { return attempts[a].startUtc < attempts[b].startUtc; });
    QStringList counts;
    constexpr int last = 3;
    for (const std::size_t row : rows) {
      counts += QString::number(std::lround(*critical.at(attempts[row].uuid).value));
      if (counts.size() > 1)
        trends[row] = QStringList(counts.mid(std::max<qsizetype>(0, counts.size() - last))).join(", ") + " critical";
    }
  }
  return trends;
}

}  // namespace

AttemptLines::AttemptLines(std::vector<analytics::AttemptRow> attempts, const Figures& figures)
    : attempts_(std::move(attempts)) {
  lines_.reserve(attempts_.size());
  std::set<std::string> tags;
  std::map<QString, int> newest;
  const std::vector<QString> trends = trendsOf(attempts_, figures.errors[0]);
  for (const analytics::AttemptRow& attempt : attempts_) {
    const int row = static_cast<int>(lines_.size());
    Line& line = lines_.emplace_back();
    const auto valueIn = [&](const Values& values) {
      const auto value = values.find(attempt.uuid);
      return value == values.end() ? nullptr : &value->second;
    };
    Known known{{}, valueIn(figures.criticalView), trends[at(row)]};
    for (std::size_t s = 0; s < severityCount; ++s) known.errors[s] = valueIn(figures.errors[s]);
    QString text = QString::fromStdString(attempt.uuid) + '\n' + QString::fromStdString(attempt.profile) + '\n' +
                   QString::fromStdString(attempt.fileName);
    for (int column = 0; column < columnTotal; ++column) {
      line.cells[at(column)] = columns[at(column)].of(attempt, known);
      text += '\n' + line.cells[at(column)];
    }
    line.search = text.toLower();
    tags.insert(attempt.tags.begin(), attempt.tags.end());
    const auto [last, first] = newest.try_emplace(line.cells[operatorColumn], row);
    if (!first && attempts_[at(last->second)].startUtc <= attempt.startUtc) last->second = row;
  }
  for (const auto& entry : newest) lines_[at(entry.second)].latest = true;
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

namespace {

AttemptLines::Figures figuresOf(const analytics::CohortDatabase& database) {
  AttemptLines::Figures figures;
  for (std::size_t s = 0; s < severityCount; ++s)
    figures.errors[s] = database.valuesOf(analytics::errorCheckpoints()[s].second);
  figures.criticalView = database.valuesOf("critical-view");
  return figures;
}

}  // namespace

CohortDocument::CohortDocument(const std::string& path)
    : database_(path, analytics::CohortDatabase::Access::read),
      lines_(std::make_shared<const AttemptLines>(database_.listAttempts(), figuresOf(database_))) {}

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
