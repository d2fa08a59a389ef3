// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/report/study_rows.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <cmath>
#include <iterator>

#include "analytics/report/report_document.h"
#include "analytics/report/study_output.h"
#include "analytics/report/study_population.h"
#include "analytics/report/study_protocol.h"
#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/rank_tests.h"
#include "recorder/base/counted.h"
#include "recorder/base/errors.h"

namespace calot::analytics {
namespace {

/// Values that agree to eleven digits are treated as tied: ranks must not depend on rounding errors. Each becomes the
/// least one that it agrees with.
void dropRounding(std::array<std::vector<double>, 2>& values) {
  std::vector<double*> all;
  for (std::vector<double>& group : values) {
    for (double& value : group) all.push_back(&value);
  }
  std::sort(all.begin(), all.end(), [](const double* a, const double* b) { return *a < *b; });
  for (std::size_t i = 0; i < all.size();) {
    const double least = *all[i];
    for (; i < all.size() && *all[i] - least <= 1e-11 * std::max(std::abs(least), std::abs(*all[i])); ++i)
      *all[i] = least;
  }
}

/// Counts who has no value at all and why, and whose mean lacks some attempts.
void countMissing(GroupSummary& s, const std::vector<std::string>& present,
                  const std::map<std::string, std::vector<MissingValue>>& missing) {
  std::map<std::string, int> counts;
  for (const auto& [person, attempts] : missing) {
    if (std::binary_search(present.begin(), present.end(), person)) {
      ++s.partial;
      continue;
    }
    ++s.missing;
    ++counts[attempts.front().reason];
    ++s.missingOf[static_cast<std::size_t>(attempts.front().kind)];
  }
  int most = 0;
  for (const auto& [reason, count] : counts) {
    if (count <= most) continue;
    most = count;
    s.missingReason = reason;
  }
}

Expected<Spearman> correlation(StudyRow& row, const std::array<std::map<std::string, double>, 2>& duration) {
  if (row.checkpoint == "attempt-duration") return NoResult{"it is the duration"};
  std::vector<double> values, seconds;
  for (std::size_t g = 0; g < 2; ++g) {
    for (std::size_t i = 0; i < row.values[g].size(); ++i) {
      const auto at = duration[g].find(row.participants[g][i]);
      if (at == duration[g].end()) continue;
      values.push_back(row.values[g][i]);
      seconds.push_back(at->second);
    }
  }
  if (seconds.empty()) return NoResult{"no durations"};
  row.withDurationPairs = values.size();
  return spearman(values, seconds);
}

/// Both groups' values, with a value beyond the worst for each participant ranked behind all; ranks ignore its size.
std::array<std::vector<double>, 2> withWorst(StudyRow& row, bool largerIsWorse) {
  std::array<std::vector<double>, 2> ranked = row.values;
  std::vector<double> all;
  for (const auto& values : ranked) all.insert(all.end(), values.begin(), values.end());
  const double edge = all.empty()     ? 0.0
                      : largerIsWorse ? *std::max_element(all.begin(), all.end())
                                      : *std::min_element(all.begin(), all.end());
  row.worst = largerIsWorse ? edge + std::max(1.0, std::abs(edge)) : edge - std::max(1.0, std::abs(edge));
  for (std::size_t g = 0; g < 2; ++g) ranked[g].insert(ranked[g].end(), row.worstRanked[g].size(), row.worst);
  return ranked;
}

void warn(StudyRow& row, CoveredInterval interval, const char* name, std::size_t nx, std::size_t ny) {
  if (std::string text = coverageWarning(interval, name, nx, ny); !text.empty())
    row.coverageWarnings.push_back(std::move(text));
}

void warnOfCoverage(StudyRow& row) {
  const std::size_t nx = row.group[0].n, ny = row.group[1].n;
  if (row.area)
    warn(row, CoveredInterval::areaScore, "A", nx + row.worstRanked[0].size(), ny + row.worstRanked[1].size());
  if (row.shiftInterval) warn(row, CoveredInterval::shift, "shift", nx, ny);
  if (row.hedges && row.hedges->interval) warn(row, CoveredInterval::hedges, "g", nx, ny);
  if (row.adjusted && row.adjusted->analysis)
    warn(row, CoveredInterval::baseline, "difference at one baseline", row.adjusted->n[0], row.adjusted->n[1]);
}

/// The Mann-Whitney test rejects 8 % without an effect in groups of 8 and 24 where the fewer have 1.5 times the
/// deviation; in groups of one size it nearly keeps its level (docs/explanation/coverage.md).
bool smallerScattersMore(const StudyRow& row) {
  constexpr double ratio = 1.5;
  const std::size_t few = row.group[0].n <= row.group[1].n ? 0 : 1;
  const GroupSummary &a = row.group[few], &b = row.group[1 - few];
  return a.standardDeviation && b.standardDeviation && static_cast<double>(b.n) >= ratio * static_cast<double>(a.n) &&
         *a.standardDeviation >= ratio * *b.standardDeviation;
}

/// The p adjusted by Holm of every p that `get` finds in the family's rows, put back by `put`. @returns how many there
/// are.
template <class Get, class Put>
std::size_t adjust(std::vector<StudyRow*>& family, Get get, Put put) {
  std::vector<double> p;
  std::vector<StudyRow*> whose;
  for (StudyRow* row : family) {
    const std::optional<double> one = get(*row);
    if (!one) continue;
    p.push_back(*one);
    whose.push_back(row);
  }
  const Expected<std::vector<double>> adjusted = holm(p);
  for (std::size_t i = 0; adjusted && i < p.size(); ++i) put(*whose[i], (*adjusted)[i]);
  return p.size();
}

void adjustFamily(Study& study, const StudyChoices& choices) {
  if (choices.family.empty() && study.source == "cohort") {
    study.family = "No hypothesis was declared: estimates with intervals, no p.";
    return;
  }
  std::vector<StudyRow*> family;
  for (StudyRow& row : study.rows) {
    if (choices.family.empty() || isNamed(row, choices.family)) family.push_back(&row);
  }
  for (const std::string& name : choices.family) {
    if (std::none_of(study.rows.begin(), study.rows.end(), [&](const StudyRow& r) { return r.checkpoint == name; })) {
      throw Error(ErrorKind::invalid, fmt::format("study: its family of hypotheses: there is no row \"{}\"", name),
                  {Remedy::nameFamily});
    }
  }
  const std::size_t tests = adjust(
      family, [](const StudyRow& r) { return r.test ? std::optional(r.test->p) : std::nullopt; },
      [](StudyRow& r, double p) { r.holm = p; });
  adjust(
      family, [](const StudyRow& r) { return r.test ? std::optional(r.test->smallestP) : std::nullopt; },
      [](StudyRow& r, double p) { r.attainableP = p; });
  const std::size_t analyses = adjust(
      family,
      [](const StudyRow& r) {
        return r.adjusted && r.adjusted->analysis ? std::optional(r.adjusted->analysis->p) : std::nullopt;
      },
      [](StudyRow& r, double p) { r.adjusted->holm = p; });
  study.family =
      fmt::format("Holm: adjusted over the {} of {}", recorder::counted(tests, "rank test"),
                  choices.family.empty() ? "this study" : fmt::format("{}", fmt::join(choices.family, ", ")));
  if (analyses > 0) study.family += fmt::format("; the {} with the baseline are a family of their own", analyses);
  study.family += ".";
}

/// Primary hypotheses; without a protocol the rows of a named family, else what leads already (addPublished()), and
/// where nothing of it has a value every outcome that has.
void chooseLeading(Study& study, const StudyChoices& choices) {
  const auto hasValue = [](const StudyRow& r) { return r.group[0].n + r.group[1].n > 0; };
  const bool some =
      std::any_of(study.rows.begin(), study.rows.end(), [&](const StudyRow& r) { return r.leading && hasValue(r); });
  for (StudyRow& row : study.rows) {
    if (study.protocol) {
      row.leading = row.role == Role::primary;
    } else if (!choices.family.empty()) {
      row.leading = isNamed(row, choices.family);
    } else {
      row.leading = hasValue(row) && row.notOutcome.empty() && (row.leading || !some);
    }
  }
}

}  // namespace

bool isNamed(const StudyRow& row, const std::vector<std::string>& family) {
  return std::find(family.begin(), family.end(), row.checkpoint) != family.end();
}

void fillRow(StudyRow& row, const StudySample& sample) {
  for (std::size_t g = 0; g < 2; ++g) {
    std::map<std::string, std::size_t> number;
    for (const StudyValue& v : sample.values[g]) number.emplace(v.participant, 0);
    std::size_t next = 0;
    for (auto& item : number) {
      item.second = next++;
      row.participants[g].push_back(item.first);
    }
    std::vector<RepeatedValue> repeated;
    repeated.reserve(sample.values[g].size());
    for (const StudyValue& v : sample.values[g])
      repeated.push_back({number[v.participant], static_cast<double>(v.attempt), v.value});
    if (!repeated.empty()) {
      const auto single = onePerParticipant(repeated, AttemptRule::mean);
      for (const ParticipantValue& one : *single) row.values[g].push_back(one.value);
    }
    countMissing(row.group[g], row.participants[g], sample.missing[g]);
    std::set_difference(sample.unfinished[g].begin(), sample.unfinished[g].end(), row.participants[g].begin(),
                        row.participants[g].end(), std::back_inserter(row.worstRanked[g]));
    row.unfinished[g] = sample.partOfTask[g].size();
  }
  dropRounding(row.values);
  for (std::size_t g = 0; g < 2; ++g) static_cast<Summary&>(row.group[g]) = summaryOf(row.values[g]);
}

void addSimulationRange(StudyRow& row, const StudySample& sample) {
  std::array<std::vector<RangedValue>, 2> groups;
  for (std::size_t g = 0; g < 2; ++g) {
    for (const StudyValue& v : sample.values[g]) {
      const auto at = std::lower_bound(row.participants[g].begin(), row.participants[g].end(), v.participant);
      groups[g].push_back({static_cast<std::size_t>(at - row.participants[g].begin()), v.halfWidth, v.worlds});
    }
  }
  row.simulation = simulationRange(groups);
}

void compareGroups(StudyRow& row, const Study& study, const std::array<std::map<std::string, double>, 2>& duration) {
  if (!row.notOutcome.empty()) {
    row.test = NoResult{row.notOutcome};
    return;
  }
  if (const CoverageRow* sampling = coverageOf(study, row); sampling != nullptr && !sampling->refusal.empty()) {
    row.test = NoResult{sampling->refusal};
    return;
  }
  const std::vector<double>&x = row.values[0], &y = row.values[1];
  const bool firstBetter = study.better == study.groups[0];
  if (!row.hypothesis) row.hypothesis = hypothesisOf(row.direction, study.better, study.groups);
  // Without a direction nothing is the worst, and without a value there is nothing to be behind.
  if (!row.hypothesis || (x.empty() && y.empty())) row.worstRanked = {};
  if (row.simulation && row.worstRanked[0].size() + row.worstRanked[1].size() > 0) row.simulation->area.reset();
  const std::array<std::vector<double>, 2> ranked =
      withWorst(row, row.hypothesis && firstBetter == (*row.hypothesis == Hypothesis::firstSmaller));
  row.test = mannWhitney(ranked[0], ranked[1]);
  if (study.unequalSpread || smallerScattersMore(row)) row.brunnerMunzel = brunnerMunzel(ranked[0], ranked[1]);
  if (study.unequalSpread && row.test && row.brunnerMunzel) {
    MannWhitney unequal = *row.test;
    unequal.p = row.brunnerMunzel->p;
    unequal.exact = row.brunnerMunzel->exact;
    row.test = unequal;
  } else if (study.unequalSpread && row.test) {
    row.test = NoResult{row.brunnerMunzel.reason()};
  }
  row.effect = superiority(ranked[0], ranked[1]);
  row.area = estimateSuperiority(ranked[0], ranked[1], row.hypothesis.value_or(Hypothesis::firstLarger));
  if (row.hypothesis && row.area && row.area->value.a != 0.5) row.asHypothesised = row.area->value.a > 0.5;
  row.shift = hodgesLehmann(x, y);
  row.shiftInterval = hodgesLehmannInterval(x, y);
  row.hedges = hedgesG(x, y);
  row.withDuration = correlation(row, duration);
}

void finishRows(Study& study, const StudyChoices& choices, const Protocol* protocol) {
  if (protocol != nullptr) {
    adjustByProtocol(study, *protocol);
  } else {
    adjustFamily(study, choices);
  }
  chooseLeading(study, choices);
  for (StudyRow& row : study.rows) {
    warnOfCoverage(row);
    if (!study.unequalSpread && row.test && row.brunnerMunzel)
      row.coverageWarnings.emplace_back(
          "p: the smaller group scatters more, where the Mann-Whitney test rejects too often; the test by Brunner and "
          "Munzel is made for that");
  }
  if (study.unequalSpread)
    study.remarks.emplace_back("p: by Brunner and Munzel's test, as declared, in place of the Mann-Whitney test.");
}

}  // namespace calot::analytics
