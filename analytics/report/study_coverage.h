// SPDX-License-Identifier: GPL-3.0-or-later
// Coverage by samples of the attempts that a study compares. Where one group's tracker lost more than the other's, a
// difference in figures of motion may be one of measurement.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "analytics/report/report_document.h"
#include "analytics/report/study.h"

namespace calot::analytics {

/// Collects coverage (CheckpointValue::coverage) of values, with and without a number.
class CoverageCollector {
 public:
  /// @param group 0 or 1. @param attempt uuid
  void add(const CheckpointValue& value, std::size_t group, const std::string& participant, const std::string& attempt);

  /// One row for each subject, in the order in which they came.
  [[nodiscard]] std::vector<CoverageRow> rows() const;

 private:
  struct Subject {
    std::string name;
    /// Participants to attempts to shares; all checkpoints of a subject have the same.
    std::array<std::map<std::string, std::map<std::string, double>>, 2> share;
    std::array<std::map<std::string, bool>, 2> below;
  };
  std::vector<Subject> subjects_;
};

/// The row that a figure of motion must be read with, or null: it isn't one of samples.
const CoverageRow* coverageOf(const Study& study, const StudyRow& row);

/// Coverage differs between the groups: p of the rank test at most `level`.
bool coverageDiffers(const CoverageRow& row, double level = 0.05);

/// One row a group of every subject whose samples don't cover everything; empty where all do.
ReportTable coverageTable(const Study& study);

/// How coverage is counted, or that it is whole; empty without samples.
std::string coverageNote(const Study& study);
/// A warning for each subject of which coverage differs between the groups.
std::vector<std::string> coverageWarnings(const Study& study);

}  // namespace calot::analytics
