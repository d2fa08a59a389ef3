// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace calot::analytics {

/// A cell by RFC 4180. One that a spreadsheet would take for a formula gets an apostrophe before it; numbers are
/// written without this.
std::string csvCell(const std::string& text);

/// Cells of texts, apart by commas, and the end of the line. @pre there is one
std::string csvLine(const std::vector<std::string>& texts);

}  // namespace calot::analytics
