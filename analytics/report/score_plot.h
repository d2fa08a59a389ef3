// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "analytics/report/drawing.h"
#include "analytics/report/ratings.h"

namespace calot::analytics {

/// How the scores of a form are spread: for each item and group a bar from the least score to the most, each part as
/// wide as its share of the scores given, with how often it was given where there is room. As many drawings as pages
/// of thirteen items; none where nobody has filled the form in.
std::vector<Drawing> drawScores(const FormReport& form, bool synthetic);

}  // namespace calot::analytics
