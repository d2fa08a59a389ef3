// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "analytics/report/drawing.h"
#include "analytics/report/ratings.h"

namespace calot::analytics {

/// Distribution of a form's scores: for each item and group a bar from the lowest to the highest score, with parts
/// proportional to their share and labelled with counts where space permits. One drawing per thirteen items; none for a
/// form that nobody has completed.
std::vector<Drawing> drawScores(const FormReport& form, bool synthetic);

}  // namespace calot::analytics
