// SPDX-License-Identifier: GPL-3.0-or-later
// Sheets of markers on paper.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "recorder/sources/devices/camera/marker_sheets.h"

namespace calot::gui {

/// The sheets as a PDF file's bytes, a page each, A4, true to scale.
/// @param cells of a tag with its margin, as recorder::tagCells gives them
/// @throws Error (failure) where no font is installed
std::string sheetsPdf(const std::vector<recorder::MarkerSheet>& sheets, const std::string& maker,
                      const std::function<std::array<bool, 100>(int id)>& cells);

}  // namespace calot::gui
