// SPDX-License-Identifier: GPL-3.0-or-later
// calot devices calibrate: what a device measures like.
#pragma once

#include <CLI/CLI.hpp>

#include "apps/calot/commands.h"

namespace calot::apps {

/// Adds the command below `devices`. @returns it @param run is set to it where it was asked for
CLI::App* addCalibrateDevice(CLI::App& devices, Run& run);

}  // namespace calot::apps
