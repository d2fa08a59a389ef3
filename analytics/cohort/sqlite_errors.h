// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "recorder/base/errors.h"

namespace calot::analytics {

/// An SQLite message, which may quote content of a damaged file, with '?' for non-ASCII characters.
std::string printable(std::string words);

/// One line for the user that explains an SQLite result code and names the file.
Error databaseError(int sqliteCode, const std::string& message, const std::string& path);

}  // namespace calot::analytics
