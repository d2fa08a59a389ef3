// SPDX-License-Identifier: GPL-3.0-or-later
// Long tables of motion as trackers and spreadsheets write them, read row by row without trust.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace calot::recorder {

/// Lines in front of the first row that may hold names.
inline constexpr std::size_t maxHeaderLines = 40;
/// Words that say that a cell was not measured, in small letters; an empty cell is one, too.
bool isMissingWord(std::string_view cell);

/// Cells of a line, without blanks around them and without their quotes.
void splitCells(std::string_view line, char delimiter, std::vector<std::string_view>& cells);

/// Header of a table: cells of its lines down to the names. Cells above the names hold for the columns up to the next.
class TableHeader {
 public:
  void add(const std::vector<std::string_view>& cells) { lines_.emplace_back(cells.begin(), cells.end()); }
  [[nodiscard]] std::size_t lines() const { return lines_.size(); }
  [[nodiscard]] std::size_t columns() const { return lines_.empty() ? 0 : lines_.back().size(); }
  [[nodiscard]] const std::vector<std::string>& names() const { return lines_.back(); }
  /// A cell, or the nearest one to its left where it is empty above the names.
  [[nodiscard]] const std::string& cell(std::size_t line, std::size_t column) const;
  /// Columns of a name: the name itself, or cells from above to below with slashes between ("left/Position/X").
  [[nodiscard]] std::vector<std::size_t> find(const std::string& name) const;

 private:
  std::vector<std::vector<std::string>> lines_;
};

struct TableStyle {
  char delimiter = '\0';             ///< '\0': comma, semicolon or tab, whichever the names stand between
  char decimal = '\0';               ///< '\0': a point; or a comma, where cells are separated otherwise
  std::uint32_t skip = 0;            ///< lines below the names that are no rows
  std::vector<std::string> missing;  ///< further words or numbers that mark what was not measured
  std::string demonstration;         ///< of a file that has several
};

/// Rows of a table, one after the other.
class MotionTable {
 public:
  enum class Cell { number, missing, fault };

  /// Finds the line of names. The bytes, `file` and `wanted` outlive the table. @param wanted names of columns
  /// @throws Error (damaged) naming file and line: no such column, or more than one
  MotionTable(std::span<const std::byte> bytes, const std::string& file, const TableStyle& style,
              std::span<const std::string> wanted);

  /// @return false at the end. @throws Error (damaged): another number of cells, an empty line between rows
  bool next();
  [[nodiscard]] std::size_t line() const { return line_; }
  /// Rows to come, at most, by the length of the first one.
  [[nodiscard]] std::size_t rowsExpected() const;
  /// Text of a wanted column in this row.
  [[nodiscard]] std::string_view text(std::size_t wanted) const { return cells_[place_[wanted]]; }
  [[nodiscard]] const std::string& name(std::size_t wanted) const { return wanted_[wanted]; }
  /// Reads what most cells are: a number in the table's own form. @return false: number() says what it is
  [[nodiscard]] bool plainNumber(std::size_t wanted, double& value) const {
    value = value_[wanted];
    return plain_ && isNumber_[wanted] != 0 && std::abs(value) < noNumber;
  }
  /// @param[out] fault of a cell that is neither a number nor marked as missing
  Cell number(std::size_t wanted, double& value, std::string& fault);
  [[noreturn]] void fail(const std::string& fault) const;

 private:
  /// Trackers' own marks of a bad number lie beyond it (NDI: -3.7e28).
  static constexpr double noNumber = 1e20;

  bool findNames(std::string_view text, char delimiter, std::span<const std::string> wanted);
  [[noreturn]] void failNames(std::string_view text, std::span<const std::string> wanted);
  /// Takes the next line and its cells.
  void splitRow();
  [[nodiscard]] bool isUnits() const;
  [[nodiscard]] bool readsCommas() const;

  std::string converted_;
  std::span<const std::string> wanted_;
  std::string_view rest_;
  const std::string& file_;
  const TableStyle& style_;
  char delimiter_ = ',';
  std::size_t columns_ = 0, named_ = 0, line_ = 0, rows_ = 0;
  std::vector<std::size_t> place_;
  std::vector<std::string_view> cells_;
  static constexpr std::size_t noSlot = static_cast<std::size_t>(-1);
  std::vector<std::size_t> slot_;  ///< wanted column that each is
  std::vector<double> value_;      ///< of wanted columns that are numbers followed by the separator
  std::vector<char> isNumber_;
  bool plain_ = false;                  ///< no words and no commas stand for numbers
  bool rewritten_ = false;              ///< rows are no lines of the file
  bool point_ = false, comma_ = false;  ///< decimal ones that were found
};

}  // namespace calot::recorder
