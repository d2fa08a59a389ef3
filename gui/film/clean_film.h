// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

namespace calot::gui {

/// Copies a film's pictures as they are encoded into a new MP4 file, and nothing else: no title, date, place, name of a
/// device or program, no chapters, and no sound, in which people may be named.
/// @param output does not exist
/// @throws calot::Error: damaged where the film cannot be read or its pictures cannot be in MP4; failure where the file
/// cannot be written. Nothing is left behind then.
void copyCleanFilm(const std::filesystem::path& film, const std::filesystem::path& output);

}  // namespace calot::gui
