// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/report/report_text.h"

#include <fmt/format.h>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <sstream>

namespace calot::analytics {
namespace {

unsigned byteAt(std::string_view text, std::size_t i) { return static_cast<unsigned char>(text[i]); }

/// Length of the well-formed sequence of UTF-8 that begins at `i` (Unicode 15, table 3-7), or 0.
std::size_t sequenceAt(std::string_view text, std::size_t i) {
  const unsigned first = byteAt(text, i);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xC2 && first <= 0xDF   ? 2
                             : first >= 0xE0 && first <= 0xEF ? 3
                             : first >= 0xF0 && first <= 0xF4 ? 4
                                                              : 0;
  if (length == 0 || i + length > text.size()) return 0;
  for (std::size_t k = 1; k < length; ++k) {
    if ((byteAt(text, i + k) & 0xC0U) != 0x80U) return 0;
  }
  const unsigned second = byteAt(text, i + 1);
  const bool overlong = (first == 0xE0 && second < 0xA0) || (first == 0xF0 && second < 0x90);
  const bool outside = (first == 0xED && second > 0x9F) || (first == 0xF4 && second > 0x8F);  // surrogates; the end
  return overlong || outside ? 0 : length;
}

}  // namespace

std::string escaped(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = sequenceAt(text, i);
    const unsigned c = byteAt(text, i);
    if (length == 0 || (c < 0x20 && c != '\n' && c != '\t') || c == 0x7F) {
      out += "\xEF\xBF\xBD";
      ++i;
      continue;
    }
    if (c == '&') {
      out += "&amp;";
    } else if (c == '<') {
      out += "&lt;";
    } else if (c == '>') {
      out += "&gt;";
    } else if (c == '"') {
      out += "&quot;";
    } else if (c == '\'') {
      out += "&#39;";
    } else {
      out += text.substr(i, length);
    }
    i += length;
  }
  return out;
}

std::string coverageWarning(CoveredInterval interval, const std::string& name, std::size_t nx, std::size_t ny,
                            const std::string& unit) {
  CoverageDoubt doubt;
  if (!doubtful(interval, nx, ny, doubt)) return {};
  if (!doubt.known) return fmt::format("{}: coverage is not known for fewer than {} {}", name, doubt.size, unit);
  return fmt::format("{}: with {} {} an interval at 95 % covers {} % (population: {})", name, doubt.size, unit,
                     doubt.percent, doubt.population);
}

namespace {

/// Columns on the terminal: code points, so that a degree sign counts once.
std::size_t widthOf(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

constexpr std::size_t narrowest = 10;

/// How far columns are made narrower, one after the other.
enum class Narrowing { wholeWords, othersCut, allCut };

/// With the two blanks before it that a line below has.
std::size_t longestWord(const std::string& text) {
  std::size_t longest = 0;
  std::istringstream words(text);
  bool first = true;
  for (std::string word; words >> word; first = false) longest = std::max(longest, widthOf(word) + (first ? 0 : 2));
  return longest;
}

/// The text broken at blanks into lines, those below the first indented; a word longer than a line is cut.
std::vector<std::string> wrapped(const std::string& text, std::size_t width) {
  if (widthOf(text) <= width) return {text};
  std::vector<std::string> lines;
  std::string line(std::min(text.find_first_not_of(' '), text.size()), ' ');  // what is indented stays so
  bool empty = true;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const std::string longer = empty ? line + word : line + " " + word;
    if (empty || widthOf(longer) <= width) {
      line = cutTo(longer, width);
    } else {
      lines.push_back(line);
      line = cutTo("  " + word, width);
    }
    empty = false;
  }
  lines.push_back(line);
  return lines;
}

}  // namespace

TextTable::TextTable(std::vector<std::pair<std::string, Align>> columns) : columns_(std::move(columns)) {}

void TextTable::add(std::vector<std::string> cells) {
  assert(cells.size() == columns_.size());
  rows_.push_back(std::move(cells));
}

void TextTable::print(std::ostream& out, std::size_t most) const {
  std::vector<std::size_t> width(columns_.size(), 0);
  std::vector<bool> shown(columns_.size(), false);
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    width[c] = widthOf(columns_[c].first);
    for (const auto& row : rows_) {
      width[c] = std::max(width[c], widthOf(row[c]));
      shown[c] = shown[c] || !row[c].empty();
    }
  }
  const auto total = [&] {
    std::size_t sum = 0;
    for (std::size_t c = 0; c < columns_.size(); ++c) sum += shown[c] ? width[c] + (sum == 0 ? 0 : 2) : 0;
    return sum;
  };
  // Words are cut where nothing else helps, and those that say what a row is of last.
  std::vector<std::size_t> wholeWords(columns_.size(), narrowest);
  for (const auto& row : rows_) {
    for (std::size_t c = 0; c < columns_.size(); ++c) wholeWords[c] = std::max(wholeWords[c], longestWord(row[c]));
  }
  for (const Narrowing to : {Narrowing::wholeWords, Narrowing::othersCut, Narrowing::allCut}) {
    while (total() > most) {
      std::size_t widest = columns_.size();
      for (std::size_t c = 0; c < columns_.size(); ++c) {
        const bool whole = to == Narrowing::wholeWords || (to == Narrowing::othersCut && c == 0);
        if (!shown[c] || columns_[c].second != Align::left || width[c] <= (whole ? wholeWords[c] : narrowest)) continue;
        if (widest == columns_.size() || width[c] > width[widest]) widest = c;
      }
      if (widest == columns_.size()) break;
      --width[widest];
    }
  }
  const auto line = [&](const auto& cell, char fill) {
    std::string text;
    bool first = true;
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      if (!shown[c]) continue;
      if (!first) text += "  ";
      first = false;
      const std::string content = cutTo(cell(c), width[c]);
      const std::string padding(width[c] - std::min(width[c], widthOf(content)), fill);
      text += columns_[c].second == Align::left ? content + padding : padding + content;
    }
    text.erase(text.find_last_not_of(' ') + 1);
    out << text << '\n';
  };
  line([&](std::size_t c) { return columns_[c].first; }, ' ');
  line([](std::size_t) { return std::string(); }, '-');
  // What is left of cells that are too wide goes on below: in the next row where that belongs to this one (its first
  // cell is empty) and has an empty cell there, else in a line of its own.
  std::vector<std::vector<std::string>> rest(columns_.size());
  const auto takeRest = [&](std::size_t c) {
    if (rest[c].empty()) return std::string();
    std::string text = rest[c].front();
    rest[c].erase(rest[c].begin());
    return text;
  };
  const auto printRest = [&](const auto& wanted) {
    const auto left = [&](std::size_t c) { return !rest[c].empty() && wanted(c); };
    for (bool any = true; any;) {
      any = false;
      for (std::size_t c = 0; c < columns_.size(); ++c) any = any || left(c);
      if (any) line([&](std::size_t c) { return left(c) ? takeRest(c) : std::string(); }, ' ');
    }
  };
  for (const auto& row : rows_) {
    printRest([&](std::size_t c) { return !row[0].empty() || !row[c].empty(); });
    line(
        [&](std::size_t c) {
          if (row[c].empty() || columns_[c].second != Align::left) return row[c].empty() ? takeRest(c) : row[c];
          rest[c] = wrapped(row[c], width[c]);
          return takeRest(c);
        },
        ' ');
  }
  printRest([](std::size_t) { return true; });
}

std::string cutTo(const std::string& text, std::size_t width) {
  if (widthOf(text) <= width) return text;
  std::size_t end = 0;
  for (std::size_t seen = 0; end < text.size(); ++end) {
    if ((static_cast<unsigned char>(text[end]) & 0xC0U) != 0x80U && seen++ == width - 3) break;
  }
  return text.substr(0, end) + "...";
}

std::string significant(double value, int digits) {
  if (!std::isfinite(value)) return "-";
  const double size = std::abs(value);
  if (size < arithmeticDust) return "0";
  if (size < 1e-4 || size >= 1e7) return fmt::format("{:.{}e}", value, digits - 1);
  const int magnitude = static_cast<int>(std::floor(std::log10(size)));
  return fmt::format("{:.{}f}", value, std::clamp(digits - 1 - magnitude, 0, 8));
}

std::string pText(double p) { return p < 0.0001 ? "<0.0001" : fmt::format("{:.4f}", p); }

std::string significantOrDash(const std::optional<double>& value, int digits) {
  return value ? significant(*value, digits) : "-";
}

std::string pOrDash(const std::optional<double>& p) { return p ? pText(*p) : "-"; }

}  // namespace calot::analytics
