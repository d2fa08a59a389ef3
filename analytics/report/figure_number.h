// SPDX-License-Identifier: GPL-3.0-or-later
// How values of a checkpoint are written for people: the one rule of terminal, sheets, pages and windows.
#pragma once

#include <string>

#include "analytics/checkpoints/definition.h"

namespace calot::analytics {

/// A count is written whole ("2"), and so are a median or a pass mark of counts that are whole numbers. All else has
/// significant digits: a length, and a mean of counts ("2.333"). The rule is of each number, so a window may write it
/// in its own locale.
/// @param definition null: not known; its values are no counts. @param shown in the unit that the checkpoint displays
bool isWrittenWhole(const CheckpointDefinition* definition, double shown);

/// The number by that rule, with a point whatever the locale; significant() where it is not whole.
std::string figureNumber(const CheckpointDefinition* definition, double shown, int digits = 4);

/// The definition of a figure by its name in tables, "movements left"; null: no checkpoint's.
const CheckpointDefinition* definitionOfFigure(const std::string& name);

}  // namespace calot::analytics
