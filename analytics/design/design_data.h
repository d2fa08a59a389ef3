// SPDX-License-Identifier: GPL-3.0-or-later
// Values of a cohort or a table as a design needs them: by participant, group, stratum and occasion.
// Designs of studies other than two groups with one value per participant: which there are, and what each needs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "analytics/cohort/cohort_database.h"
#include "analytics/report/study.h"
#include "analytics/report/table_study.h"
#include "recorder/base/csv.h"

namespace calot::analytics {

enum class Design : std::uint8_t {
  twoGroups,
  severalGroups,
  strata,
  repeated,
  timeToCriterion,
  learning,
  correlation,
  agreement,
  reliability
};

/// Groups that a design compares.
enum class GroupsNeeded : std::uint8_t {
  none,  ///< groups, where they are named, choose who is in it
  any,   ///< one or more, side by side
  two,
  several  ///< three or more
};

struct DesignEntry {
  Design design;
  const char* name;
  const char* question;  ///< what it asks, without a full stop
  const char* method;    ///< what is computed
  GroupsNeeded groups;
  bool oneEach;  ///< one value per participant
};

/// All designs, in the order of the enumeration.
std::span<const DesignEntry> designs();
const DesignEntry& entryOf(Design design);
/// The design of a name, or none.
std::optional<Design> designOf(std::string_view name);

/// User's declarations for a design, besides those of every study.
struct DesignChoices : StudyChoices {
  Design design = Design::severalGroups;
  std::string strata;               ///< column of a table; of a cohort "site" or "arm"; empty: none
  std::string against;              ///< figure that the others are held against, or empty
  std::string finishedColumn;       ///< of a table: whether the attempt reached its end
  std::optional<double> criterion;  ///< in the figure's display unit; at it one passes
  std::size_t run = 1;              ///< attempts in a row that meet the criterion
  double errorRatio = 1.0;          ///< Deming: variance of the second method's errors over that of the first
};

struct DesignPerson {
  std::string name;
  std::size_t group = 0;    ///< of DesignData::groups; 0 where there are none
  std::size_t stratum = 0;  ///< of DesignData::strata; 0 where there are none
};

/// One attempt's value of a figure.
struct DesignValue {
  std::size_t person = 0;
  std::size_t occasion = 0;  ///< of DesignData::occasions (of a rated figure: DesignFigure::raters)
  double order = 0.0;        ///< among the person's attempts: number from 1, or line of the table
  bool finished = true;
  double value = 0.0;  ///< in the display unit
  bool ended = true;   ///< false: the file ends, and nobody knows whether the attempt would have been finished
};

struct DesignFigure {
  std::string name;  ///< "path-length left"; of a table the column; "rating osats"
  std::string unit;  ///< display unit, or empty
  Direction direction = Direction::none;
  std::vector<DesignValue> values;  ///< those that there are, by person, then by order
};

struct DesignData : AnalysedData {
  std::vector<std::string> head;    ///< device, calibration, versions in words; dates
  std::vector<std::string> groups;  ///< compared; empty: everybody is in one
  std::vector<std::string> strata;  ///< by name; empty: none
  std::vector<std::string> occasions;
  bool numbered = true;      ///< occasions are numbers, one after the other
  std::string occasionWord;  ///< "attempt", "device", or the column
  std::vector<DesignPerson> people;
  std::vector<DesignFigure> figures;
  std::vector<DesignFigure>
      rated;  ///< forms, with the raters in place of occasions: a participant's first rated attempt
  std::vector<std::string> raters;
  std::vector<std::string> attempts;  ///< uuids of a cohort's
};

/// Data of a cohort: attempts as a study takes them (makeStudy()), numbered by start; the stratum is the participant's
/// site or arm, the occasion the attempt's number, of an agreement without `against` the device class. A form's rating
/// is the mean of its items and of its raters, without incomplete forms. @throws Error as makeStudy(), and (refused)
/// where the groups are not those that the design needs.
DesignData cohortDesignData(const CohortDatabase& database, const StudyOptions& options, const DesignChoices& choices);

/// The same of attempts at hand, without ratings, site and arm.
DesignData cohortDesignData(const std::vector<AttemptRow>& attempts, const std::vector<AttemptValue>& values,
                            const StudyOptions& options, const DesignChoices& choices, const std::string& name);

/// Data of a table: as makeTableStudy(); the group's column may be missing where the design compares none, and the
/// stratum and whether an attempt was finished are columns. @throws Error as makeTableStudy().
DesignData tableDesignData(const CsvTable& table, const TableStudyOptions& options, const DesignChoices& choices);

/// Groups of the design among those present: the named ones, or all. @param left what the error says of those excluded
/// @throws Error (invalid) for names that are not different; Error (refused) for a group that is not there, or a number
/// of groups that the design does not take.
std::vector<std::string> groupsOfDesign(const std::map<std::string, std::uint64_t>& present,
                                        const DesignChoices& choices, const std::string& path, const std::string& left);

/// Leaves the figures that `family` names and the one that is held against them, in their order.
/// @throws Error (invalid) for a name that is no figure.
void keepNamedFigures(DesignData& data, const DesignChoices& choices);

/// By person, then by order.
void sortValues(DesignFigure& figure);

/// The values of one participant each: the only one, or the mean. @pre DesignEntry::oneEach was kept by the reader.
struct OneEach {
  std::vector<std::size_t> person;  ///< ascending
  std::vector<double> value;
};
OneEach oneEachOf(const DesignFigure& figure);

/// The values of oneEachOf() by group, as many as DesignData::groups.
std::vector<std::vector<double>> byGroup(const DesignData& data, const OneEach& values);

}  // namespace calot::analytics
