// SPDX-License-Identifier: GPL-3.0-or-later
// Reads tables of text from elsewhere, without trust: RFC 4180, a header line. csv_writer.h writes them.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace calot {

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

/// Numbers of some columns of a long CSV file.
struct CsvNumbers {
  std::vector<std::vector<double>> column;  ///< one for each wanted name; all as long
  std::vector<std::size_t> line;            ///< of each row in the file, from 1
};

/// Reads the wanted columns of a CSV file: a line of names, then one row a line. Cells may have blanks around them,
/// names may stand in double quotes; other columns may hold anything but the delimiter. Locale plays no part.
/// @param file the name that messages use.
/// @param delimiter a comma, a semicolon or a tab.
/// @throws Error (damaged) naming file and line: no names, a name that is wanted and missing or there twice, a row with
/// another number of cells (one that was cut off), a wanted cell that is no finite number, an empty line between rows,
/// no row, more than a million rows.
CsvNumbers readCsvNumbers(std::span<const std::byte> bytes, const std::string& file, char delimiter,
                          std::span<const std::string> wanted);

}  // namespace calot
