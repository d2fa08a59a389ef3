// SPDX-License-Identifier: GPL-3.0-or-later
// How the help of commands looks: lines that fit the terminal, and an example for each.
// Suggestions for a command line that cannot be parsed.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace calot::apps {

/// Sets form and examples of the program's help and of all its commands'. After all commands were added.
void formatHelp(CLI::App& app);

/// One line about the first word of a command line that is no command or option where it stands, with the nearest one;
/// else the parser's own message. Ends with the help to look at.
/// @param app after parse() threw `fault`. @param words the command line without the program's name
std::string wrongWord(const CLI::App& app, const std::vector<std::string>& words, const CLI::ParseError& fault);

}  // namespace calot::apps
