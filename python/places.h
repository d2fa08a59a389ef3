// SPDX-License-Identifier: GPL-3.0-or-later
// Where the module finds assets and engines: beside the programs that it was built or installed with.
#pragma once

#include <filesystem>
#include <vector>

namespace calot::python {

/// Folder of the programs: `bin` of the nearest folder above the module that has engines or assets; empty: none.
std::filesystem::path programFolder();

/// Folders that may hold scenes, organs and performers (recorder::ProgramFiles).
std::vector<std::filesystem::path> assetFolders();

}  // namespace calot::python
