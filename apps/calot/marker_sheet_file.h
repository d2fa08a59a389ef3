// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace calot::apps {

/// `calot devices print`: the sheets of handles and board as PDF.
/// @throws Error: invalid, in a build without Qt, and as writeText does
void writeMarkerSheets(const std::string& file, bool force);

}  // namespace calot::apps
