// SPDX-License-Identifier: GPL-3.0-or-later
// Where the attempts of a cohort stand in a design: whose, at which occasion, and which number of that person.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "analytics/design/design_data.h"

namespace calot::analytics {

/// What a design knows of an attempt that is analysed.
struct Placed {
  std::size_t person = 0, occasion = 0;
  double order = 1.0;
  bool completed = false;
  double seconds = 0.0;  ///< how long it lasted
};
/// By uuid.
using PlacedAttempts = std::map<std::string, Placed>;

/// Place of a name, which is appended if it is new.
std::size_t positionIn(std::vector<std::string>& names, const std::string& name);

/// Site or arm of an attempt, by the design's `strata`.
std::string stratumOf(const AttemptRow& attempt, const std::string& strata);

/// People, strata, occasions and flow of these attempts. @pre data.groups are those compared @throws Error (refused) as
/// makeStudy() for a participant in two groups or, of the designs with one value each, one with several attempts and no
/// rule.
PlacedAttempts placeAttempts(DesignData& data, const std::vector<const AttemptRow*>& taken, const StudyOptions& options,
                             const DesignChoices& choices, const std::string& name);

}  // namespace calot::analytics
