// SPDX-License-Identifier: GPL-3.0-or-later
// The recording behind an attempt of a cohort database, which knows its file's name and not its folder.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "analytics/cohort/cohort_database.h"
#include "recorder/recording/probe.h"

namespace calot::gui {

/// The file of this name beside the database, or in one of the folders, in their order; empty where there is none.
std::filesystem::path findRecording(const analytics::AttemptRow& attempt, const std::filesystem::path& database,
                                    const std::vector<std::filesystem::path>& folders);

/// Opens a recording to be shown. A child process reads all of it first, so that a file that breaks the reading library
/// takes no window with it.
/// @param attempt uuid that it must have; empty: any
/// @throws Error as recorder::probe(); (refused) for another attempt's recording or a broken content chain; (damaged)
/// without any step; (undecided) for one of another simulation version, which this program cannot simulate.
recorder::Recording openRecording(const std::filesystem::path& file, const std::string& attempt);

}  // namespace calot::gui
