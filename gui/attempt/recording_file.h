// SPDX-License-Identifier: GPL-3.0-or-later
// Files of recordings for windows: where an attempt's lies, and how it is opened. A child process reads a file before
// this one does, so that a file that breaks the reading library takes no window with it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "analytics/cohort/cohort_database.h"
#include "recorder/recording/reader.h"

namespace calot::gui {

/// The attempt's recording: the file of its name beside the database, or in one of the folders, in their order, that
/// holds this attempt. Where none does, the first one of the name that cannot be read; else empty. Reads the files in
/// child processes: not for an interface's thread.
std::filesystem::path findRecording(const analytics::AttemptRow& attempt, const std::filesystem::path& database,
                                    const std::vector<std::filesystem::path>& folders);

/// True if readThrough() accepted the file as it is now.
bool wasReadThrough(const std::filesystem::path& file);
/// Has a child process read all of the file, unless that was done since the file changed last. @throws Error as
/// recorder::probe(); (refused) for a broken content chain
void readThrough(const std::filesystem::path& file);

/// Opens a recording. Its header, events and first step may be read; the rest once readThrough() has returned.
/// @param attempt uuid that it must have; empty: any
/// @throws Error as recorder::probeBeginning(); (refused) for another attempt's recording; (damaged) without any step;
/// (undecided) for one of another simulation version, which this program cannot simulate.
recorder::Recording openBeginning(const std::filesystem::path& file, const std::string& attempt);
/// Opens a recording; all of it may be read. @throws Error as readThrough() and openBeginning()
recorder::Recording openRecording(const std::filesystem::path& file, const std::string& attempt);

}  // namespace calot::gui
