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
      return {ErrorKind::damaged, Where{path}, "not a cohort database (not an SQLite file)"};
    case SQLITE_CORRUPT:
      return {ErrorKind::damaged, Where{path},
              fmt::format("damaged database ({}); restore a copy, or assess the recordings into a new one", message)};
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return {ErrorKind::failure, Where{path}, "in use by another program; try again when it has finished"};
    case SQLITE_READONLY:
      return {ErrorKind::failure, Where{path}, "can't be written; check the permissions of the file and its folder"};
    case SQLITE_FULL:
      return {ErrorKind::failure, Where{path}, "disk full; nothing was changed, free space and run again"};
    case SQLITE_IOERR:
      return {
          ErrorKind::failure, Where{path},
          fmt::format("reading or writing failed ({}); nothing was changed, check the disk and run again", message)};
    case SQLITE_CANTOPEN:
    case SQLITE_PERM:
    case SQLITE_AUTH:
      return {ErrorKind::failure, Where{path}, "can't be opened; check that the folder exists and the permissions"};
    case SQLITE_ERROR:
      return {ErrorKind::damaged, Where{path},
              fmt::format("its tables are not those of a cohort database ({})", message)};
    default:
      return {ErrorKind::failure, Where{path}, fmt::format("database failure ({})", message)};
  }
}

}  // namespace calot::analytics
