// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "sim/contact/broad_phase.h"

namespace calot::apps {

/// `--broad-phase grid|bullet`: which broad phase computes the steps. Recordings and results are the same bits.
CLI::Option* addBroadPhase(CLI::App& command, std::string& name);

/// @param name as the option has it @return null: SortedGrid
/// @throws Error (invalid) where this build has no Bullet
MakeBroadPhase broadPhaseOf(const std::string& name);

}  // namespace calot::apps
