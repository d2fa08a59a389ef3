// SPDX-License-Identifier: GPL-3.0-or-later
// Designs of studies other than two groups with one value per participant: which there are, and what each needs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "analytics/report/study.h"

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

}  // namespace calot::analytics
