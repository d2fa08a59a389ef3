// SPDX-License-Identifier: GPL-3.0-or-later
// The verdict on an attempt as its stored figures tell it, in the same sentences everywhere.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <utility>

#include "analytics/checkpoints/checkpoint.h"

namespace calot::analytics {

inline constexpr std::string_view criticalErrors = "critical-errors";

/// The checkpoints that count errors, the gravest first.
const std::array<std::pair<Severity, std::string_view>, severityCount>& errorCheckpoints();

/// "Not safe: cystic duct left open, 1:40.2.", "2 major errors: ...", "Critical errors: not assessed, the scene has no
/// procedure." @param value of the checkpoint of this severity; null: it has none
std::string errorSentence(Severity severity, const CheckpointValue* value);

}  // namespace calot::analytics
