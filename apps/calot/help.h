// SPDX-License-Identifier: GPL-3.0-or-later
// How the help of commands looks: lines that fit the terminal, and an example for each.
#pragma once

#include <CLI/CLI.hpp>

namespace calot::apps {

/// Sets form and examples of the program's help and of all its commands'. After all commands were added.
void dressHelp(CLI::App& app);

}  // namespace calot::apps
