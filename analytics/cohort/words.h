// SPDX-License-Identifier: GPL-3.0-or-later
// The words that tables and files use for the recording's enumerations.
#pragma once

#include <string>

#include "recorder/identity.h"
#include "recorder/observer.h"

namespace calot::analytics {

std::string wordFor(recorder::OperatorKind kind);  ///< "human", "kinematics", "performer"
std::string wordFor(recorder::Mode mode);          ///< "practice", "assessment"
std::string wordFor(recorder::Outcome outcome);    ///< "running", "completed", "time limit", ...

}  // namespace calot::analytics
