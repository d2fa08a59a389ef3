// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

namespace calot::analytics {

/// A table of text with aligned columns for the terminal.
class TextTable {
 public:
  enum class Align { left, right };
  explicit TextTable(std::vector<std::pair<std::string, Align>> columns);
  /// @pre as many cells as columns.
  void add(std::vector<std::string> cells);
  /// Header, rule, rows; columns two blanks apart; columns without cells are left out. Where the table is wider than
  /// `most`, the widest left-aligned columns are made narrower as far as it takes, but not below ten: their cells go on
  /// below, in a line of their own or in an empty cell of the next row, if that begins with an empty cell. Words are
  /// cut ("fat-remaini...") only where that does not suffice, and those of the first column last.
  void print(std::ostream& out, std::size_t most = std::string::npos) const;
  [[nodiscard]] std::size_t rows() const { return rows_.size(); }

 private:
  std::vector<std::pair<std::string, Align>> columns_;
  std::vector<std::vector<std::string>> rows_;
};

/// The beginning of a text of more than `width` letters and three points: `width` in all. @pre width > 3.
std::string cutTo(const std::string& text, std::size_t width);

/// What sums of rounding leave where there was nothing, in any unit that figures are shown in: an instrument that
/// nobody moved has a path of 1e-11 mm.
inline constexpr double arithmeticDust = 1e-9;

/// `digits` significant digits, never in a locale's way, no exponent between 1e-4 and 1e7: "0.0432", "113", "12.5"; "0"
/// below arithmeticDust.
std::string significant(double value, int digits = 4);

/// The same, or "-" where there is none.
std::string significantOrDash(const std::optional<double>& value, int digits = 4);

/// "p" with what a reader may believe: "< 0.0001", "0.0433".
std::string pText(double p);
/// The same, or "-" where there is none.
std::string pOrDash(const std::optional<double>& p);

}  // namespace calot::analytics
