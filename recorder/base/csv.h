// SPDX-License-Identifier: GPL-3.0-or-later
// Tables of text, RFC 4180 with a header line: read without trust, written with commas and lines ending in LF.
#pragma once

#include <fmt/format.h>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace calot {

struct CsvRow {
  std::size_t line = 0;  ///< where it begins, from 1
  std::vector<std::string> cells;
};

struct CsvTable {
  std::string path;      ///< for messages
  char separator = ',';  ///< or a semicolon or tab, with which a number may have a decimal comma (R's write.csv2)
  std::vector<std::string> columns;
  std::vector<CsvRow> rows;  ///< each with as many cells as there are columns

  /// @throws Error (invalid) where there is no such column, or more than one.
  [[nodiscard]] std::size_t column(const std::string& name) const;
  [[nodiscard]] bool has(const std::string& name) const;
  /// A cell as a number would be written with a decimal point.
  [[nodiscard]] std::string withPoint(std::string cell) const;
};

/// Reads a whole file, as RFC 4180 and spreadsheets have it: UTF-8 or UTF-16, else Latin-1, lines ending in LF or CRLF,
/// cells in double quotes where they hold separators, quotes or line breaks. Blanks around a cell without quotes are
/// dropped; empty lines, lines of empty cells and columns at the end without a name are passed over. Cells are
/// separated by what a first line "sep=;" names, else by commas, semicolons or tabs, whichever the header has most of.
/// @throws Error (damaged), naming file, line and what is wrong.
CsvTable readCsvTable(const std::string& path);

/// The same of text at hand.
CsvTable parseCsvTable(std::string_view text, const std::string& path);

/// A cell of text, quoted where it holds a comma, quote or line break.
std::string csvQuoted(const std::string& text);

/// The same for tables that people open in a spreadsheet: an apostrophe precedes what it would evaluate as a formula.
std::string csvCell(const std::string& text);

/// Such cells, separated by commas, and the end of the line. @pre there is one
std::string csvLine(const std::vector<std::string>& texts);

/// A CSV file that is written value by value. Numbers read back to the same bits; text stands as it is.
class CsvFile {
 public:
  /// @throws Error failure.
  explicit CsvFile(std::filesystem::path path);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  void put(double v) { value("{:.17g}", v); }
  void put(float v) { value("{:.9g}", v); }
  void put(bool v) { value("{}", v ? 1 : 0); }
  template <class T>
  requires std::is_enum_v<T>
  void put(T v) { value("{}", static_cast<unsigned>(v)); }
  void put(const std::string& v) { value("{}", csvQuoted(v)); }
  template <class T>
  requires(std::is_integral_v<T> && !std::is_same_v<T, bool>) void put(T v) { value("{}", v); }

  /// @throws Error failure.
  void endRow();
  /// @throws Error failure.
  void close();

 private:
  template <class... Args>
  void value(fmt::format_string<Args...> format, Args&&... args) {
    if (!first_) line_.push_back(',');
    first_ = false;
    fmt::format_to(std::back_inserter(line_), format, std::forward<Args>(args)...);
  }
  [[noreturn]] void fail() const;

  struct Closer {
    void operator()(std::FILE* f) const { std::fclose(f); }
  };
  std::filesystem::path path_;
  std::unique_ptr<std::FILE, Closer> file_;
  fmt::memory_buffer line_;
  bool first_ = true;
};

}  // namespace calot
