// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/base/csv.h"

#include <fmt/format.h>
#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string_view>
#include <system_error>

#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"

namespace calot {
namespace {

std::string_view trimmed(std::string_view cell) {
  const std::size_t first = cell.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return cell.substr(first, cell.find_last_not_of(" \t") - first + 1);
}

void skipByteOrderMark(std::string_view& text) {
  constexpr std::string_view mark = "\xEF\xBB\xBF";
  if (text.starts_with(mark)) text.remove_prefix(mark.size());
}

[[noreturn]] void fail(const std::string& path, std::size_t line, const std::string& what) {
  throw Error(ErrorKind::damaged, Where{path, fmt::format("line {}", line)}, what);
}

/// Takes records off a text, one after the other.
class Records {
 public:
  Records(std::string_view text, const std::string& path, char separator)
      : rest_(text), path_(path), separator_(separator), ends_{separator, '\n'} {}

  /// @return false at the end
  bool next(CsvRow& row) {
    while (!rest_.empty()) {
      row.line = line_;
      row.cells.clear();
      bool quoted = false;
      while (takeCell(row, quoted)) {
      }
      if (quoted || row.cells.size() > 1 || !row.cells[0].empty()) return true;
    }
    return false;
  }

 private:
  /// @return whether another cell of this record follows
  bool takeCell(CsvRow& row, bool& quoted) {
    const std::size_t start = std::min(rest_.find_first_not_of(" \t"), rest_.size());
    if (start < rest_.size() && rest_[start] == '"') {
      rest_.remove_prefix(start + 1);
      quoted = true;
      row.cells.push_back(takeQuoted(row.line));
      rest_.remove_prefix(std::min(rest_.find_first_not_of(" \t"), rest_.size()));
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
  std::string ends_;  ///< of a cell without quotes
  std::size_t line_ = 1;
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

CsvTable parseCsvTable(std::string_view text, const std::string& path) {
  skipByteOrderMark(text);
  if (text.find('\0') != std::string_view::npos)
    throw Error(ErrorKind::damaged, Where{path}, "is not a table of text (CSV)");
  CsvTable table;
  table.path = path;
  const std::string_view header = text.substr(0, text.find('\n'));
  if (header.find(',') == std::string_view::npos && header.find(';') != std::string_view::npos) table.separator = ';';
  Records records(text, path, table.separator);
  CsvRow row;
  if (!records.next(row)) throw Error(ErrorKind::damaged, Where{path, "line 1"}, "is empty; a header is needed");
  table.columns = std::move(row.cells);
  if (table.columns.size() == 1) {
    fail(path, row.line,
         fmt::format("one column only (\"{}\"); the separator is a comma or a semicolon",
                     recorder::shown(table.columns[0])));
  }
  while (records.next(row)) {
    if (row.cells.size() != table.columns.size()) {
      fail(path, row.line, fmt::format("{} cells, the header has {}", row.cells.size(), table.columns.size()));
    }
    table.rows.push_back(row);
  }
  if (table.rows.empty()) fail(path, 1, "a header and no rows");
  return table;
}

CsvTable readCsvTable(const std::string& path) {
  std::error_code ignored;
  std::ifstream file(path, std::ios::binary);
  if (!file || std::filesystem::is_directory(path, ignored))
    throw Error(ErrorKind::damaged, Where{path}, "cannot be read; name a CSV file");
  const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  if (file.bad()) throw Error(ErrorKind::damaged, Where{path}, "cannot be read");
  return parseCsvTable(text, path);
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
