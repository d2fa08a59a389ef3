// SPDX-License-Identifier: GPL-3.0-or-later
// Figures of a cohort's attempts as a design needs them: checkpoints, times to the end, ratings.
#pragma once

#include <string>
#include <vector>

#include "analytics/design/placed_attempts.h"

namespace calot::analytics {

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
