// SPDX-License-Identifier: GPL-3.0-or-later
// The sentences under a study's tables: what the columns mean, and what is missing.
#include <fmt/format.h>

#include <algorithm>

#include "analytics/report/study_coverage.h"
#include "analytics/report/study_tables.h"

namespace calot::analytics {
namespace {

template <class Test>
bool any(const Study& study, Test test) {
  return std::any_of(study.rows.begin(), study.rows.end(), test);
}

void explainColumns(const Study& study, std::vector<std::string>& notes) {
  const std::string &a = study.groups[0], &b = study.groups[1];
  notes.push_back(
      fmt::format("none: participants without a value. shift: Hodges-Lehmann, {} - {}, with a distribution-free "
                  "interval. p: Mann-Whitney, two-sided, exact with ties "
                  "(~: normal approximation). {}",
                  a, b, study.family));
  if (study.better.empty()) {
    notes.push_back(
        fmt::format("A: P({} larger) + P(equal) / 2, the area under the ROC curve, score interval; no hypothesis: "
                    "nobody said which group is expected to do better.",
                    a));
  } else {
    notes.push_back(fmt::format(
        "A: probability that one of {} is better than one of the other group, ties half, by {}the direction that the "
        "checkpoint declares (without one: that one of {} is larger); the area under the ROC curve, score interval. "
        "expected: whether A is above one half.",
        study.better, study.protocol ? "the protocol's hypothesis or else " : "", a));
  }
  const bool correlated = any(study, [](const StudyRow& r) { return static_cast<bool>(r.withDuration); });
  notes.push_back(
      fmt::format("g: Hedges, {} - {}, interval by non-central t, which assumes normal groups.{}", a, b,
                  correlated ? " rho: Spearman's correlation with the attempt's duration, over both groups." : ""));
  if (study.source == "cohort" && !correlated)
    notes.emplace_back("No correlation with the attempt's duration: durations are missing, too few, or all equal.");
  if (any(study, [](const StudyRow& r) { return r.simulation.has_value(); })) {
    notes.emplace_back(
        "Uncertainty of the simulation: each attempt was run again in smaller steps, with a finer mesh and with other "
        "assumed constants. half-width: of the values' intervals, their median. range of A: over these runs, in each "
        "of "
        "which all attempts have the same step, mesh and constants, and over what step and mesh are extrapolated to. "
        "decided: the same group is ahead in all of them. Figures that no simulation changes are left out.");
  }
  if (any(study, [](const StudyRow& r) { return r.adjusted.has_value(); })) {
    notes.push_back(fmt::format(
        "difference: {} - {} at one baseline, analysis of covariance with HC3 errors, Student's t; n: those "
        "with both. p, one slope: small where the difference depends on the baseline.",
        a, b));
  }
}

/// "no instrument in this hand"; of several kinds how many there are of each, and the commonest reason.
std::string whyMissing(const GroupSummary& s) {
  std::string kinds;
  for (std::size_t kind = 0; kind < s.missingOf.size(); ++kind) {
    if (s.missingOf[kind] == 0) continue;
    if (s.missingOf[kind] == s.missing) return s.missingReason;
    kinds +=
        fmt::format("{}{} {}", kinds.empty() ? "" : ", ", s.missingOf[kind], nameOf(static_cast<Availability>(kind)));
  }
  return fmt::format("{}; most: {}", kinds, s.missingReason);
}

void explainMissing(const Study& study, std::vector<std::string>& notes) {
  for (const StudyRow& row : study.rows) {
    const std::string name = rowName(row);
    if (hasNoValue(row)) {
      std::string why = row.group[0].missingReason;
      if (row.group[1].missingReason != why) why += (why.empty() ? "" : "; ") + row.group[1].missingReason;
      notes.push_back(fmt::format("{}: no value in either group ({})", name, why));
      continue;
    }
    if (!row.test) notes.push_back(fmt::format("{}: no test, {}", name, row.test.reason()));
    for (std::size_t g = 0; g < 2; ++g) {
      const GroupSummary& s = row.group[g];
      if (s.missing > 0) {
        notes.push_back(fmt::format("{}: {} of {} {} without a value ({})", name, s.missing, s.missing + s.n,
                                    study.groups[g], whyMissing(s)));
      }
      if (row.worstRanked[g] > 0) {
        notes.push_back(
            fmt::format("{}: {} of these {} did not complete the attempt and rank behind all others in p "
                        "and A; shift and g are of the values alone",
                        name, row.worstRanked[g], study.groups[g]));
      }
      if (s.partial > 0) {
        notes.push_back(fmt::format("{}: the mean of {} of {} {} lacks some of their {}", name, s.partial, s.n,
                                    study.groups[g], study.counted));
      }
      if (row.adjusted && row.adjusted->withoutBaseline[g] > 0) {
        notes.push_back(fmt::format("{}: {} of {} {} have no baseline", name, row.adjusted->withoutBaseline[g], s.n,
                                    study.groups[g]));
      }
    }
    if (row.adjusted && !row.adjusted->analysis)
      notes.push_back(fmt::format("{}: no analysis of covariance, {}", name, row.adjusted->analysis.reason()));
  }
}

}  // namespace

std::vector<std::string> studyNotes(const Study& study) {
  std::vector<std::string> notes;
  explainColumns(study, notes);
  if (any(study, [](const StudyRow& r) { return r.publishedExpert.has_value(); })) {
    notes.push_back(
        fmt::format("paper: published means of ten experts (E) and ten novices (N), for reference only ({}).",
                    study.publishedSource));
  }
  for (std::string& note : coverageNotes(study)) notes.push_back(std::move(note));
  notes.insert(notes.end(), study.remarks.begin(), study.remarks.end());
  if (study.protocol) {
    for (const std::string& deviation : study.protocol->deviations)
      notes.push_back("Deviation from the protocol: " + deviation);
  }
  explainMissing(study, notes);
  for (const FormReport& report : study.ratings) {
    for (std::string& note : ratingNotes(report)) notes.push_back(std::move(note));
  }
  return notes;
}

}  // namespace calot::analytics
