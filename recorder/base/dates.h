// SPDX-License-Identifier: GPL-3.0-or-later
// Dates as files hold them: ISO 8601 in UTC, to the second.
#pragma once

#include <string>

namespace calot::recorder {

/// "2026-01-31T23:59:59Z", of a day that there is.
bool isDate(const std::string& text);

/// Now.
std::string presentDate();

}  // namespace calot::recorder
