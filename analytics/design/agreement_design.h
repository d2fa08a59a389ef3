// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "analytics/design/design_data.h"

namespace calot::analytics {

/// Values of two figures, value i of both the same participant's.
struct FigurePairs {
  std::vector<double> first, second;
};

/// Pairs of participants who have both values. @pre one value each
FigurePairs pairsOf(const DesignFigure& first, const DesignFigure& second);

/// The figure that others are held against, by its name or its checkpoint's.
/// @throws Error (invalid) where it is none or several.
const DesignFigure& againstOf(const DesignData& data, const std::string& asked);

}  // namespace calot::analytics
