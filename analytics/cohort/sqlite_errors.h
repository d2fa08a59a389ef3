// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "recorder/errors.h"

namespace calot::analytics {

/// Words of SQLite that may quote what stands in a damaged file, with '?' for what is no ASCII letter.
std::string printable(std::string words);

/// What an SQLite result code (with its message) means to who runs the command, as one line that names the file.
Error databaseError(int sqliteCode, const std::string& message, const std::string& path);

}  // namespace calot::analytics
