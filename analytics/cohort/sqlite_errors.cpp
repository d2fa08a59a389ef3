// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/cohort/sqlite_errors.h"

#include <fmt/format.h>
#include <sqlite3.h>

namespace calot::analytics {

std::string printable(std::string words) {
  for (char& c : words) {
    if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) >= 0x7F) c = '?';
  }
  return words;
}

Error databaseError(int sqliteCode, const std::string& words, const std::string& path) {
  const std::string message = printable(words);
  switch (sqliteCode & 0xFF) {
    case SQLITE_NOTADB:
      return {ExitCode::damaged, fmt::format("{}: not a cohort database (not an SQLite file)", path)};
    case SQLITE_CORRUPT:
      return {ExitCode::damaged,
              fmt::format("{}: damaged database ({}); restore a copy, or assess the recordings into a new one", path,
                          message)};
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return {ExitCode::failure, fmt::format("{}: in use by another program; try again when it has finished", path)};
    case SQLITE_READONLY:
      return {ExitCode::failure,
              fmt::format("{}: can't be written; check the permissions of the file and its folder", path)};
    case SQLITE_FULL:
      return {ExitCode::failure, fmt::format("{}: disk full; nothing was changed, free space and run again", path)};
    case SQLITE_IOERR:
      return {ExitCode::failure,
              fmt::format("{}: reading or writing failed ({}); nothing was changed, check the disk and run again", path,
                          message)};
    case SQLITE_CANTOPEN:
    case SQLITE_PERM:
    case SQLITE_AUTH:
      return {ExitCode::failure,
              fmt::format("{}: can't be opened; check that the folder exists and the permissions", path)};
    case SQLITE_ERROR:
      return {ExitCode::damaged, fmt::format("{}: its tables are not those of a cohort database ({})", path, message)};
    default:
      return {ExitCode::failure, fmt::format("{}: database failure ({})", path, message)};
  }
}

}  // namespace calot::analytics
