// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace calot {

/// Changes whenever any golden digest changes on purpose; says why in CHANGELOG.md. A recording of another simulation
/// version cannot be decided by this build (exit code 5).
inline constexpr std::uint32_t simulationVersion = 21;

/// Version of StepResult, and so of /observables.
inline constexpr std::uint32_t stepResultVersion = 7;

}  // namespace calot
