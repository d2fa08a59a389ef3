// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/report/study_rows.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <cmath>

#include "analytics/report/report_document.h"
#include "analytics/report/study_output.h"
#include "analytics/report/study_protocol.h"
#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/rank_tests.h"
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
      fmt::format("Holm: adjusted over the {} rank test{} of {}", tests, tests == 1 ? "" : "s",
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
    row.worstRanked[g] = static_cast<std::uint64_t>(
        std::count_if(sample.unfinished[g].begin(), sample.unfinished[g].end(), [&](const std::string& person) {
          return !std::binary_search(row.participants[g].begin(), row.participants[g].end(), person);
        }));
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
  chooseLeading(study, choices);
  for (StudyRow& row : study.rows) warnOfCoverage(row);
}

namespace {

std::string percent(double share) { return fmt::format("{:.1f}", 100.0 * share); }

std::string subjectName(const std::string& subject) {
  if (subject.empty()) return "both hands";
  return subject.find(' ') == std::string::npos ? subject + " hand" : subject;  // "left clipping"
}

double lowest(const std::vector<double>& shares) { return *std::min_element(shares.begin(), shares.end()); }

bool isWhole(const CoverageRow& row) {
  return std::all_of(row.share.begin(), row.share.end(),
                     [](const std::vector<double>& g) { return g.empty() || lowest(g) == 1.0; });
}

/// Coverage of a subject for which the study has a figure.
bool isShown(const Study& study, const CoverageRow& row) {
  return std::any_of(study.rows.begin(), study.rows.end(),
                     [&](const StudyRow& r) { return coverageOf(study, r) == &row; });
}

}  // namespace

void CoverageCollector::add(const CheckpointValue& value, std::size_t group, const std::string& participant,
                            const std::string& attempt) {
  if (!value.coverage) return;
  auto at = std::find_if(subjects_.begin(), subjects_.end(), [&](const Subject& s) { return s.name == value.subject; });
  if (at == subjects_.end()) at = subjects_.insert(at, Subject{value.subject, {}, {}});
  at->share[group][participant].try_emplace(attempt, *value.coverage);
  at->below[group][participant] |= value.availability == Availability::tooLittleCoverage;
}

std::vector<CoverageRow> CoverageCollector::rows() const {
  std::vector<CoverageRow> rows;
  for (const Subject& subject : subjects_) {
    CoverageRow& row = rows.emplace_back();
    row.subject = subject.name;
    for (std::size_t g = 0; g < 2; ++g) {
      for (const auto& [person, attempts] : subject.share[g]) {
        double sum = 0.0;
        for (const auto& item : attempts) sum += item.second;
        row.share[g].push_back(sum / static_cast<double>(attempts.size()));
      }
      row.below[g] = static_cast<std::uint64_t>(std::count_if(subject.below[g].begin(), subject.below[g].end(),
                                                              [](const auto& item) { return item.second; }));
    }
    row.test = mannWhitney(row.share[0], row.share[1]);
  }
  return rows;
}

const CoverageRow* coverageOf(const Study& study, const StudyRow& row) {
  if (!row.sampled) return nullptr;
  const auto at = std::find_if(study.coverage.begin(), study.coverage.end(),
                               [&](const CoverageRow& c) { return c.subject == row.subject; });
  return at == study.coverage.end() ? nullptr : &*at;
}

bool coverageDiffers(const CoverageRow& row, double level) { return row.test && row.test->p <= level; }

ReportTable coverageTable(const Study& study) {
  ReportTable table = tableOf("Coverage", {"=samples of", "=group", "n", "median %", "lowest %", "too little", "p"});
  for (const CoverageRow& row : study.coverage) {
    if (isWhole(row) || !isShown(study, row)) continue;
    for (std::size_t g = 0; g < 2; ++g) {
      const std::vector<double>& shares = row.share[g];
      table.rows.push_back({g == 0 ? subjectName(row.subject) : "", study.groups[g], fmt::format("{}", shares.size()),
                            shares.empty() ? "-" : percent(*median(shares)),
                            shares.empty() ? "-" : percent(lowest(shares)),
                            row.below[g] == 0 ? "" : fmt::format("{}", row.below[g]),
                            g > 0      ? ""
                            : row.test ? pText(row.test->p)
                                       : "-"});
    }
  }
  return table;
}

std::string coverageNote(const Study& study) {
  if (study.coverage.empty()) return {};
  if (coverageTable(study).rows.empty()) return "Coverage: samples cover the whole of every attempt.";
  return "Coverage: share of the time with an instrument that the tracker's samples cover, one value per participant. "
         "too little: participants with a figure that was refused for it. p: Mann-Whitney, two-sided, not adjusted.";
}

std::vector<std::string> coverageWarnings(const Study& study) {
  std::vector<std::string> notes;
  for (const CoverageRow& row : study.coverage) {
    if (!coverageDiffers(row) || !isShown(study, row)) continue;
    notes.push_back(fmt::format(
        "Warning: coverage differs ({}): a median of {} % in {}, {} % in {} (p {}). A difference between the "
        "groups in its figures may be one of measurement, not of skill.",
        subjectName(row.subject), percent(*median(row.share[0])), study.groups[0], percent(*median(row.share[1])),
        study.groups[1], pText(row.test->p)));
  }
  return notes;
}

}  // namespace calot::analytics
