// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/base/csv.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <span>
#include <string_view>
#include <system_error>

#include "recorder/base/errors.h"
#include "recorder/base/files.h"
#include "recorder/base/text_words.h"

namespace calot {
namespace {

constexpr std::size_t maxTableBytes = std::size_t{64} << 20U;

char separatorOf(std::string_view header) {
  constexpr std::string_view separators = "\t,;";
  std::array<std::ptrdiff_t, separators.size()> found{};
  bool quoted = false;
  for (const char c : header) {
    if (c == '"') quoted = !quoted;
    if (const std::size_t at = separators.find(c); !quoted && at != std::string_view::npos) ++found[at];
  }
  const auto most = std::max_element(found.begin(), found.end());
  return *most == 0 ? ',' : separators[static_cast<std::size_t>(most - found.begin())];
}

[[noreturn]] void fail(const std::string& path, std::size_t line, const std::string& what) {
  throw Error(ErrorKind::damaged, Where{path, fmt::format("line {}", line)}, what);
}

/// Takes records off a text, one after the other.
class Records {
 public:
  Records(std::string_view text, const std::string& path, char separator, std::size_t line)
      : rest_(text),
        path_(path),
        separator_(separator),
        ends_{separator, '\n'},
        blanks_(separator == '\t' ? " " : " \t"),
        line_(line) {}

  /// Empty cells behind the columns, which nobody wrote, are dropped. @param columns 0: of a header
  /// @return false at the end
  bool next(CsvRow& row, std::size_t columns) {
    while (!rest_.empty()) {
      row.line = line_;
      row.cells.clear();
      std::size_t quoted = 0;
      while (takeCell(row, quoted)) {
      }
      while (row.cells.size() > std::max(columns, quoted) && row.cells.back().empty()) row.cells.pop_back();
      if (quoted > 0 || std::any_of(row.cells.begin(), row.cells.end(), [](const auto& cell) { return !cell.empty(); }))
        return true;
    }
    return false;
  }

 private:
  [[nodiscard]] std::string_view trimmed(std::string_view cell) const {
    const std::size_t first = cell.find_first_not_of(blanks_);
    if (first == std::string_view::npos) return {};
    return cell.substr(first, cell.find_last_not_of(blanks_) - first + 1);
  }

  /// @param[out] quoted how many cells there are up to the last one in quotes
  /// @return whether another cell of this record follows
  bool takeCell(CsvRow& row, std::size_t& quoted) {
    const std::size_t start = std::min(rest_.find_first_not_of(blanks_), rest_.size());
    if (start < rest_.size() && rest_[start] == '"') {
      rest_.remove_prefix(start + 1);
      row.cells.push_back(takeQuoted(row.line));
      quoted = row.cells.size();
      rest_.remove_prefix(std::min(rest_.find_first_not_of(blanks_), rest_.size()));
      if (!rest_.empty() && rest_[0] != separator_ && rest_[0] != '\n' && rest_.substr(0, 2) != "\r\n")
        fail(path_, line_, fmt::format("column {}: text behind a closing quote", row.cells.size()));
    } else {
      const std::size_t end = std::min(rest_.find_first_of(ends_), rest_.size());
      std::string_view cell = rest_.substr(0, end);
      rest_.remove_prefix(end);
      if (!cell.empty() && cell.back() == '\r' && (rest_.empty() || rest_[0] == '\n')) cell.remove_suffix(1);
      row.cells.emplace_back(trimmed(cell));
    }
    if (rest_.substr(0, 2) == "\r\n") rest_.remove_prefix(1);
    if (rest_.empty()) return false;
    const bool more = rest_[0] == separator_;
    if (!more) ++line_;
    rest_.remove_prefix(1);
    if (more && rest_.empty()) row.cells.emplace_back();
    return more && !rest_.empty();
  }

  std::string takeQuoted(std::size_t begun) {
    std::string cell;
    while (!rest_.empty()) {
      const char c = rest_[0];
      rest_.remove_prefix(1);
      if (c == '"') {
        if (rest_.empty() || rest_[0] != '"') return cell;
        rest_.remove_prefix(1);
      }
      if (c == '\n') ++line_;
      cell += c;
    }
    fail(path_, begun, "a quote is opened and never closed");
  }

  std::string_view rest_;
  const std::string& path_;
  char separator_;
  std::string ends_, blanks_;  ///< of and around a cell without quotes
  std::size_t line_;
};

}  // namespace

bool CsvTable::has(const std::string& name) const {
  return std::find(columns.begin(), columns.end(), name) != columns.end();
}

std::size_t CsvTable::column(const std::string& name) const {
  const auto at = std::find(columns.begin(), columns.end(), name);
  if (at == columns.end()) {
    std::string list;
    for (const std::string& c : columns) list += (list.empty() ? "" : ", ") + recorder::shown(c);
    throw Error(ErrorKind::invalid, Where{path, "line 1"},
                fmt::format("there is no column \"{}\"{} (there are: {})", recorder::shown(name),
                            recorder::didYouMean(name, columns), list));
  }
  if (std::find(at + 1, columns.end(), name) != columns.end()) {
    throw Error(ErrorKind::invalid, Where{path, "line 1"},
                fmt::format("two columns are called \"{}\"; rename one", recorder::shown(name)));
  }
  return static_cast<std::size_t>(at - columns.begin());
}

std::string CsvTable::withPoint(std::string cell) const {
  if (separator != ',' && std::count(cell.begin(), cell.end(), ',') == 1 && cell.find('.') == std::string::npos)
    cell[cell.find(',')] = '.';
  return cell;
}

CsvTable parseCsvTable(std::string_view text, const std::string& path) {
  std::string converted;
  text = recorder::decodedText(std::as_bytes(std::span(text)), converted);
  if (text.find('\0') != std::string_view::npos)
    throw Error(ErrorKind::damaged, Where{path}, "is not a table of text; a spreadsheet saves one as CSV");
  CsvTable table;
  table.path = path;
  std::size_t line = 1;
  std::string_view rest = text, first = recorder::takeLine(rest);
  while (!first.empty() && (first.back() == '\r' || first.back() == '"')) first.remove_suffix(1);
  if (first.starts_with('"')) first.remove_prefix(1);
  if (first.size() == 5 && recorder::lowerCase(first).starts_with("sep=")) {
    table.separator = first.back();
    text = rest;
    ++line;
  } else {
    table.separator = separatorOf(text.substr(0, text.find('\n')));
  }
  Records records(text, path, table.separator, line);
  CsvRow row;
  if (!records.next(row, 0)) throw Error(ErrorKind::damaged, Where{path, "line 1"}, "is empty; a header is needed");
  table.columns = std::move(row.cells);
  if (table.columns.size() == 1) {
    fail(path, row.line,
         fmt::format("one column only (\"{}\"); the separator is a comma, a semicolon or a tab",
                     recorder::shown(table.columns[0])));
  }
  while (records.next(row, table.columns.size())) {
    if (row.cells.size() != table.columns.size()) {
      fail(path, row.line, fmt::format("{} cells, the header has {}", row.cells.size(), table.columns.size()));
    }
    table.rows.push_back(row);
  }
  if (table.rows.empty()) fail(path, 1, "a header and no rows");
  return table;
}

CsvTable readCsvTable(const std::string& path) {
  const std::vector<std::byte> bytes = recorder::readFileBytes(path, path, maxTableBytes);
  return parseCsvTable({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, path);
}

std::string csvQuoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

std::string csvCell(const std::string& text) {
  const bool formula = !text.empty() && std::string_view("=+-@\t\r").find(text.front()) != std::string_view::npos;
  return csvQuoted(formula ? '\'' + text : text);
}

std::string csvLine(const std::vector<std::string>& texts) {
  std::string line;
  for (const std::string& text : texts) {
    line += csvCell(text);
    line += ',';
  }
  if (!line.empty()) line.back() = '\n';
  return line;
}

CsvFile::CsvFile(std::filesystem::path path) : path_(std::move(path)), file_(std::fopen(path_.c_str(), "w")) {
  if (!file_) fail();
}

void CsvFile::endRow() {
  line_.push_back('\n');
  if (std::fwrite(line_.data(), 1, line_.size(), file_.get()) != line_.size()) fail();
  line_.clear();
  first_ = true;
}

void CsvFile::close() {
  if (std::fclose(file_.release()) != 0) fail();
}

void CsvFile::fail() const {
  throw Error(ErrorKind::failure, Where{path_.string()},
              fmt::format("cannot be written: {}", std::generic_category().message(errno)));
}

}  // namespace calot
