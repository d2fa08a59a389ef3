// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/assessment/grade.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <map>

#include "analytics/assessment/norm.h"
#include "analytics/assessment/verdict.h"
#include "analytics/checkpoints/checkpoint.h"
#include "recorder/base/counted.h"
#include "recorder/base/errors.h"

namespace calot::analytics {
namespace {

/// Between no error and one.
constexpr double anyError = 0.5;

bool same(const CheckpointValue& v, const NormCheckpoint& mark) {
  return v.name == mark.checkpoint && v.subject == mark.subject;
}

void askForComparable(const AttemptRow& a, const Norm& norm, bool mixKeys, const std::string& name) {
  if (a.verification.verdict == Verdict::diverged || a.verification.verdict == Verdict::damaged ||
      a.verification.verdict == Verdict::notChecked)
    throw Error(ErrorKind::refused, Where{name},
                fmt::format("attempt {} is {}: it has no figures to grade", a.uuid, nameOf(a.verification.verdict)));
  if (!a.complete || a.outcome == recorder::Outcome::running)
    throw Error(ErrorKind::refused, Where{name}, fmt::format("attempt {} is incomplete and is not graded", a.uuid));
  if (a.comparabilityKey != norm.comparabilityKey && !mixKeys)
    throw Error(ErrorKind::refused, Where{name},
                fmt::format("attempt {} ({}) does not compare with norm {} {} ({})", a.uuid, a.comparabilityKey,
                            norm.name, norm.version, norm.comparabilityKey),
                {Remedy::mixKeys});
}

void judge(GradedFigure& figure, const AttemptValue* found, const Norm& norm, std::size_t position) {
  if (found == nullptr) {
    figure.missing = "the attempt has no such figure";
    return;
  }
  const CheckpointValue* value = &found->value;
  if (!value->value || !std::isfinite(*value->value)) {
    figure.missing = value->value ? "not finite" : value->reason;
    return;
  }
  figure.value = value->value;
  figure.interval = found->interval;
  if (value->version != figure.mark.version) {
    figure.missing = fmt::format("of version {}, the norm's is {}", value->version, figure.mark.version);
    return;
  }
  std::vector<double> competent;
  for (const NormMember& m : norm.members) {
    if (m.competent && m.values[position]) competent.push_back(*m.values[position]);
  }
  figure.competent = competent.size();
  figure.rank = percentile(competent, *figure.value, figure.mark.direction);
  if (!figure.mark.cut) {
    figure.missing =
        (figure.mark.checkpoint == criticalErrors ? "" : "the norm has no pass mark: ") + figure.mark.reason;
    return;
  }
  figure.passed = passes(figure.mark, *figure.value);
  figure.near = isWithinError(figure.mark, figure.error, *figure.value);
  figure.open = figure.mark.lower && *figure.value >= *figure.mark.lower && *figure.value <= *figure.mark.upper;
  // A mark at the end of an interval that is a point is decided: the value is exact.
  if (figure.interval && figure.interval->lower)
    figure.undecided = passes(figure.mark, *figure.interval->lower) != passes(figure.mark, *figure.interval->upper);
}

/// The rule answers alike however the unsure figures of it are taken.
template <class Unsure>
bool isSteady(const Grade& grade, Unsure unsure) {
  std::vector<bool> surely, perhaps;
  for (const GradedFigure& f : grade.figures) {
    const bool passed = f.passed.value_or(false);
    surely.push_back(passed && !unsure(f));
    perhaps.push_back(passed || unsure(f));
  }
  return keepsRule(grade.norm, surely) == keepsRule(grade.norm, perhaps);
}

void conclude(Grade& grade) {
  std::vector<bool> passed;
  std::string fixed;
  for (const GradedFigure& f : grade.figures) {
    passed.push_back(f.passed.value_or(false));
    if (!f.mark.inRule) continue;
    ++grade.inRule;
    grade.passedCount += passed.back() ? 1 : 0;
    if (isFixed(f.mark) && !passed.back()) fixed += fmt::format("; {} has to be passed in any case", f.title);
  }
  grade.needed = neededPasses(grade.norm);
  if (grade.criticalErrors.value_or(0.0) > 0.0) {
    grade.passed = false;
    grade.certain = !grade.criticalUndecided;
    grade.verdict = fmt::format("Not passed: {}, and a single one fails the attempt{}. {}",
                                recorder::counted(std::llround(*grade.criticalErrors), "critical error"),
                                grade.certain ? "" : "; not decided by this simulation", grade.safety.front());
    return;
  }
  grade.passed = keepsRule(grade.norm, passed);
  grade.near = !isSteady(grade, [](const GradedFigure& f) { return f.near; });
  const bool marked = isSteady(grade, [](const GradedFigure& f) { return f.open; });
  const bool simulated = isSteady(grade, [](const GradedFigure& f) { return f.undecided; }) && !grade.criticalUndecided;
  // Open and undecided figures together may turn what neither turns alone.
  grade.certain = marked && simulated && isSteady(grade, [](const GradedFigure& f) { return f.open || f.undecided; });
  std::string doubt = fixed;
  if (grade.near)
    doubt += "; within one standard error of the pass marks, where another attempt may be graded otherwise";
  if (!marked) doubt += "; not certain, as figures lie within the intervals of their pass marks";
  if (!simulated) doubt += "; not decided by this simulation, whose intervals hold pass marks";
  if (!grade.certain && marked && simulated)
    doubt +=
        "; not certain, as figures within the intervals of their pass marks and figures that this simulation does "
        "not decide can turn it together";
  grade.verdict =
      fmt::format("{}: {} of {} figures in the rule passed, {} needed{}.", grade.passed ? "Passed" : "Not passed",
                  grade.passedCount, grade.inRule, grade.needed, doubt);
}

/// The participant's attempts of this key up to this one, by start.
std::vector<const AttemptRow*> pastOf(const AttemptRow& attempt, const std::vector<AttemptRow>& attempts) {
  std::vector<const AttemptRow*> past;
  for (const AttemptRow& a : attempts) {
    if (a.uuid == attempt.uuid) {
      past.push_back(&a);
    } else if (!attempt.participant.empty() && a.participant == attempt.participant &&
               a.comparabilityKey == attempt.comparabilityKey && a.startUtc < attempt.startUtc && !a.excluded &&
               a.parent.empty()) {
      past.push_back(&a);
    }
  }
  std::stable_sort(past.begin(), past.end(),
                   [](const AttemptRow* a, const AttemptRow* b) { return a->startUtc < b->startUtc; });
  return past;
}

void addHistory(GradedFigure& figure, const std::vector<const AttemptRow*>& past,
                const std::map<std::string, std::vector<const AttemptValue*>>& valuesOf) {
  std::vector<double> x, y;
  for (std::size_t i = 0; i < past.size(); ++i) {
    const auto at = valuesOf.find(past[i]->uuid);
    if (at == valuesOf.end()) continue;
    for (const AttemptValue* of : at->second) {
      const CheckpointValue* v = &of->value;
      if (!same(*v, figure.mark) || !v->value || v->version != figure.mark.version) continue;
      figure.history.push_back({past[i]->uuid, past[i]->startUtc, *v->value * figure.displayFactor});
      x.push_back(static_cast<double>(i + 1));
      y.push_back(figure.history.back().value);
    }
  }
  figure.curve = fitLearningCurve(x, y);
}

}  // namespace

Expected<double> percentile(const std::vector<double>& members, double value, Direction direction) {
  const std::size_t n = members.size();
  if (n < leastForPercentile)
    return NoResult{fmt::format("{}, {} needed", recorder::counted(n, "member"), leastForPercentile)};
  std::size_t worse = 0, equal = 0;
  for (const double m : members) {
    worse += (direction == Direction::lower ? m > value : m < value) ? 1 : 0;
    equal += m == value ? 1 : 0;
  }
  const double of = static_cast<double>(n + 1);
  const std::string supported = fmt::format("{} members support percentiles from {:.0f} to {:.0f}", n, 100.0 / of,
                                            100.0 * static_cast<double>(n) / of);
  if (worse == n) return NoResult{fmt::format("better than all; {}", supported)};
  if (worse == 0 && equal == 0) return NoResult{fmt::format("worse than all; {}", supported)};
  return 100.0 * (static_cast<double>(worse) + 0.5 * static_cast<double>(equal) + 0.5) / of;
}

Grade gradeAttempt(const AttemptRow& attempt, const std::vector<AttemptRow>& attempts,
                   const std::vector<AttemptValue>& values, const Norm& norm, bool mixKeys, const std::string& name) {
  askForComparable(attempt, norm, mixKeys, name);
  Grade grade;
  grade.attempt = attempt;
  grade.norm = norm;
  std::map<std::string, std::vector<const AttemptValue*>> valuesOf;
  for (const AttemptValue& v : values) valuesOf[v.attempt].push_back(&v);
  const std::vector<const AttemptValue*>& own = valuesOf[attempt.uuid];
  grade.criticalMissing = "not computed for this attempt";
  for (const auto& counted : errorCheckpoints()) {
    const auto at =
        std::find_if(own.begin(), own.end(), [&](const AttemptValue* v) { return v->value.name == counted.second; });
    grade.safety.push_back(errorSentence(counted.first, at == own.end() ? nullptr : &(*at)->value));
    if (counted.first != Severity::critical || at == own.end()) continue;
    const AttemptValue& critical = **at;
    grade.criticalErrors = critical.value.value;
    grade.criticalMissing = critical.value.reason;
    grade.criticalNote = critical.value.note;
    grade.criticalUndecided = critical.interval && critical.interval->contains(anyError);
    for (const NormCheckpoint& mark : norm.checkpoints) {
      if (mark.checkpoint == criticalErrors && mark.version != critical.value.version)
        grade.remarks.push_back(
            fmt::format("The attempt's errors were judged by version {} of the rules, those of the "
                        "norm's members by version {}.",
                        critical.value.version, mark.version));
    }
  }
  const std::vector<const AttemptRow*> past = pastOf(attempt, attempts);
  const std::vector<std::optional<MarkError>> errors = markErrors(norm, attempts, values);
  for (std::size_t i = 0; i < norm.checkpoints.size(); ++i) {
    GradedFigure figure;
    figure.mark = norm.checkpoints[i];
    figure.error = errors[i];
    figure.title = figure.unit = figure.mark.checkpoint;
    const CheckpointDefinition* d =
        figure.mark.metric ? &figure.mark.metric->definition : findCheckpoint(figure.mark.checkpoint);
    if (d != nullptr) {
      figure.title = d->title;
      figure.unit = d->displayUnit;
      figure.displayFactor = d->displayFactor;
    }
    const auto at =
        std::find_if(own.begin(), own.end(), [&](const AttemptValue* v) { return same(v->value, figure.mark); });
    judge(figure, at == own.end() ? nullptr : *at, norm, i);
    addHistory(figure, past, valuesOf);
    grade.figures.push_back(std::move(figure));
  }
  conclude(grade);
  if (attempt.comparabilityKey != norm.comparabilityKey)
    grade.remarks.push_back(
        fmt::format("The attempt's key ({}) is not the norm's ({}): compared all the same, as asked.",
                    attempt.comparabilityKey, norm.comparabilityKey));
  if (std::any_of(norm.members.begin(), norm.members.end(),
                  [&](const NormMember& m) { return m.attempt == attempt.uuid; }))
    grade.remarks.emplace_back("The attempt is itself a member of the norm.");
  if (norm.members.size() < norm.membersMade)
    grade.remarks.push_back(
        fmt::format("{} of the {} members of the norm are no longer in the cohort; its pass marks are "
                    "those of all.",
                    norm.membersMade - norm.members.size(), norm.membersMade));
  if (attempt.outcome != recorder::Outcome::completed)
    grade.remarks.emplace_back("The attempt was not completed: figures of it may be small because it is short.");
  if (attempt.excluded) grade.remarks.push_back("The attempt is excluded from studies: " + attempt.exclusionReason);
  return grade;
}

std::vector<std::pair<std::string, std::string>> weakFigures(const Grade& grade) {
  std::vector<std::pair<std::string, std::string>> figures;
  for (const GradedFigure& f : grade.figures) {
    if (f.weak()) figures.emplace_back(f.mark.checkpoint, f.mark.subject);
  }
  return figures;
}

void addMoments(Grade& grade, AttemptMoments found) {
  grade.errors = std::move(found.errors);
  for (const FigureMoments& m : found.figures) {
    for (GradedFigure& f : grade.figures) {
      if (f.mark.checkpoint == m.checkpoint && f.mark.subject == m.subject) f.moments = m;
    }
  }
}

std::string useOf(const Norm& norm) {
  if (norm.evidence.empty())
    return "FORMATIVE: for learning only. No evidence is attached that judgements by this norm are valid at this "
           "site.";
  const NormEvidence& e = norm.evidence.back();
  return fmt::format("Validity evidence of the site: {} ({}, SHA-256 {}), attached on {} by {}.", e.statement,
                     e.fileName, e.sha256, e.attachedUtc, e.by);
}

}  // namespace calot::analytics
