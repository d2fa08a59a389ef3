// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/base/csv_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"

namespace calot::recorder {
namespace {

constexpr std::size_t maxRows = 1000000;
constexpr std::size_t maxColumns = 10000;
constexpr std::size_t maxNamesShown = 12;
constexpr std::string_view byteOrderMark = "\xEF\xBB\xBF";

[[noreturn]] void fail(const std::string& file, std::size_t line, const std::string& fault) {
  throw Error(ErrorKind::damaged, Where{file, fmt::format("line {}", line)}, fault);
}

std::string_view trimmed(std::string_view cell) {
  while (!cell.empty() && (cell.front() == ' ' || cell.front() == '\r')) cell.remove_prefix(1);
  while (!cell.empty() && (cell.back() == ' ' || cell.back() == '\r')) cell.remove_suffix(1);
  return cell;
}

void split(std::string_view line, char delimiter, std::vector<std::string_view>& cells) {
  cells.clear();
  for (;;) {
    const std::size_t end = std::min(line.find(delimiter), line.size());
    cells.push_back(trimmed(line.substr(0, end)));
    if (end == line.size()) return;
    line.remove_prefix(end + 1);
  }
}

std::string_view unquoted(std::string_view name) {
  return name.size() >= 2 && name.front() == '"' && name.back() == '"' ? name.substr(1, name.size() - 2) : name;
}

/// Places of the wanted names in the first line.
std::vector<std::size_t> placesOf(const std::vector<std::string_view>& names, std::span<const std::string> wanted,
                                  const std::string& file) {
  std::vector<std::size_t> places;
  for (const std::string& name : wanted) {
    const auto same = [&](std::string_view cell) { return unquoted(cell) == name; };
    const auto found = std::find_if(names.begin(), names.end(), same);
    if (found == names.end()) {
      std::string there;
      for (std::size_t i = 0; i < std::min(names.size(), maxNamesShown); ++i)
        there += fmt::format("{}{}", i == 0 ? "" : ", ", shown(unquoted(names[i])));
      fail(file, 1,
           fmt::format("no column \"{}\"; there are {}{}", shown(name), there,
                       names.size() > maxNamesShown ? fmt::format(" and {} more", names.size() - maxNamesShown) : ""));
    }
    if (std::find_if(found + 1, names.end(), same) != names.end())
      fail(file, 1, fmt::format("column \"{}\" is there twice", shown(name)));
    places.push_back(static_cast<std::size_t>(found - names.begin()));
  }
  return places;
}

}  // namespace

CsvNumbers readCsvNumbers(std::span<const std::byte> bytes, const std::string& file, char delimiter,
                          std::span<const std::string> wanted) {
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.starts_with(byteOrderMark)) text.remove_prefix(byteOrderMark.size());
  if (text.empty()) throw Error(ErrorKind::damaged, Where{file}, "the file is empty");
  std::vector<std::string_view> cells;
  split(takeLine(text), delimiter, cells);
  if (cells.size() > maxColumns) fail(file, 1, fmt::format("more than {} columns", maxColumns));
  const std::size_t columns = cells.size();
  const std::vector<std::size_t> places = placesOf(cells, wanted, file);

  CsvNumbers numbers;
  numbers.column.resize(wanted.size());
  std::size_t line = 1, blank = 0;
  std::string fault;
  while (!text.empty()) {
    const std::string_view row = takeLine(text);
    ++line;
    if (trimmed(row).empty()) {
      if (blank == 0) blank = line;
      continue;
    }
    // Empty lines may end a file; between rows they could hide missing rows.
    if (blank != 0) fail(file, blank, "an empty line between rows");
    if (numbers.line.size() == maxRows) fail(file, line, fmt::format("more than {} rows", maxRows));
    split(row, delimiter, cells);
    if (cells.size() != columns) {
      fail(file, line, fmt::format("{} cells; the {} columns of line 1 are wanted", cells.size(), columns));
    }
    for (std::size_t i = 0; i < places.size(); ++i) {
      const double value = readFiniteNumber(cells[places[i]], fault);
      if (!fault.empty()) fail(file, line, fmt::format("column \"{}\": {}", shown(wanted[i]), fault));
      numbers.column[i].push_back(value);
    }
    numbers.line.push_back(line);
  }
  if (numbers.line.empty()) throw Error(ErrorKind::damaged, Where{file}, "no row below the names of line 1");
  return numbers;
}

}  // namespace calot::recorder
