// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/words/attempt_summary.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "analytics/checkpoints/checkpoint.h"

namespace calot::gui {
namespace {

constexpr std::string_view criticalView = "critical-view", criticalErrors = "critical-errors";

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
  if (grade != nullptr) return grade->verdict + " " + text;
  return text + " It is not held against a norm.";
}

std::string viewOf(const analytics::CheckpointValue* view) {
  if (view == nullptr || sceneLacks(*view)) return {};
  if (!view->value) return fmt::format("Critical view: not judged, {}.", view->reason);
  const bool reached = *view->value >= JudgementRules().satisfactory;
  return fmt::format("Critical view: {}, {:.0f} of 6 points ({}).", reached ? "satisfactory" : "not reached",
                     *view->value, view->note);
}

std::string counted(const std::vector<analytics::CheckpointValue>& values, std::string_view name, const char* one,
                    const char* more) {
  double sum = 0.0;
  bool any = false;
  for (const analytics::CheckpointValue& v : values) {
    if (v.name != name || !v.value) continue;
    any = true;
    sum += *v.value;
  }
  if (!any) return {};
  if (sum == 0.0) return fmt::format("no {}", one);
  return fmt::format("{:.0f} {}", sum, sum == 1.0 ? one : more);
}

std::string errorsOf(const std::vector<analytics::CheckpointValue>& values) {
  std::vector<std::string> parts;
  for (std::string part : {counted(values, criticalErrors, "critical error", "critical errors"),
                           counted(values, "clip-errors", "clip error", "clip errors"),
                           counted(values, "organ-perforations", "perforation", "perforations")}) {
    if (!part.empty()) parts.push_back(std::move(part));
  }
  if (parts.empty()) return "Errors: none are judged in this scene.";
  std::string text = fmt::format("Errors: {}", fmt::join(parts, ", "));
  const analytics::CheckpointValue* critical = find(values, criticalErrors);
  if (critical != nullptr && critical->value.value_or(0.0) > 0.0) text += "; a critical error fails the attempt";
  return text + ".";
}

}  // namespace

bool sceneLacks(const analytics::CheckpointValue& value) {
  if (value.availability != analytics::Availability::notApplicable) return false;
  const std::string& reason = value.reason;
  return reason.starts_with("the scene has no ") || reason.starts_with("the scene gives this organ no ") ||
         reason.ends_with("in this scene");
}

AttemptSummary summaryOf(const analytics::AttemptRow& attempt, const std::vector<analytics::CheckpointValue>& values,
                         const analytics::Grade* grade) {
  AttemptSummary summary;
  summary.verdict = verdictOf(attempt, grade);
  summary.criticalView = viewOf(find(values, criticalView));
  summary.errors = errorsOf(values);
  for (const std::string_view name : analytics::countingCheckpoints()) {
    if (name == criticalView) continue;
    const analytics::CheckpointDefinition* definition = analytics::findCheckpoint(name);
    KeyFigure figure{std::string(name), definition != nullptr ? definition->title : std::string(name), {}};
    for (const analytics::CheckpointValue& v : values) {
      if (v.name == name && !sceneLacks(v)) figure.values.push_back(v);
    }
    if (!figure.values.empty()) summary.figures.push_back(std::move(figure));
  }
  return summary;
}

NextGoal nextGoal(const analytics::Grade& grade) {
  if (grade.criticalErrors.value_or(0.0) > 0.0)
    return {"No critical error: nothing that must be spared is clipped, cut, burned or torn.",
            std::string(criticalErrors),
            {}};
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
  const auto shown = [&](double si) { return fmt::format("{:.4g}{}", si * next->displayFactor, unit); };
  return {fmt::format("{}: {} {} (now {}).", of,
                      next->mark.direction == analytics::Direction::higher ? "at least" : "at most",
                      shown(*next->mark.cut), shown(*next->value)),
          next->mark.checkpoint, next->mark.subject};
}

}  // namespace calot::gui
