// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/motion_table.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"
#include "recorder/sources/motion_text.h"

namespace calot::recorder {
namespace {

constexpr std::size_t maxTableRows = 1000000;
constexpr std::size_t maxColumns = 10000;
constexpr std::size_t maxNamesShown = 12;

std::string_view trimmed(std::string_view cell) {
  while (!cell.empty() && (cell.front() == ' ' || cell.front() == '\r')) cell.remove_prefix(1);
  while (!cell.empty() && (cell.back() == ' ' || cell.back() == '\r')) cell.remove_suffix(1);
  return cell;
}

/// Words of a line of units below the names, without brackets.
bool isUnit(std::string_view cell) {
  if (cell.size() > 2 && (cell.front() == '[' || cell.front() == '(')) cell = cell.substr(1, cell.size() - 2);
  static constexpr std::array<std::string_view, 14> units{"mm", "m",  "cm",  "inch",    "in",  "s",       "ms",
                                                          "us", "ns", "deg", "degrees", "rad", "seconds", "-"};
  return std::find(units.begin(), units.end(), lowerCase(cell)) != units.end();
}

}  // namespace

bool isMissingWord(std::string_view cell) {
  static constexpr std::array<std::string_view, 20> words{
      "nan",  "-nan", "nan(ind)", "-nan(ind)", "na",   "n/a", "#n/a",     "null",    "none",       "missing",
      "lost", "inf",  "-inf",     "occluded",  "void", "-",   "disabled", "invalid", "out of vol", "not visible"};
  return cell.empty() || std::find(words.begin(), words.end(), lowerCase(cell)) != words.end();
}

void splitCells(std::string_view line, char delimiter, std::vector<std::string_view>& cells) {
  cells.clear();
  const bool quotes = line.find('"') != std::string_view::npos;
  for (;;) {
    std::size_t end = 0;
    if (quotes) {
      const std::size_t start = std::min(line.find_first_not_of(' '), line.size());
      if (start < line.size() && line[start] == '"') end = std::min(line.find('"', start + 1), line.size());
    }
    while (end < line.size() && line[end] != delimiter) ++end;  // cells are too short for find()
    std::string_view cell = trimmed(line.substr(0, end));
    if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"') cell = trimmed(cell.substr(1, cell.size() - 2));
    cells.push_back(cell);
    if (end == line.size()) return;
    line.remove_prefix(end + 1);
  }
}

const std::string& TableHeader::cell(std::size_t line, std::size_t column) const {
  static const std::string none;
  const std::vector<std::string>& cells = lines_[line];
  if (line + 1 == lines_.size() || column < 2) return column < cells.size() ? cells[column] : none;
  for (std::size_t c = std::min(column + 1, cells.size()); c-- > 0;) {
    if (!cells[c].empty()) return cells[c];
  }
  return none;
}

std::vector<std::size_t> TableHeader::find(const std::string& name) const {
  std::vector<std::size_t> found;
  for (std::size_t c = 0; c < columns(); ++c) {
    if (names()[c] == name) found.push_back(c);
  }
  if (!found.empty() || name.find('/') == std::string::npos || lines_.size() < 2) return found;
  std::vector<std::string_view> parts;
  splitCells(name, '/', parts);
  for (std::size_t c = 0; c < columns(); ++c) {
    if (names()[c] != parts.back()) continue;
    std::size_t part = 0;
    for (std::size_t l = 0; l < lines_.size() && part < parts.size(); ++l) {
      if (cell(l, c) == parts[part]) ++part;
    }
    if (part == parts.size()) found.push_back(c);
  }
  return found;
}

MotionTable::MotionTable(std::span<const std::byte> bytes, const std::string& file, const TableStyle& style,
                         std::span<const std::string> wanted)
    : rest_(motionText(bytes, file, style.demonstration, converted_)), file_(file), style_(style) {
  wanted_ = wanted;
  rewritten_ = isRewritten({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  if (rest_.empty()) throw Error(ErrorKind::damaged, Where{file}, "the file is empty");
  const std::string_view text = rest_;
  for (const char delimiter : style.delimiter == '\0' ? std::string(",;\t") : std::string(1, style.delimiter)) {
    if (findNames(text, delimiter, wanted)) return;
  }
  failNames(text, wanted);
}

bool MotionTable::findNames(std::string_view text, char delimiter, std::span<const std::string> wanted) {
  TableHeader header;
  delimiter_ = delimiter;
  for (line_ = 1; line_ <= maxHeaderLines && !text.empty(); ++line_) {
    splitCells(takeLine(text), delimiter, cells_);
    if (cells_.size() > maxColumns) fail(fmt::format("more than {} columns", maxColumns));
    header.add(cells_);
    place_.clear();
    for (const std::string& name : wanted) {
      const std::vector<std::size_t> found = header.find(name);
      if (found.size() != 1) break;
      place_.push_back(found.front());
    }
    if (place_.size() != wanted.size()) continue;
    columns_ = named_ = cells_.size();
    slot_.assign(columns_, noSlot);
    for (std::size_t w = 0; w < place_.size(); ++w) slot_[place_[w]] = w;
    value_.resize(place_.size());
    isNumber_.assign(place_.size(), 0);
    while (named_ > 1 && cells_[named_ - 1].empty()) --named_;
    for (std::size_t i = 0; i < style_.skip; ++i, ++line_) takeLine(text);
    rest_ = text;
    plain_ = style_.missing.empty() && !readsCommas();
    return true;
  }
  return false;
}

void MotionTable::failNames(std::string_view text, std::span<const std::string> wanted) {
  line_ = 1;
  const std::string_view first = takeLine(text);
  if (style_.delimiter == '\0') {
    delimiter_ = ',';
    for (const char other : {';', '\t'}) {
      if (std::count(first.begin(), first.end(), other) > std::count(first.begin(), first.end(), delimiter_))
        delimiter_ = other;
    }
  }
  TableHeader header;
  splitCells(first, delimiter_, cells_);
  header.add(cells_);
  for (const std::string& name : wanted) {
    const std::size_t found = header.find(name).size();
    if (found == 1) continue;
    if (found > 1)
      fail(fmt::format("column \"{}\" is there twice; with the cell above it, \"left/{}\", a map tells them apart",
                       shown(name), shown(name)));
    std::string there;
    for (std::size_t i = 0; i < std::min(cells_.size(), maxNamesShown); ++i)
      there += fmt::format("{}{}", i == 0 ? "" : ", ", shown(cells_[i]));
    if (cells_.size() > maxNamesShown) there += fmt::format(" and {} more", cells_.size() - maxNamesShown);
    fail(fmt::format("no column \"{}\"; there are {} (calot import can guess a map of them)", shown(name), there));
  }
  fail("no line has all names of the map");
}

void MotionTable::fail(const std::string& fault) const {
  constexpr std::size_t head = 2;  // lines of names in front of what was rewritten
  const std::string place =
      rewritten_ ? fmt::format("row {}", std::max(line_, head) - head) : fmt::format("line {}", line_);
  throw Error(ErrorKind::damaged, Where{file_, place}, fault);
}

bool MotionTable::readsCommas() const { return style_.decimal == ',' || (style_.decimal == '\0' && delimiter_ != ','); }

bool MotionTable::isUnits() const {
  bool any = false;
  for (const std::size_t place : place_) {
    if (place >= cells_.size() || cells_[place].empty()) continue;
    if (!isUnit(cells_[place])) return false;
    any = any || cells_[place] != "-";
  }
  return any;
}

void MotionTable::splitRow() {
  const char *const begin = rest_.data(), *const end = begin + rest_.size();
  cells_.clear();
  std::fill(isNumber_.begin(), isNumber_.end(), 0);
  for (const char *at = begin, *cell = begin;; ++at) {
    // A number ends its cell: looking for the separator first would read it twice.
    if (at == cell && cells_.size() < slot_.size() && slot_[cells_.size()] != noSlot) {
      const std::size_t wanted = slot_[cells_.size()];
      const auto [stop, code] = std::from_chars(at, end, value_[wanted]);
      if (code == std::errc() && stop != end && (*stop == delimiter_ || *stop == '\n')) {
        isNumber_[wanted] = 1;
        cells_.emplace_back(cell, static_cast<std::size_t>(stop - cell));
        at = stop;
        cell = stop + 1;
        if (*stop == delimiter_) continue;
        return rest_.remove_prefix(static_cast<std::size_t>(cell - begin));
      }
    }
    const char c = at < end ? *at : '\n';
    if (c == '"') {
      std::fill(isNumber_.begin(), isNumber_.end(), 0);
      return splitCells(takeLine(rest_), delimiter_, cells_);
    }
    if (c != delimiter_ && c != '\n') continue;
    cells_.push_back(trimmed({cell, static_cast<std::size_t>(at - cell)}));
    cell = at + 1;
    if (c == '\n') return rest_.remove_prefix(static_cast<std::size_t>(std::min(cell, end) - begin));
  }
}

std::size_t MotionTable::rowsExpected() const {
  const std::size_t row = std::max<std::size_t>(std::min(rest_.find('\n'), rest_.size()), 1);
  return std::min(rest_.size() / row + 1, maxTableRows);
}

bool MotionTable::next() {
  std::size_t blank = 0;
  while (!rest_.empty()) {
    ++line_;
    splitRow();
    if (std::all_of(cells_.begin(), cells_.end(), [](std::string_view cell) { return cell.empty(); })) {
      if (blank == 0) blank = line_;
      continue;
    }
    if (rows_ == 0 && isUnits()) continue;
    // Empty lines may end a file; between rows they could hide missing rows.
    if (blank != 0) {
      line_ = blank;
      fail("an empty line between rows; a file of several tables has to be cut into files of one");
    }
    if (rows_ == maxTableRows) fail(fmt::format("more than {} rows", maxTableRows));
    const std::size_t cells = cells_.size();
    while (cells_.size() > columns_ && cells_.back().empty()) cells_.pop_back();  // separators that end a line
    if (cells_.size() > columns_ || cells_.size() < named_)
      fail(fmt::format("{} cells; the {} columns of the names are expected", cells, columns_));
    cells_.resize(columns_);
    ++rows_;
    return true;
  }
  return false;
}

MotionTable::Cell MotionTable::number(std::size_t wanted, double& value, std::string& fault) {
  fault.clear();
  if (plainNumber(wanted, value)) return Cell::number;
  const bool commas = readsCommas();
  std::string_view cell = text(wanted);
  if (cell.empty() || std::find(style_.missing.begin(), style_.missing.end(), cell) != style_.missing.end())
    return Cell::missing;
  std::array<char, 64> copy{};
  const std::size_t comma = commas ? cell.find(',') : std::string_view::npos;
  if (commas && comma == std::string_view::npos) {
    point_ = point_ || cell.find('.') != std::string_view::npos;
  } else if (commas && cell.size() <= copy.size() && cell.find('.') == std::string_view::npos) {
    std::copy(cell.begin(), cell.end(), copy.begin());
    copy[comma] = '.';
    cell = {copy.data(), cell.size()};
    comma_ = true;
  }
  if (point_ && comma_ && style_.decimal == '\0') {
    fault = "decimal points and decimal commas in one file: say \"decimal\" in the map";
    return Cell::fault;
  }
  value = readFiniteNumber(cell, fault);
  if (fault.empty()) return std::abs(value) < noNumber ? Cell::number : Cell::missing;
  if (isMissingWord(text(wanted))) return Cell::missing;
  fault += text(wanted).find(',') != std::string_view::npos
               ? "; \"decimal\": \",\" in the map reads commas"
               : "; a word that marks what was not measured belongs in \"missing\" of the map";
  return Cell::fault;
}

}  // namespace calot::recorder
