// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/table_records.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"

namespace calot::analytics {
namespace {

using recorder::shown;

/// Squares of what is larger, and their sums, might not be finite.
constexpr double largest = 1e100;

constexpr const char* missingWord = "NA";  // R's

/// A decimal comma, which only cells between semicolons can have, as a point.
std::string withPoint(const std::string& cell, char separator) {
  std::string number = cell;
  if (separator == ';' && std::count(cell.begin(), cell.end(), ',') == 1 && cell.find('.') == std::string::npos)
    number[cell.find(',')] = '.';
  return number;
}

[[noreturn]] void failAt(const CsvTable& table, std::size_t line, const std::string& column, const std::string& what) {
  throw Error(ErrorKind::damaged, Where{table.path, fmt::format("line {}", line)},
              fmt::format("column \"{}\": {}", shown(column), what));
}

/// Names are printed: a line break or another control character could forge output.
void askForPlainName(const CsvTable& table, std::size_t line, const std::string& column, const std::string& name) {
  const auto control = [](char c) { return (c >= 0 && c < ' ') || c == '\x7F'; };
  if (std::any_of(name.begin(), name.end(), control))
    failAt(table, line, column, fmt::format("\"{}\" holds a line break or a control character", shown(name)));
}

std::set<std::string> occasionsOf(const std::vector<Record>& records) {
  std::set<std::string> occasions;
  for (const Record& r : records) occasions.insert(r.occasion);
  return occasions;
}

}  // namespace

std::vector<Outcome> outcomesOf(const CsvTable& table, const TableStudyOptions& options) {
  std::vector<Outcome> outcomes;
  for (const std::string& text : options.outcomes) {
    Outcome outcome{text, Direction::none, 0};
    // A column may itself be called "a:lower".
    if (const std::size_t colon = text.rfind(':'); !table.has(text) && colon != std::string::npos) {
      const std::string word = text.substr(colon + 1);
      if (word != "lower" && word != "higher") {
        throw Error(
            ErrorKind::invalid,
            fmt::format("study: outcome \"{}\": behind the colon stands what is better, lower or higher", shown(text)));
      }
      outcome = {text.substr(0, colon), word == "lower" ? Direction::lower : Direction::higher, 0};
    }
    outcome.column = table.column(outcome.name);
    askForPlainName(table, 1, outcome.name, outcome.name);
    for (const Outcome& other : outcomes) {
      if (other.column == outcome.column)
        throw Error(ErrorKind::invalid, fmt::format("study: outcome \"{}\" is named twice", shown(outcome.name)));
    }
    outcomes.push_back(outcome);
  }
  return outcomes;
}

std::vector<Record> recordsOf(const CsvTable& table, const TableStudyOptions& options,
                              const std::vector<Outcome>& outcomes) {
  const std::size_t participant = table.column(options.participantColumn);
  const std::optional<std::size_t> group =
      options.groupColumn.empty() ? std::nullopt : std::optional(table.column(options.groupColumn));
  std::vector<std::size_t> occasion;
  for (const std::string& name : options.occasionColumns) occasion.push_back(table.column(name));
  std::vector<Record> records;
  records.reserve(table.rows.size());
  for (const CsvRow& row : table.rows) {
    Record record{row.line, row.cells[participant], group ? row.cells[*group] : std::string(), "", {}};
    if (record.participant.empty())
      failAt(table, row.line, options.participantColumn, "is empty; every row needs its participant");
    askForPlainName(table, row.line, options.participantColumn, record.participant);
    askForPlainName(table, row.line, options.groupColumn, record.group);
    for (std::size_t i = 0; i < occasion.size(); ++i) {
      if (row.cells[occasion[i]].empty())
        failAt(table, row.line, options.occasionColumns[i], "is empty; every row needs its occasion");
      askForPlainName(table, row.line, options.occasionColumns[i], row.cells[occasion[i]]);
      record.occasion += (i == 0 ? "" : "/") + row.cells[occasion[i]];
    }
    for (const Outcome& outcome : outcomes) {
      const std::string& cell = row.cells[outcome.column];
      std::optional<double> value;
      if (!cell.empty() && cell != missingWord) {
        std::string fault;
        value = recorder::readFiniteNumber(withPoint(cell, table.separator), fault);
        if (fault.empty() && std::abs(*value) > largest)
          failAt(table, row.line, outcome.name, fmt::format("\"{}\" is larger than {}", shown(cell), largest));
        if (!fault.empty())
          failAt(table, row.line, outcome.name, fault + "; leave the cell empty, or NA, where a value is missing");
      }
      record.values.push_back(value);
    }
    records.push_back(std::move(record));
  }
  return records;
}

void askForOccasion(const CsvTable& table, const std::vector<Record>& records, const std::string& occasion) {
  const std::set<std::string> known = occasionsOf(records);
  if (occasion.empty() || known.count(occasion) > 0) return;
  std::string list;
  for (const std::string& name : known) list += (list.empty() ? "" : ", ") + shown(name);
  throw Error(ErrorKind::invalid, Where{table.path},
              fmt::format("there is no occasion \"{}\" (there are: {})", shown(occasion), list));
}

}  // namespace calot::analytics
