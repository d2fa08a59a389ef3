// SPDX-License-Identifier: GPL-3.0-or-later
// Text that fits the terminal.
#pragma once

#include <cstddef>
#include <string>

namespace calot::apps {

/// Columns of the terminal that stdout is, from 60 to 160; 80 where it is none.
std::size_t terminalColumns();

/// The text in lines of at most `columns`, broken at blanks; its own line breaks stay. Lines below the first begin with
/// `indent` blanks. A longer word has a line of its own.
/// @param used columns that the first line begins with
std::string wrappedText(const std::string& text, std::size_t columns, std::size_t indent = 0, std::size_t used = 0);

}  // namespace calot::apps
