// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <exception>
#include <string>

namespace calot::gui {

/// Words of a window for an error: its message and, where a window's user can do something about it, what.
std::string problemText(const std::exception& error);

}  // namespace calot::gui
