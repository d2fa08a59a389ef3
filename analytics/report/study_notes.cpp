// SPDX-License-Identifier: GPL-3.0-or-later
// The sentences under a study's tables: what the columns mean, and what is missing.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

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
  notes.emplace_back(
      "none: participants without a value. The interval of the shift is distribution-free, that of A the score "
      "interval; A is the area under the ROC curve. ~: p by normal approximation, else exact with ties. Without a "
      "direction of its own, a figure's A is that of the first group's values being larger. expected: whether A is "
      "above "
      "one half, where p is below 1.");
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

/// Why a row has no value at all or an outcome no test; empty where it has one.
std::string untested(const StudyRow& row) {
  if (!hasNoValue(row)) return row.test || !row.notOutcome.empty() ? std::string() : "no test, " + row.test.reason();
  std::string why = row.group[0].missingReason;
  if (row.group[1].missingReason != why) why += (why.empty() ? "" : "; ") + row.group[1].missingReason;
  return fmt::format("no value in either group ({})", why);
}

/// Rows of which nothing else is to be said, by what is.
using UntestedRows = std::vector<std::pair<std::string, std::string>>;

void addTo(UntestedRows& untestedRows, const std::string& reason, const std::string& name) {
  const auto at =
      std::find_if(untestedRows.begin(), untestedRows.end(), [&](const auto& u) { return u.first == reason; });
  if (at == untestedRows.end()) {
    untestedRows.emplace_back(reason, name);
  } else {
    at->second += ", " + name;
  }
}

/// What is missing of one row, a line a fact.
void explainMissingOf(const Study& study, const StudyRow& row, std::vector<std::string>& notes) {
  const std::string name = rowName(row);
  if (const std::string reason = untested(row); !reason.empty()) notes.push_back(fmt::format("{}: {}", name, reason));
  if (hasNoValue(row)) return;
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

}  // namespace

std::vector<std::string> intervalWarnings(const Study& study, bool leading) {
  std::vector<std::pair<std::string, std::size_t>> counts;
  std::size_t rows = 0;
  for (const StudyRow& row : study.rows) {
    if (row.leading != leading) continue;
    ++rows;
    for (const std::string& text : row.coverageWarnings) {
      const auto at = std::find_if(counts.begin(), counts.end(), [&](const auto& c) { return c.first == text; });
      if (at == counts.end()) {
        counts.emplace_back(text, 1);
      } else {
        ++at->second;
      }
    }
  }
  // Intervals of which the same is to be said of as many rows share a line: "A, shift, g: ...".
  struct Shared {
    std::string names, said;
    std::size_t count;
  };
  std::vector<Shared> shared;
  for (const auto& [text, count] : counts) {
    const std::size_t colon = text.find(": ");
    const std::string name = text.substr(0, colon);
    const std::string said = colon == std::string::npos ? "" : text.substr(colon);
    const auto at = std::find_if(shared.begin(), shared.end(), [said, count = count](const Shared& s) {
      return !said.empty() && s.said == said && s.count == count;
    });
    if (at == shared.end()) {
      shared.push_back({name, said, count});
    } else {
      at->names += ", " + name;
    }
  }
  std::vector<std::string> warnings;
  warnings.reserve(shared.size());
  for (const Shared& s : shared)
    warnings.push_back(fmt::format("Warning ({} of {} rows): {}{}.", s.count, rows, s.names, s.said));
  return warnings;
}

void explainMissing(const Study& study, bool leading, std::vector<std::string>& notes) {
  UntestedRows untestedRows;
  for (const StudyRow& row : study.rows) {
    if (row.leading != leading) continue;
    std::vector<std::string> own;
    explainMissingOf(study, row, own);
    if (own.size() == 1 && !untested(row).empty()) {
      addTo(untestedRows, untested(row), rowName(row));
    } else {
      notes.insert(notes.end(), own.begin(), own.end());
    }
  }
  for (const auto& [reason, names] : untestedRows) notes.push_back(fmt::format("{}: {}", names, reason));
}

std::vector<std::string> appendixNotes(const Study& study) {
  std::vector<std::string> notes;
  explainColumns(study, notes);
  if (any(study, [](const StudyRow& r) { return r.publishedExpert.has_value(); })) {
    notes.push_back(
        fmt::format("paper: published means of ten experts (E) and ten novices (N), for reference only ({}).",
                    study.publishedSource));
  }
  if (std::string note = coverageNote(study); !note.empty()) notes.push_back(std::move(note));
  for (std::string& warning : intervalWarnings(study, false)) notes.push_back(std::move(warning));
  explainMissing(study, false, notes);
  for (const FormReport& report : study.ratings) {
    for (std::string& note : ratingNotes(report)) notes.push_back(std::move(note));
  }
  return notes;
}

}  // namespace calot::analytics
