// SPDX-License-Identifier: GPL-3.0-or-later
// A table of text from elsewhere, read without trust: RFC 4180, a header line, commas or semicolons.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace calot::analytics {

struct CsvRow {
  std::size_t line = 0;  ///< where it begins, from 1
  std::vector<std::string> cells;
};

struct CsvTable {
  std::string path;      ///< for messages
  char separator = ',';  ///< or ';', with which a number may have a decimal comma (R's write.csv2)
  std::vector<std::string> columns;
  std::vector<CsvRow> rows;  ///< each with as many cells as there are columns

  /// @throws Error (invalid) where there is no such column, or more than one.
  [[nodiscard]] std::size_t column(const std::string& name) const;
  [[nodiscard]] bool has(const std::string& name) const;
};

/// Reads a whole file: UTF-8 with or without a byte order mark, lines ending in LF or CRLF, cells in double quotes
/// where they hold separators, quotes or line breaks. Blanks around a cell without quotes are dropped; empty lines are
/// passed over. Cells are separated by semicolons where the header has some and no comma.
/// @throws Error (damaged), naming file, line and what is wrong.
CsvTable readCsvTable(const std::string& path);

/// The same of text at hand.
CsvTable parseCsvTable(std::string_view text, const std::string& path);

}  // namespace calot::analytics
