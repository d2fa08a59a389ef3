// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/assessment/norm_decision.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "analytics/assessment/verdict.h"
#include "analytics/statistics/distributions.h"
#include "analytics/statistics/reliability.h"

namespace calot::analytics {
namespace {

double onScale(const NormCheckpoint& mark, double value) { return mark.logScale ? std::log(value) : value; }

/// An attempt's figures in the order of the norm.
struct Judged {
  const AttemptRow* attempt = nullptr;
  std::vector<std::optional<double>> values;
  double criticalErrors = 0.0;
};

/// Attempts of the norm's key that a study could analyse, of people with and without a group, by start.
std::vector<Judged> judgeable(const Norm& norm, const std::vector<AttemptRow>& attempts,
                              const std::vector<AttemptValue>& values) {
  std::vector<Judged> judged;
  std::map<std::string, std::size_t> at;
  for (const AttemptRow& a : attempts) {
    const bool out = std::any_of(a.leftOut.begin(), a.leftOut.end(), [&](const LeftOut& l) {
      return l.rule != "group" && l.rule != "practice" && (l.rule != "synthetic" || !norm.synthetic);
    });
    if (out || a.comparabilityKey != norm.comparabilityKey) continue;
    at[a.uuid] = judged.size();
    judged.push_back({&a, std::vector<std::optional<double>>(norm.checkpoints.size()), 0.0});
  }
  for (const AttemptValue& v : values) {
    const auto found = at.find(v.attempt);
    if (found == at.end() || !v.value.value || !std::isfinite(*v.value.value)) continue;
    Judged& j = judged[found->second];
    if (v.value.name == criticalErrors) j.criticalErrors = *v.value.value;
    for (std::size_t c = 0; c < norm.checkpoints.size(); ++c) {
      const NormCheckpoint& mark = norm.checkpoints[c];
      if (mark.checkpoint == v.value.name && mark.subject == v.value.subject && mark.version == v.value.version)
        j.values[c] = v.value.value;
    }
  }
  return judged;
}

/// @param otherwise figures that are taken for passed, or for failed, where the value is within one standard error
bool isPassed(const Norm& norm, const std::vector<std::optional<double>>& values, double criticalErrors,
              const std::vector<std::optional<MarkError>>& errors = {}, std::optional<bool> otherwise = {}) {
  std::vector<bool> passed;
  for (std::size_t c = 0; c < norm.checkpoints.size(); ++c) {
    const NormCheckpoint& mark = norm.checkpoints[c];
    const bool known = mark.cut && values[c];
    const bool near = otherwise && known && isWithinError(mark, errors[c], *values[c]);
    passed.push_back(near ? *otherwise : known && passes(mark, *values[c]));
  }
  return criticalErrors <= 0.0 && keepsRule(norm, passed);
}

DecisionShare shareOf(std::uint64_t hits, std::uint64_t of) {
  DecisionShare result{hits, of};
  if (of > 0) result.share = wilsonShare(hits, of);
  return result;
}

/// The norm with marks made of its members but one; a mark that cannot be made without that member stays.
Norm without(const Norm& norm, std::size_t left, const std::map<std::string, double>& ratings, double borderline) {
  Norm result = norm;
  for (std::size_t c = 0; c < norm.checkpoints.size(); ++c) {
    NormCheckpoint& mark = result.checkpoints[c];
    if (!mark.cut || !mark.inRule || isFixed(mark)) continue;
    std::vector<double> competent, others, all, rated;
    for (std::size_t m = 0; m < norm.members.size(); ++m) {
      const std::optional<double>& value = norm.members[m].values[c];
      if (m == left || !value) continue;
      (norm.members[m].competent ? competent : others).push_back(*value);
      const auto rating = ratings.find(norm.members[m].attempt);
      if (rating == ratings.end()) continue;
      all.push_back(*value);
      rated.push_back(rating->second);
    }
    if (isByBorderline(norm)) {
      if (const auto cut = borderlineCut(rated, all, borderline, mark.direction, mark.logScale)) mark.cut = cut->cut;
      continue;
    }
    const ContrastingGroupsOptions options{{.resamples = 99, .seed = norm.seed}, mark.logScale};
    const Better better = mark.direction == Direction::lower ? Better::lower : Better::higher;
    if (const auto cut = contrastingGroups(competent, others, better, options)) mark.cut = cut->cut;
  }
  return result;
}

/// First of the competent, then of the others: each member is judged by marks made without them.
/// @param judge of a norm and a member: does the member pass?
template <class Judge>
std::pair<PassRate, PassRate> ratesWithoutSelf(const Norm& norm, const std::vector<Rating>& ratings, Judge judge) {
  const BorderlineMark borderline = borderlineOf(norm).value_or(BorderlineMark{});
  const std::map<std::string, double> rating = meanRatings(ratings, borderline.form);
  std::pair<PassRate, PassRate> rates;
  for (std::size_t m = 0; m < norm.members.size(); ++m) {
    PassRate& rate = norm.members[m].competent ? rates.first : rates.second;
    ++rate.members;
    rate.passed += judge(without(norm, m, rating, borderline.mark), norm.members[m]) ? 1 : 0;
  }
  return rates;
}

}  // namespace

std::vector<std::optional<MarkError>> markErrors(const Norm& norm, const std::vector<AttemptRow>& attempts,
                                                 const std::vector<AttemptValue>& values) {
  const std::vector<Judged> judged = judgeable(norm, attempts, values);
  std::map<std::string, std::size_t> number;
  for (const Judged& j : judged) number.emplace(j.attempt->participant, number.size());
  std::vector<std::optional<MarkError>> errors;
  for (std::size_t c = 0; c < norm.checkpoints.size(); ++c) {
    const NormCheckpoint& mark = norm.checkpoints[c];
    std::vector<RepeatedValue> repeated;
    for (const Judged& j : judged) {
      if (j.attempt->participant.empty() || !j.values[c] || (mark.logScale && *j.values[c] <= 0.0)) continue;
      repeated.push_back(
          {number[j.attempt->participant], static_cast<double>(repeated.size()), onScale(mark, *j.values[c])});
    }
    std::optional<MarkError>& error = errors.emplace_back();
    const Expected<MeasurementError> measured = measurementError(repeated);
    if (measured && measured->people >= minRepeaters) {
      error = MarkError{measured->sem, measured->people};
    } else if (mark.lower && (!mark.logScale || *mark.lower > 0.0)) {
      error = MarkError{(onScale(mark, *mark.upper) - onScale(mark, *mark.lower)) / (2.0 * normalQuantile(0.975)), 0};
    }
  }
  return errors;
}

bool isWithinError(const NormCheckpoint& mark, const std::optional<MarkError>& error, double value) {
  if (!error || (mark.logScale && value <= 0.0)) return false;
  return std::abs(onScale(mark, value) - onScale(mark, *mark.cut)) <= error->value;
}

NormDecisions decisionsOf(const Norm& norm, const std::vector<AttemptRow>& attempts,
                          const std::vector<AttemptValue>& values, const std::vector<Rating>& ratings) {
  NormDecisions decisions;
  const std::vector<std::optional<MarkError>> errors = markErrors(norm, attempts, values);
  const std::vector<Judged> judged = judgeable(norm, attempts, values);
  std::map<std::string, double> criticalErrors;
  for (const Judged& j : judged) criticalErrors[j.attempt->uuid] = j.criticalErrors;
  const auto [competent, others] = ratesWithoutSelf(norm, ratings, [&](const Norm& by, const NormMember& member) {
    return isPassed(by, member.values, criticalErrors[member.attempt]);
  });
  decisions.falsePass = shareOf(others.passed, others.members);
  decisions.falseFail = shareOf(competent.members - competent.passed, competent.members);
  std::map<std::string, std::vector<bool>> byPerson;
  for (const Judged& j : judged) {
    const auto grade = [&](std::optional<bool> otherwise) {
      return isPassed(norm, j.values, j.criticalErrors, errors, otherwise);
    };
    const bool passed = grade({});
    ++decisions.graded;
    decisions.passed += passed ? 1 : 0;
    decisions.near += grade(true) != grade(false) ? 1 : 0;
    if (!j.attempt->participant.empty()) byPerson[j.attempt->participant].push_back(passed);
  }
  std::uint64_t twice = 0, alike = 0, first = 0, second = 0;
  for (const auto& person : byPerson) {
    if (person.second.size() < 2) continue;
    ++twice;
    alike += person.second[0] == person.second[1] ? 1 : 0;
    first += person.second[0] ? 1 : 0;
    second += person.second[1] ? 1 : 0;
  }
  decisions.agreement = shareOf(alike, twice);
  if (twice == 0) return decisions;
  const double n = static_cast<double>(twice), p = static_cast<double>(first) / n, q = static_cast<double>(second) / n;
  const double chance = p * q + (1.0 - p) * (1.0 - q), agreed = static_cast<double>(alike) / n;
  decisions.kappa = chance < 1.0 ? Expected<double>((agreed - chance) / (1.0 - chance))
                                 : NoResult{"all were graded alike, which chance would do, too"};
  return decisions;
}

NormTrial tryNorm(Norm gathered, const std::vector<Rating>& ratings, const NormRequest& request) {
  constexpr std::size_t fewResamples = 99;  // no interval is read
  NormTrial trial{std::move(gathered), {}, {}, {}, {}};
  decideMembers(trial.norm, request);
  findMarks(trial.norm, ratings, request.borderline, fewResamples);
  for (const NormCheckpoint& mark : trial.norm.checkpoints) trial.computed.push_back(mark.cut);
  applyRule(trial.norm, request);
  for (const NormMember& member : trial.norm.members) trial.passed.push_back(isPassedBy(trial.norm, member));
  trial.rates = passRates(trial.norm);
  trial.withoutSelf = ratesWithoutSelf(trial.norm, ratings, isPassedBy);
  return trial;
}

}  // namespace calot::analytics
