// SPDX-License-Identifier: GPL-3.0-or-later
// How a command is told its cohort database.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace calot::apps {

/// Adds `--cohort`, as every command has that works with one database. It may be given without the option's name, too,
/// as the first word: calot study c.db. Where the command line has the option, all words are other arguments: calot
/// norm show clinic --cohort c.db.
CLI::Option* addCohortOption(CLI::App& command, std::string& database, const std::string& help = "Cohort database");

/// Looks whether a command line has `--cohort`. Before commands are added.
/// @param words the command line without the program's name
void lookForCohort(const std::vector<std::string>& words);

}  // namespace calot::apps
