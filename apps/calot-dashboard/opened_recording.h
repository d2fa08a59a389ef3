// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace calot::apps {

/// A recording that the dashboard is to show, as a file manager hands it over.
struct OpenedRecording {
  std::filesystem::path file;
  std::string attempt;  ///< its uuid
};

/// @return none where the file does not begin as a recording does: then it may be a cohort
/// @throws Error as recorder::probe()
std::optional<OpenedRecording> openedRecording(const std::filesystem::path& file);

/// The cohort that takes recordings which are opened by themselves: `calot/opened.db` in the user's data folder, which
/// is made where it is missing. @throws Error (failure) where there can be none
std::filesystem::path openedCohort();

}  // namespace calot::apps
