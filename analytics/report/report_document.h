// SPDX-License-Identifier: GPL-3.0-or-later
// A report as an ordered list of parts, shown identically on a terminal (terminal_text.h), by a page (pageHtml()) and
// on paper (gui/report); and text of reports: tables, numbers, text escaped for HTML, warnings about intervals.
#pragma once

#include <cstddef>
#include <optional>
#include <ostream>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "analytics/report/drawing.h"
#include "analytics/statistics/published_coverage.h"

namespace calot::analytics {

/// A text for HTML or SVG, between tags or in a quoted attribute: & < > " ' are escaped, control characters and bytes
/// that are not UTF-8 become U+FFFD.
std::string escaped(std::string_view text);

/// Warning about an interval whose published coverage is low at these sizes: "g: with 40 in a group an interval at 95 %
/// covers 92.4 % (population: exponential, 0.8)"; empty where it isn't.
/// @param name as the report calls the interval. @param unit of the sizes: "in a group", "attempts", "people".
std::string coverageWarning(CoveredInterval interval, const std::string& name, std::size_t nx, std::size_t ny,
                            const std::string& unit = "in a group");

enum class Align { left, right };

struct ReportTable {
  std::string title;
  std::vector<std::pair<std::string, Align>> columns;
  std::vector<std::vector<std::string>> rows;
  /// Titles of the columns that a narrow terminal leaves out first, in that order.
  std::vector<std::string> leastNeeded = {};

  /// Without the title: header, rule, rows; columns two blanks apart; columns without cells are left out. Where the
  /// table is wider than `most`, the widest left-aligned columns are made narrower as far as it takes, but not below
  /// ten: their cells go on below, in a line of their own or in an empty cell of the next row, if that begins with an
  /// empty cell. Words are cut ("fat-remaini...") only where that does not suffice, and those of the first column last.
  ///
  /// On a terminal (setTerminalColumns()), whose columns then count in place of `most`, whole columns are left out
  /// before a word is cut: leastNeeded in its order, then the others from the right. The first column stays, and the
  /// first two as far as leastNeeded does not name the second. A line below names them. Numbers are never wrapped.
  void print(std::ostream& out, std::size_t most = std::string::npos) const;
};

/// A table without rows. @param columns aligned to the right, as numbers are; "=" before a title: to the left
ReportTable tableOf(const std::string& title, const std::vector<std::string>& columns);

/// Leaves out columns of which every cell is empty.
void dropEmptyColumns(ReportTable& table);

/// Columns that a text takes: its code points, so that a degree sign counts once.
std::size_t columnsOf(const std::string& text);

/// The beginning of a text of more than `width` letters and three points: `width` in all. @pre width > 3.
std::string cutTo(const std::string& text, std::size_t width);

/// Bound on accumulated rounding of a zero, in any unit that figures are shown in: an instrument that
/// nobody moved has a path of 1e-11 mm.
inline constexpr double arithmeticDust = 1e-9;

/// `digits` significant digits, never in a locale's way, no exponent between 1e-4 and 1e7: "0.0432", "113", "12.5"; "0"
/// below arithmeticDust.
std::string significant(double value, int digits = 4);

/// The same, or "-" for a missing value.
std::string significantOrDash(const std::optional<double>& value, int digits = 4);

/// "p" with what a reader may believe: "< 0.0001", "0.0433".
std::string pText(double p);

struct TextSpan {
  std::string text;
  std::string link;  ///< where it leads, or empty
};
using Paragraph = std::vector<TextSpan>;

struct Heading {
  std::string text;
  bool newPage = false;  ///< begins a page where the report is printed
};
struct BulletList {
  std::vector<Paragraph> items;
};
struct Figures {
  std::vector<Drawing> drawings;
};
struct Picture {
  std::string png;  ///< a file's bytes
  std::string caption;
};
/// Side by side, three a line.
struct Pictures {
  std::vector<Picture> pictures;
};
/// An empty box to write in; on a terminal nothing.
struct Blank {
  std::string label;
  double millimetres = 0.0;  ///< height
};

struct ReportDocument {
  std::string title;
  bool synthetic = false;  ///< watermarked: performers' figures are in it
  std::vector<std::variant<Heading, Paragraph, BulletList, ReportTable, Figures, Pictures, Blank>> parts;

  void add(std::string paragraph) { parts.emplace_back(Paragraph{{std::move(paragraph), {}}}); }
  void addList(const std::vector<std::string>& items) {
    BulletList list;
    for (const std::string& item : items) list.items.push_back({{item, {}}});
    parts.emplace_back(std::move(list));
  }
};

/// Watermark of everything that contains performers' figures.
inline constexpr const char* watermarkText = "SYNTHETIC: made by performers, says nothing about people";

/// A recording that a page carries as data, for calot-page.html to open (docs/how-to/page.md).
struct CarriedRecording {
  std::string name;  ///< of the file
  std::span<const std::byte> bytes;
};

/// One page that needs nothing else: no scripts, one style, figures inline, every text escaped; watermarked where the
/// report is synthetic. @param recording null: none
std::string pageHtml(const ReportDocument& document, const CarriedRecording* recording = nullptr);

}  // namespace calot::analytics
