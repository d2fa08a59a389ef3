// SPDX-License-Identifier: GPL-3.0-or-later
// Text of reports: tables for the terminal, numbers, text escaped for HTML, warnings about intervals.
#pragma once

#include <cstddef>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "analytics/statistics/published_coverage.h"

namespace calot::analytics {

/// A text for HTML or SVG, between tags or in a quoted attribute: & < > " ' are escaped, control characters and bytes
/// that are not UTF-8 become U+FFFD.
std::string escaped(std::string_view text);

/// Warning about an interval whose published coverage is low at these sizes: "g: with 40 a group an interval at 95 %
/// covers 92.4 % (population: exponential, 0.8)"; empty where it isn't.
/// @param name as the report calls the interval. @param unit of the sizes: "a group", "attempts", "people".
std::string coverageWarning(CoveredInterval interval, const std::string& name, std::size_t nx, std::size_t ny,
                            const std::string& unit = "a group");

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

/// Bound on accumulated rounding of a zero, in any unit that figures are shown in: an instrument that
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
