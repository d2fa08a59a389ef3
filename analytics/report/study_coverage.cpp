// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/study_coverage.h"

#include <fmt/format.h>

#include <algorithm>

#include "analytics/report/study_output.h"
#include "analytics/statistics/descriptive.h"

namespace calot::analytics {
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
