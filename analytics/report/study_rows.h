// SPDX-License-Identifier: GPL-3.0-or-later
// From the values of two groups to a study's rows, common to cohorts and tables.
// Coverage by samples of the attempts that a study compares. Where one group's tracker lost more than the other's, a
// difference in figures of motion may be one of measurement.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "analytics/report/report_document.h"
#include "analytics/report/study.h"

namespace calot::analytics {

/// A row that `family` names.
bool isNamed(const StudyRow& row, const std::vector<std::string>& family);

/// The value in SI, or 0 where a checkpoint of the program shows less than arithmeticDust: rounding has neither a rank
/// nor a pass mark. @param factor to the display unit
inline double withoutDust(const CheckpointValue& value, double factor) {
  const double v = value.value.value_or(0.0);
  return !value.metric && std::abs(v * factor) < arithmeticDust ? 0.0 : v;
}

/// One value of a participant's attempt.
struct StudyValue {
  std::string participant;
  std::size_t attempt = 0;          ///< number within the study, by time
  double value = 0.0;               ///< in the display unit
  std::vector<double> worlds = {};  ///< ValueInterval::worlds(), in the display unit; empty: none
  double halfWidth = 0.0;           ///< of the interval
};

/// Reason why an attempt has no value.
struct MissingValue {
  Availability kind = Availability::notAvailable;
  std::string reason;
};

/// One row's values by group.
struct StudySample {
  std::array<std::vector<StudyValue>, 2> values;
  /// Participants to attempts without a value.
  std::array<std::map<std::string, std::vector<MissingValue>>, 2> missing;
  /// Participants who have no value of an attempt that was not finished, where the protocol ranks them behind all.
  std::array<std::set<std::string>, 2> unfinished;
  std::array<std::set<std::string>, 2> partOfTask;  ///< participants with a value of an attempt that was not finished
};

/// One value per participant: `row`'s participants, values and summaries. @pre a participant with several values is
/// meant to have their mean.
void fillRow(StudyRow& row, const StudySample& sample);

/// Compares nothing for a figure that is not an outcome, or one of samples of unlike trackers (CoverageRow::refusal).
/// Tests, effects and intervals of the available values, in the direction of the row's hypothesis or, without one, of
/// the row. Participants ranked behind all enter test, A and delta; shift and g use values only.
/// @param duration participants' durations by group, empty where they are not known
void compareGroups(StudyRow& row, const Study& study, const std::array<std::map<std::string, double>, 2>& duration);

/// Summary of the simulation's intervals for the row, where values have them.
void addSimulationRange(StudyRow& row, const StudySample& sample);

/// Adjusts over the family of the protocol, or without one of the choices (of a table all outcomes), says which it is,
/// decides which rows lead, and which intervals need a warning.
/// @throws Error (invalid) where a name of `choices.family` is no row.
void finishRows(Study& study, const StudyChoices& choices, const Protocol* protocol = nullptr);

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
    /// Participants to attempts to coverage, rate and noise; all checkpoints of a subject have the same.
    std::array<std::map<std::string, std::map<std::string, std::array<std::optional<double>, 3>>>, 2> sampled;
    std::array<std::map<std::string, bool>, 2> below;
  };
  std::vector<Subject> subjects_;
};

/// The row that a figure of motion must be read with, or null: it isn't one of samples.
const CoverageRow* coverageOf(const Study& study, const StudyRow& row);

/// Coverage differs between the groups: p of the rank test at most `level`.
bool coverageDiffers(const CoverageRow& row, double level = 0.05);
/// The same of coverage, rate or noise; or their medians lie too far apart (trackersApart()).
bool samplingDiffers(const Study& study, const CoverageRow& row, double level = 0.05);

/// Rates above the grid's count as the grid's, noise below this (m) as this.
inline constexpr double minNoise = 1e-4;
/// Ratios of the groups' median rates and median noises above which figures of motion are not compared.
inline constexpr double maxRateRatio = 1.25, maxNoiseRatio = 1.5;
/// "the trackers are not alike: median rate 100.0 Hz in expert, 30.0 Hz in novice"; empty where they are.
std::string trackersApart(const Study& study, const CoverageRow& row);

/// Lowest and highest rate and noise of the values of a design that is no comparison of two groups.
class TrackerSpread {
 public:
  void add(const CheckpointValue& value);
  /// A warning where they lie too far apart; else empty.
  [[nodiscard]] std::string warning() const;

 private:
  std::array<std::optional<double>, 2> rate_, noise_;  ///< least, most
};

/// One row a group of every subject whose samples don't cover everything, or whose trackers differ; empty where all are
/// whole and alike.
ReportTable coverageTable(const Study& study);

/// How coverage is counted, or that it is whole; empty without samples.
std::string coverageNote(const Study& study);
/// A warning for each subject whose coverage, rate or noise differs between the groups.
std::vector<std::string> coverageWarnings(const Study& study);

}  // namespace calot::analytics
