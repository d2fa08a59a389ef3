// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "analytics/checkpoints/checkpoint.h"

namespace calot::analytics {

/// Every checkpoint that this build knows, in the order in which tables show them: by family, then by rank.
const std::vector<CheckpointEntry>& checkpointRegistry();

/// The definition of a name, or null.
const CheckpointDefinition* findCheckpoint(std::string_view name);

/// The definition that a value stands on: the registry's, or of an external metric its script's; or null. It lives as
/// long as the value.
const CheckpointDefinition* definitionOf(const CheckpointValue& value);

/// The family of a name, or none.
std::optional<CheckpointFamily> familyOf(std::string_view name);

/// Given for each phase of a procedure, not of the whole attempt.
bool isOfPhases(const CheckpointDefinition& definition);
/// Names of those, in the registry's order.
const std::vector<std::string>& phaseCheckpoints();

}  // namespace calot::analytics
