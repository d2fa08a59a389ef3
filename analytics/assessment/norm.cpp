// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/assessment/norm.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "analytics/assessment/verdict.h"
#include "analytics/checkpoints/checkpoint.h"
#include "analytics/report/report_document.h"
#include "analytics/report/study_rows.h"
#include "analytics/statistics/standard_setting.h"
#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"

namespace calot::analytics {
namespace {

constexpr const char* allFigures = "all";

bool isNamed(const std::vector<std::string>& named, const std::string& checkpoint, const std::string& subject) {
  return std::any_of(named.begin(), named.end(),
                     [&](const std::string& wanted) { return isCalled(wanted, checkpoint, subject); });
}

/// In the place of a pass mark. The norm keeps by which version of the rules its members were judged.
constexpr const char* criticalMark = "one fails an attempt, whatever its other figures";

/// The mark of one figure, without its place in the rule.
void findMark(NormCheckpoint& mark, const Norm& norm, std::size_t position,
              const std::map<std::string, double>& ratings, const std::optional<BorderlineMark>& borderline,
              std::size_t resamples) {
  std::vector<double> competent, others, rated, all;
  bool positive = true;
  for (const NormMember& m : norm.members) {
    if (!m.values[position]) continue;
    (m.competent ? competent : others).push_back(*m.values[position]);
    all.push_back(*m.values[position]);
    if (borderline) rated.push_back(ratings.at(m.attempt));
    positive = positive && *m.values[position] > 0.0;
  }
  const CheckpointDefinition& definition = *definitionOf(mark);
  mark.logScale = definition.unit == "s" && positive;
  if (borderline) {
    const Expected<RegressionCut> cut =
        borderlineCut(rated, all, borderline->mark, definition.direction, mark.logScale);
    mark.reason = cut.reason();
    if (!cut) return;
    mark.cut = cut->cut;
    mark.lower = cut->lower;
    mark.upper = cut->upper;
    return;
  }
  const ContrastingGroupsOptions options{{.resamples = resamples, .seed = norm.seed}, mark.logScale};
  const Expected<ContrastingGroups> cut = contrastingGroups(
      competent, others, definition.direction == Direction::lower ? Better::lower : Better::higher, options);
  if (!cut) {
    mark.reason = cut.reason();
    return;
  }
  mark.cut = cut->cut;
  if (cut->interval) {
    mark.lower = cut->interval->lower;
    mark.upper = cut->interval->upper;
  } else {
    mark.reason = "no interval: " + cut->interval.reason();
  }
}

/// True if a figure can be in the rule, given a mark.
bool isCandidate(const std::string& checkpoint, const std::string& subject, const NormRequest& request) {
  const auto fixed = [&](const FixedCut& cut) { return isCalled(cut.figure, checkpoint, subject); };
  if (std::any_of(request.fixed.begin(), request.fixed.end(), fixed)) return true;
  if (request.checkpoints.empty()) return countsByDefault(checkpoint);
  return request.checkpoints.front() == allFigures || isNamed(request.checkpoints, checkpoint, subject);
}

/// Before any mark is made: a rule that asks for more figures than there can be in it.
void checkCount(const Norm& norm, const NormRequest& request, const std::string& name) {
  const auto candidates = static_cast<std::size_t>(
      std::count_if(norm.checkpoints.begin(), norm.checkpoints.end(),
                    [&](const NormCheckpoint& mark) { return isCandidate(mark.checkpoint, mark.subject, request); }));
  if (candidates > 0 && request.leastPassed > candidates)  // of none, declareRule() says which names are unknown
    throw Error(ErrorKind::refused, Where{name},
                fmt::format("the rule asks for {} figures, {}", request.leastPassed,
                            request.checkpoints.empty()
                                ? fmt::format("and of those that count the members have {}", candidates)
                                : fmt::format("and the checkpoints that are named give {}", candidates)));
}

void declareRule(Norm& norm, const NormRequest& request, const std::string& name) {
  applyRule(norm, request);
  const bool all = !request.checkpoints.empty() && request.checkpoints.front() == allFigures;
  for (const std::string& wanted : request.checkpoints) {
    if (all) break;
    bool found = false;
    for (const NormCheckpoint& mark : norm.checkpoints) {
      if (!isCalled(wanted, mark.checkpoint, mark.subject)) continue;
      found = true;
      if (!mark.cut)
        throw Error(ErrorKind::refused, Where{name},
                    fmt::format("{} has no pass mark: {}", figureName(mark.checkpoint, mark.subject), mark.reason));
    }
    if (!found)
      throw Error(ErrorKind::invalid, fmt::format("norm: the members have no figure \"{}\" that judges", wanted),
                  {Remedy::nameCheckpoints});
  }
  const std::size_t inRule = figuresInRule(norm);
  if (inRule == 0)
    throw Error(ErrorKind::refused, Where{name}, "no figure that counts has a pass mark", {Remedy::nameCheckpoints});
  if (norm.leastPassed > inRule)
    throw Error(ErrorKind::refused, Where{name},
                fmt::format("the rule asks for {} figures, and {} of {} have a pass mark", norm.leastPassed, inRule,
                            norm.checkpoints.size()));
}

}  // namespace

bool isNormName(const std::string& name) {
  constexpr const char* plain = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_.";
  return !name.empty() && name.size() <= maxName && name.find_first_not_of(plain) == std::string::npos;
}

const CheckpointDefinition* definitionOf(const NormCheckpoint& mark) {
  return mark.metric ? &mark.metric->definition : findCheckpoint(mark.checkpoint);
}

std::pair<std::size_t, std::size_t> sidesOf(const Norm& norm) {
  const auto competent = static_cast<std::size_t>(
      std::count_if(norm.members.begin(), norm.members.end(), [](const NormMember& m) { return m.competent; }));
  return {competent, norm.members.size() - competent};
}

void applyRule(Norm& norm, const NormRequest& request) {
  setFixedCuts(norm, request.fixed);
  for (NormCheckpoint& mark : norm.checkpoints)
    mark.inRule = mark.cut && isCandidate(mark.checkpoint, mark.subject, request);
  norm.leastPassed = request.leastPassed;
}

void findMarks(Norm& norm, const std::vector<Rating>& ratings, const std::optional<BorderlineMark>& borderline,
               std::size_t resamples) {
  std::map<std::string, double> rating;
  if (borderline) rating = meanRatings(ratings, borderline->form);
  for (std::size_t i = 0; i < norm.checkpoints.size(); ++i) {
    NormCheckpoint& mark = norm.checkpoints[i];
    if (mark.checkpoint == criticalErrors)
      mark.reason = criticalMark;
    else
      findMark(mark, norm, i, rating, borderline, resamples);
  }
}

Norm makeNorm(const std::vector<AttemptRow>& attempts, const std::vector<AttemptValue>& values,
              const std::vector<Rating>& ratings, const NormRequest& request, const std::string& name) {
  if (!isNormName(request.name))
    throw Error(ErrorKind::invalid,
                "norm: a name has 1 to 64 letters, digits, points, hyphens and underscores, and no others");
  Norm norm = gatherNorm(attempts, values, ratings, request, name);
  decideMembers(norm, request);
  norm.membersMade = norm.members.size();
  const auto [competent, others] = sidesOf(norm);
  if (std::min(competent, others) < minNormMembers)
    throw Error(ErrorKind::refused, Where{name},
                fmt::format("a norm wants at least {} competent members and as many others; there are {} and {}",
                            minNormMembers, competent, others));
  checkCount(norm, request, name);
  findMarks(norm, ratings, request.borderline, BootstrapOptions{}.resamples);
  declareRule(norm, request, name);
  return norm;
}

bool passes(const NormCheckpoint& mark, double value) {
  return mark.direction == Direction::lower ? value <= *mark.cut : value >= *mark.cut;
}

std::size_t figuresInRule(const Norm& norm) {
  return static_cast<std::size_t>(
      std::count_if(norm.checkpoints.begin(), norm.checkpoints.end(), [](const auto& c) { return c.inRule; }));
}

std::size_t neededPasses(const Norm& norm) { return norm.leastPassed > 0 ? norm.leastPassed : figuresInRule(norm); }

std::string ruleText(const Norm& norm) {
  const auto [competent, others] = passRates(norm);
  return fmt::format(
      "no critical error, and {} of {} figures passed. By this rule {} of {} competent members pass, and {} of {} "
      "others. The pass marks come from these same members, so people new to the norm will be judged correctly less "
      "often.",
      neededPasses(norm), figuresInRule(norm), competent.passed, competent.members, others.passed, others.members);
}

std::string passMarkWarning(const Norm& norm) {
  if (std::none_of(norm.checkpoints.begin(), norm.checkpoints.end(), [](const auto& c) { return c.lower; })) return {};
  const auto [competent, others] = sidesOf(norm);
  const std::string text = isByBorderline(norm)
                               ? coverageWarning(CoveredInterval::borderline, "pass mark", norm.members.size(),
                                                 norm.members.size(), "rated attempts")
                               : coverageWarning(CoveredInterval::cut, "pass mark", competent, others);
  return text.empty() ? text : "Warning: " + text + ".";
}

std::string ownFailureWarning(const Norm& norm) {
  const auto [competent, others] = passRates(norm);
  if (competent.passed == competent.members) return {};
  const std::uint64_t failed = competent.members - competent.passed;
  return fmt::format("Warning: {} of the {} competent members {} by the norm's own rule.", failed, competent.members,
                     failed == 1 ? "fails" : "fail");
}

namespace {

bool hasCriticalError(const Norm& norm, const NormMember& member) {
  for (std::size_t c = 0; c < norm.checkpoints.size(); ++c) {
    if (norm.checkpoints[c].checkpoint == criticalErrors) return member.values[c].value_or(0.0) > 0.0;
  }
  return false;
}

}  // namespace

bool isPassedBy(const Norm& norm, const NormMember& member) {
  std::vector<bool> passed;
  for (std::size_t c = 0; c < norm.checkpoints.size(); ++c)
    passed.push_back(norm.checkpoints[c].cut && member.values[c] && passes(norm.checkpoints[c], *member.values[c]));
  return !hasCriticalError(norm, member) && keepsRule(norm, passed);
}

std::pair<PassRate, PassRate> passRates(const Norm& norm) {
  std::pair<PassRate, PassRate> rates;
  for (const NormMember& m : norm.members) {
    PassRate& rate = m.competent ? rates.first : rates.second;
    ++rate.members;
    rate.passed += isPassedBy(norm, m) ? 1 : 0;
  }
  return rates;
}

Expected<RegressionCut> borderlineCut(const std::vector<double>& ratings, const std::vector<double>& values,
                                      double mark, Direction direction, bool logScale) {
  std::vector<double> scores;
  scores.reserve(values.size());
  for (const double v : values) scores.push_back(logScale ? std::log(v) : v);
  const Expected<BorderlineRegression> line =
      borderlineRegression(ratings, scores, mark, direction == Direction::lower ? Better::lower : Better::higher);
  if (!line) return NoResult{line.reason()};
  const auto back = [logScale](double v) { return logScale ? std::exp(v) : v; };
  return RegressionCut{back(line->cut), back(line->interval.lower), back(line->interval.upper)};
}

}  // namespace calot::analytics
