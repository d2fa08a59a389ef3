// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/words/attempt_summary.h"

#include <fmt/format.h>
#include <algorithm>
#include <iterator>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "analytics/assessment/verdict.h"
#include "analytics/checkpoints/checkpoint.h"
#include "analytics/report/figure_number.h"
#include "analytics/report/key_figures.h"
#include "analytics/report/report_document.h"
#include "analytics/report/terminal_text.h"
#include "recorder/base/counted.h"

namespace calot::gui {
namespace {

constexpr std::string_view criticalView = "critical-view";

const analytics::CheckpointValue* find(const std::vector<analytics::CheckpointValue>& values, std::string_view name) {
  const auto at =
      std::find_if(values.begin(), values.end(), [&](const analytics::CheckpointValue& v) { return v.name == name; });
  return at == values.end() ? nullptr : &*at;
}

std::string ending(const analytics::AttemptRow& attempt) {
  if (!attempt.complete) return "The recording is not whole.";
  if (attempt.outcome == recorder::Outcome::running) return "The attempt was not ended.";
  if (attempt.outcome == recorder::Outcome::completed) return "The task was completed.";
  return fmt::format("The task was not completed: {}.", recorder::wordFor(attempt.outcome));
}

std::string verdictOf(const analytics::AttemptRow& attempt, const analytics::Grade* grade) {
  constexpr const char* notVerified = " The recording is not verified.";
  constexpr const char* ofVerdict[]{"", " The re-simulation differs: no figure can be relied on.",
                                    " The recording is damaged: no figure can be relied on.", notVerified, notVerified};
  const std::string text = ending(attempt) + ofVerdict[static_cast<std::size_t>(attempt.verification.verdict)];
  if (grade != nullptr) {
    std::string decision = grade->verdict;
    // It ends with the sentence on critical errors, which is among the errors here.
    if (!grade->safety.empty() && decision.ends_with(' ' + grade->safety.front()))
      decision.resize(decision.size() - grade->safety.front().size() - 1);
    return decision + " " + text;
  }
  return text + " It is not held against a norm.";
}

std::string viewOf(const analytics::CheckpointValue* view) {
  if (view == nullptr || analytics::sceneLacks(*view)) return {};
  if (!view->value) return fmt::format("Critical view: not judged, {}.", view->reason);
  const bool reached = *view->value >= JudgementRules().satisfactory;
  return fmt::format("Critical view: {}, {:.0f} of 6 points ({}).", reached ? "satisfactory" : "not reached",
                     *view->value, view->note);
}

/// The verdict: a sentence a severity. One that is not known is said to be so, never to be none.
std::vector<std::string> errorsOf(const std::vector<analytics::CheckpointValue>& values) {
  std::vector<std::string> sentences;
  bool missing = false;
  for (const auto& [severity, name] : analytics::errorCheckpoints()) {
    const analytics::CheckpointValue* const value = find(values, name);
    const bool known = value != nullptr && value->value;
    if (known || !missing) sentences.push_back(analytics::errorSentence(severity, value));
    missing = missing || !known;
  }
  return sentences;
}

}  // namespace

AttemptSummary summaryOf(const analytics::AttemptRow& attempt, const std::vector<analytics::CheckpointValue>& values,
                         const analytics::Grade* grade) {
  AttemptSummary summary;
  summary.verdict = verdictOf(attempt, grade);
  summary.criticalView = viewOf(find(values, criticalView));
  summary.errors = errorsOf(values);
  if (const analytics::CheckpointValue* const critical = find(values, analytics::criticalErrors);
      critical != nullptr && critical->value)
    summary.safety = *critical->value > 0.0 ? AttemptSummary::Safety::notSafe : AttemptSummary::Safety::noCriticalError;
  return summary;
}

NextGoal nextGoal(const analytics::Grade& grade) {
  if (grade.criticalErrors.value_or(0.0) > 0.0)
    return {"No critical error (now: " + grade.criticalNote + ").", std::string(analytics::criticalErrors), {}};
  const analytics::GradedFigure* next = nullptr;
  const auto before = [](const analytics::GradedFigure& a, const analytics::GradedFigure& b) {
    if (analytics::isFixed(a.mark) != analytics::isFixed(b.mark)) return analytics::isFixed(a.mark);
    return (a.rank ? *a.rank : 0.0) < (b.rank ? *b.rank : 0.0);
  };
  for (const analytics::GradedFigure& figure : grade.figures) {
    if (!figure.mark.inRule || !figure.weak() || !figure.value || !figure.mark.cut) continue;
    if (next == nullptr || before(figure, *next)) next = &figure;
  }
  if (next == nullptr)
    return {grade.passed ? "Every figure that counts is passed: the next task, or another norm."
                         : "No figure that counts falls short of its pass mark by its value.",
            {},
            {}};
  const std::string of = next->mark.subject.empty() ? next->title : next->title + ", " + next->mark.subject;
  const std::string unit = next->unit == "1" ? "" : " " + next->unit;
  const analytics::CheckpointDefinition* const definition =
      next->mark.metric ? &next->mark.metric->definition : analytics::findCheckpoint(next->mark.checkpoint);
  const auto shown = [&](double si) { return analytics::figureNumber(definition, si * next->displayFactor) + unit; };
  return {fmt::format("{}: {} {} (now {}).", of,
                      next->mark.direction == analytics::Direction::higher ? "at least" : "at most",
                      shown(*next->mark.cut), shown(*next->value)),
          next->mark.checkpoint, next->mark.subject};
}

namespace {

using ValuesOfAttempts = std::map<std::string, std::vector<analytics::CheckpointValue>>;

/// One column of the closing table.
struct SummaryColumn {
  const analytics::CheckpointDefinition* definition = nullptr;
  std::string subject;
  std::string title;  ///< "elapsed s", "path L mm", "liver burned %"
};

std::string columnTitle(const analytics::CheckpointEntry& entry, const std::string& subject) {
  const analytics::CheckpointDefinition& d = entry.definition;
  const std::string_view word = entry.place.summaryTitle;
  if (subject.empty()) return d.displayUnit == "1" ? std::string(word) : fmt::format("{} {}", word, d.displayUnit);
  if (d.aggregation != analytics::Aggregation::hand) return fmt::format("{} {} {}", subject, word, d.displayUnit);
  return fmt::format("{} {} {}", word, subject == handNames[0] ? "L" : "R", d.displayUnit);
}

/// The checkpoints that ask for columns, for every subject that some attempt has a value of.
std::vector<SummaryColumn> summaryColumns(const ValuesOfAttempts& values) {
  std::vector<SummaryColumn> columns;
  for (const analytics::CheckpointEntry& entry : analytics::checkpointRegistry()) {
    if (entry.place.summaryTitle.empty()) continue;
    std::vector<std::pair<std::string, bool>> subjects;  // in the order of values, and whether one has a value
    for (const auto& attempt : values) {
      for (const analytics::CheckpointValue& v : attempt.second) {
        if (v.name != entry.definition.name) continue;
        const auto same = [&](const auto& subject) { return subject.first == v.subject; };
        auto known = std::find_if(subjects.begin(), subjects.end(), same);
        if (known == subjects.end()) known = subjects.insert(known, {v.subject, false});
        known->second = known->second || v.value.has_value();
      }
    }
    for (const auto& [subject, any] : subjects) {
      if (any) columns.push_back({&entry.definition, subject, columnTitle(entry, subject)});
    }
  }
  return columns;
}

std::string figureText(const std::vector<analytics::CheckpointValue>& values, const SummaryColumn& column) {
  for (const analytics::CheckpointValue& v : values) {
    if (v.name != column.definition->name || v.subject != column.subject) continue;
    if (!v.value)
      return v.availability == analytics::Availability::notApplicable ||
                     v.availability == analytics::Availability::absentHand
                 ? "n/a"
                 : "-";
    return analytics::figureNumber(column.definition, *v.value * column.definition->displayFactor);
  }
  return "-";
}

/// A value's interval, and its parts: what step and mesh change, and the spread by constants. Empty where there is
/// none.
struct IntervalTexts {
  std::string interval;
  std::string parts;   ///< what step, mesh and constants add
  std::string remark;  ///< why there is no interval
};

IntervalTexts intervalTexts(const std::vector<analytics::ValueInterval>& intervals,
                            const analytics::CheckpointValue& of, const analytics::CheckpointDefinition* definition) {
  const double factor = definition != nullptr ? definition->displayFactor : 1.0;
  const analytics::ValueInterval* found = analytics::findInterval(intervals, of);
  if (found == nullptr) return {};
  if (!found->lower) return {"none", "", "no interval: " + found->reason};
  if (*found->lower == *found->upper) return {"exact", "", ""};
  const auto shown = [&](double si) { return analytics::figureNumber(definition, si * factor); };
  const auto change = [&](double si) {
    return fmt::format("{}{}", si > 0.0 ? "+" : "", analytics::figureNumber(definition, si * factor, 2));
  };
  return {fmt::format("[{}, {}]", shown(*found->lower), shown(*found->upper)),
          fmt::format("{}, {}, {}", change(found->stepEffect), change(found->meshEffect),
                      analytics::figureNumber(definition, found->constantsSpread * factor, 2)),
          ""};
}

}  // namespace

void printValues(const std::vector<analytics::CheckpointValue>& values,
                 const std::vector<analytics::ValueInterval>& intervals, std::ostream& out) {
  analytics::ReportTable table =
      analytics::tableOf("", {"=checkpoint", "value", "interval", "=unit", "step, mesh, constants", "=origin", "="});
  table.leastNeeded = {"step, mesh, constants", "origin"};
  for (const analytics::CheckpointValue& v : values) {
    const analytics::CheckpointDefinition* definition = analytics::definitionOf(v);
    const std::string name = v.subject.empty() ? v.name : fmt::format("{} {}", v.name, v.subject);
    if (!v.value) {
      table.rows.push_back({name, "-", "", "", "", "", fmt::format("{}: {}", nameOf(v.availability), v.reason)});
      continue;
    }
    const double factor = definition != nullptr ? definition->displayFactor : 1.0;
    const auto [interval, parts, remark] = intervalTexts(intervals, v, definition);
    const std::string& unit = definition != nullptr ? definition->displayUnit : v.unit;
    table.rows.push_back({name, analytics::figureNumber(definition, *v.value * factor), interval,
                          unit == "1" ? "" : unit, parts, nameOf(v.origin),
                          v.note + (v.note.empty() || remark.empty() ? "" : "; ") + remark});
  }
  if (!table.rows.empty()) table.print(out, 120);  // reasons go on below
}

void printAttempts(const analytics::CohortDatabase& database, std::ostream& out) {
  ValuesOfAttempts values;
  for (analytics::AttemptValue& v : database.allValues()) values[v.attempt].push_back(std::move(v.value));
  analytics::ReportTable table =
      analytics::tableOf("", {"=attempt", "=who", "=scene", "=mode", "=outcome", "=verification", "=recording"});
  const std::vector<SummaryColumn> figures = summaryColumns(values);
  table.leastNeeded = {"mode", "scene"};
  for (const SummaryColumn& figure : figures) table.columns.emplace_back(figure.title, analytics::Align::right);
  std::transform(figures.rbegin(), figures.rend(), std::back_inserter(table.leastNeeded),
                 [](const SummaryColumn& figure) { return figure.title; });
  table.leastNeeded.emplace_back("recording");
  table.columns.emplace_back("", analytics::Align::left);
  std::size_t synthetic = 0;
  for (const analytics::AttemptRow& a : database.listAttempts()) {
    std::string who = a.participant;
    if (who.empty()) who = a.profile.empty() ? wordFor(a.operatorKind) : a.profile;
    std::vector<std::string> cells{a.uuid.substr(0, 8),
                                   who,
                                   fmt::format("{}/{}", a.scene, a.sceneMajor),
                                   wordFor(a.mode),
                                   a.complete ? wordFor(a.outcome) : "incomplete",
                                   nameOf(a.verification.verdict),
                                   a.fileName};
    for (const SummaryColumn& figure : figures) cells.push_back(figureText(values[a.uuid], figure));
    cells.push_back(fmt::format("{}{}", a.synthetic ? "SYNTHETIC" : "", a.excluded ? " excluded" : ""));
    synthetic += a.synthetic ? 1 : 0;
    table.rows.push_back(std::move(cells));
  }
  if (table.rows.empty()) {
    out << "no attempts\n";
    return;
  }
  table.print(out);
  out << fmt::format("{}, {} of them synthetic\n", recorder::counted(table.rows.size(), "attempt"), synthetic);
}

}  // namespace calot::gui
