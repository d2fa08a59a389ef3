// SPDX-License-Identifier: GPL-3.0-or-later
// A cohort's attempts as a design needs them: whose, at which occasion, which number of that person, and their figures:
// checkpoints, times to the end, ratings.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "analytics/design/design_data.h"

namespace calot::analytics {

/// Facts about an analysed attempt that a design uses.
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

/// Checkpoints that are outcomes or asked for, in the registry's order. @throws Error (refused) for values of several
/// versions of a checkpoint, unless these are mixed.
void addFigures(DesignData& data, const std::vector<AttemptValue>& values, const PlacedAttempts& placed,
                const StudyOptions& options, const DesignChoices& choices, const std::string& name);

/// The elapsed time alone; an attempt that was not completed is followed as long as it lasted.
void keepTimes(DesignData& data, const std::vector<AttemptValue>& values, const PlacedAttempts& placed);

/// Ratings by a form: mean of its items and of its raters, and of each rater of a participant's first rated attempt.
void addForm(DesignData& data, const RatingForm& form, const std::vector<Rating>& ratings,
             const PlacedAttempts& placed);

}  // namespace calot::analytics
