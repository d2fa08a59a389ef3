// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CLI/App.hpp>

namespace calot::apps {

/// Adds `--help-json`: prints the program's commands and options as JSON, and ends. Manual pages and the completion of
/// shells are made of it (scripts/manual.py), so that they have what the help has. After all other options and
/// commands.
void addHelpJson(CLI::App& app);

}  // namespace calot::apps
