// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/study_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analytics/report/coverage_warning.h"
#include "analytics/report/study_protocol.h"
#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/multiplicity.h"
#include "recorder/errors.h"

namespace calot::analytics {
namespace {

constexpr std::size_t notALevel = 3;

/// 0: expert, skilled; 1: intermediate; 2: novice, unskilled.
std::size_t levelOf(const std::string& group) {
  if (group == "expert" || group == "skilled") return 0;
  if (group == "intermediate") return 1;
  return group == "novice" || group == "unskilled" ? 2 : notALevel;
}

std::string joined(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : ", ") + part;
  return text;
}

/// Values that agree to eleven digits are treated as tied: ranks must not depend on rounding errors.
void dropRounding(std::array<std::vector<double>, 2>& values) {
  std::vector<double> all = values[0];
  all.insert(all.end(), values[1].begin(), values[1].end());
  if (all.empty()) return;
  const auto [least, greatest] = std::minmax_element(all.begin(), all.end());
  if (*greatest - *least > 1e-11 * std::max(std::abs(*least), std::abs(*greatest))) return;
  for (std::vector<double>& group : values) std::fill(group.begin(), group.end(), *least);
}

void summarise(GroupSummary& s, const std::vector<double>& values) {
  s.n = values.size();
  const auto take = [](const Expected<double>& answer) {
    return answer ? std::optional<double>(*answer) : std::nullopt;
  };
  s.mean = take(mean(values));
  s.standardDeviation = take(standardDeviation(values));
  s.median = take(median(values));
  s.lowerQuartile = take(quantile(values, 0.25));
  s.upperQuartile = take(quantile(values, 0.75));
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
  if (row.checkpoint == "attempt-duration") return Expected<Spearman>::none("it is the duration");
  std::vector<double> values, seconds;
  for (std::size_t g = 0; g < 2; ++g) {
    for (std::size_t i = 0; i < row.values[g].size(); ++i) {
      const auto at = duration[g].find(row.participants[g][i]);
      if (at == duration[g].end()) continue;
      values.push_back(row.values[g][i]);
      seconds.push_back(at->second);
    }
  }
  if (seconds.empty()) return Expected<Spearman>::none("no durations");
  row.withDurationPairs = values.size();
  return spearman(values, seconds);
}

/// Both groups' values, with a value beyond the worst for each participant ranked behind all; ranks ignore its size.
std::array<std::vector<double>, 2> withWorst(const StudyRow& row, bool largerIsWorse) {
  std::array<std::vector<double>, 2> ranked = row.values;
  std::vector<double> all;
  for (const auto& values : ranked) all.insert(all.end(), values.begin(), values.end());
  const double edge = all.empty()     ? 0.0
                      : largerIsWorse ? *std::max_element(all.begin(), all.end())
                                      : *std::min_element(all.begin(), all.end());
  const double beyond = largerIsWorse ? edge + std::max(1.0, std::abs(edge)) : edge - std::max(1.0, std::abs(edge));
  for (std::size_t g = 0; g < 2; ++g) ranked[g].insert(ranked[g].end(), row.worstRanked[g], beyond);
  return ranked;
}

void warn(StudyRow& row, CoveredInterval interval, const char* name, std::size_t nx, std::size_t ny) {
  if (std::string text = coverageWarning(interval, name, nx, ny); !text.empty())
    row.coverageWarnings.push_back(std::move(text));
}

void warnOfCoverage(StudyRow& row) {
  const std::size_t nx = row.group[0].n, ny = row.group[1].n;
  if (row.area) warn(row, CoveredInterval::areaScore, "A", nx, ny);
  if (row.shiftInterval) warn(row, CoveredInterval::shift, "shift", nx, ny);
  if (row.hedges && row.hedges->interval) warn(row, CoveredInterval::hedges, "g", nx, ny);
  if (row.adjusted && row.adjusted->analysis)
    warn(row, CoveredInterval::baseline, "difference at one baseline", row.adjusted->n[0], row.adjusted->n[1]);
}

/// The adjusted p of every p that `get` finds in the family's rows, put back by `put`. @returns how many there are.
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
  std::vector<StudyRow*> family;
  for (StudyRow& row : study.rows) {
    const bool named = std::find(choices.family.begin(), choices.family.end(), row.checkpoint) != choices.family.end();
    if (choices.family.empty() || named) family.push_back(&row);
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
  const std::size_t analyses = adjust(
      family,
      [](const StudyRow& r) {
        return r.adjusted && r.adjusted->analysis ? std::optional(r.adjusted->analysis->p) : std::nullopt;
      },
      [](StudyRow& r, double p) { r.adjusted->holm = p; });
  study.family = fmt::format("Holm: adjusted over the {} rank test{} of {}", tests, tests == 1 ? "" : "s",
                             choices.family.empty() ? "this study" : joined(choices.family));
  if (analyses > 0) study.family += fmt::format("; the {} with the baseline are a family of their own", analyses);
  study.family += ".";
}

}  // namespace

bool groupBefore(const std::string& a, const std::string& b) {
  const auto rank = [](const std::string& s) {
    static const std::vector<std::string> known{"expert", "skilled", "intermediate", "novice", "unskilled"};
    return std::find(known.begin(), known.end(), s) - known.begin();
  };
  return rank(a) != rank(b) ? rank(a) < rank(b) : a < b;
}

std::array<std::string, 2> chooseGroups(const std::map<std::string, std::uint64_t>& present,
                                        const StudyChoices& choices, const std::string& path, const std::string& left) {
  std::vector<std::string> names;
  names.reserve(present.size());
  for (const auto& item : present) names.push_back(item.first);
  std::sort(names.begin(), names.end(), groupBefore);
  if (!choices.groups.empty()) {
    if (choices.groups.size() != 2 || choices.groups[0] == choices.groups[1]) {
      throw Error(ErrorKind::invalid, "study: its groups are two, with different names", {Remedy::nameGroups});
    }
    for (const std::string& name : choices.groups) {
      if (present.count(name) == 0) {
        throw Error(ErrorKind::refused, Where{path},
                    fmt::format("nothing for the study in group \"{}\" (there are: {}){}", name,
                                names.empty() ? "none" : joined(names), left));
      }
    }
    return {choices.groups[0], choices.groups[1]};
  }
  if (names.size() == 2) return {names[0], names[1]};
  if (names.size() > 2) {
    throw Error(ErrorKind::refused, Where{path}, fmt::format("{} groups ({})", names.size(), joined(names)),
                {Remedy::nameGroups});
  }
  throw Error(ErrorKind::refused, Where{path},
              fmt::format("a study needs two groups, {}{}",
                          names.empty() ? "none is left" : "only " + names[0] + " is there", left));
}

std::string betterOf(const std::array<std::string, 2>& groups, const StudyChoices& choices) {
  if (!choices.better.empty()) {
    if (choices.better != groups[0] && choices.better != groups[1]) {
      throw Error(ErrorKind::invalid,
                  fmt::format("study: the better group is to be \"{}\", but the groups are {} and {}", choices.better,
                              groups[0], groups[1]),
                  {Remedy::nameBetterGroup});
    }
    return choices.better;
  }
  const std::size_t a = levelOf(groups[0]), b = levelOf(groups[1]);
  if (a == notALevel || b == notALevel || a == b) return {};
  return a < b ? groups[0] : groups[1];
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
    row.worstRanked[g] = static_cast<std::uint64_t>(
        std::count_if(sample.unfinished[g].begin(), sample.unfinished[g].end(), [&](const std::string& person) {
          return !std::binary_search(row.participants[g].begin(), row.participants[g].end(), person);
        }));
  }
  dropRounding(row.values);
  for (std::size_t g = 0; g < 2; ++g) summarise(row.group[g], row.values[g]);
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
  const std::vector<double>&x = row.values[0], &y = row.values[1];
  const bool firstBetter = study.better == study.groups[0];
  if (!row.hypothesis && row.direction != Direction::none && !study.better.empty()) {
    row.hypothesis =
        firstBetter == (row.direction == Direction::higher) ? Hypothesis::firstLarger : Hypothesis::firstSmaller;
  }
  if (!row.hypothesis) row.worstRanked = {};  // direction of worse values is not declared
  const std::array<std::vector<double>, 2> ranked =
      withWorst(row, row.hypothesis && firstBetter == (*row.hypothesis == Hypothesis::firstSmaller));
  row.test = mannWhitney(ranked[0], ranked[1]);
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
  for (StudyRow& row : study.rows) warnOfCoverage(row);
  std::vector<std::pair<std::string, std::size_t>> warnings;
  for (const StudyRow& row : study.rows) {
    for (const std::string& text : row.coverageWarnings) {
      const auto at = std::find_if(warnings.begin(), warnings.end(), [&](const auto& w) { return w.first == text; });
      if (at == warnings.end()) {
        warnings.emplace_back(text, 1);
      } else {
        ++at->second;
      }
    }
  }
  for (const auto& [text, count] : warnings)
    study.remarks.push_back(fmt::format("Warning ({} of {} rows): {}.", count, study.rows.size(), text));
}

}  // namespace calot::analytics
