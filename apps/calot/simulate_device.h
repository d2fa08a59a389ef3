// SPDX-License-Identifier: GPL-3.0-or-later
// calot devices simulate: the reference server of the protocol of force devices.
#pragma once

#include <CLI/CLI.hpp>

#include "apps/calot/commands.h"

namespace calot::apps {

/// Adds the command below `devices`. @returns it @param run is set to it where it was asked for
CLI::App* addSimulateDevice(CLI::App& devices, Run& run);

}  // namespace calot::apps
