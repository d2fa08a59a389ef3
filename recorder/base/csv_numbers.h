// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace calot::recorder {

/// Numbers of some columns of a CSV file.
struct CsvNumbers {
  std::vector<std::vector<double>> column;  ///< one for each wanted name; all as long
  std::vector<std::size_t> line;            ///< of each row in the file, from 1
};

/// Reads the wanted columns of a CSV file: a line of names, then one row a line. Cells may have blanks around them,
/// names may stand in double quotes; other columns may hold anything but the delimiter. Locale plays no part.
/// @param file the name that messages use.
/// @param delimiter a comma, a semicolon or a tab.
/// @throws Error (damaged) naming file and line: no names, a name that is wanted and missing or there twice, a row with
/// other than so many cells (one that was cut off), a wanted cell that is no finite number, an empty line between rows,
/// no row, more than a million rows.
CsvNumbers readCsvNumbers(std::span<const std::byte> bytes, const std::string& file, char delimiter,
                          std::span<const std::string> wanted);

}  // namespace calot::recorder
