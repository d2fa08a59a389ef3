// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/assessment/angoff_judges.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"

namespace calot::analytics {
namespace {

constexpr const char* judgeColumn = "judge";

[[noreturn]] void failCell(const CsvTable& table, std::size_t line, const std::string& column,
                           const std::string& what) {
  throw Error(ErrorKind::damaged, Where{table.path, fmt::format("line {}", line)},
              fmt::format("column \"{}\": {}", recorder::shown(column), what));
}

}  // namespace

AngoffJudgement readAngoff(const CsvTable& table) {
  const std::size_t judge = table.column(judgeColumn);
  AngoffJudgement result;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    if (c != judge) result.items.push_back(table.columns[c]);
  }
  result.probabilities.raters = result.items.size();
  for (const CsvRow& row : table.rows) {
    const std::string& name = row.cells[judge];
    if (name.empty()) failCell(table, row.line, judgeColumn, "is empty");
    if (std::find(result.judges.begin(), result.judges.end(), name) != result.judges.end())
      failCell(table, row.line, judgeColumn, fmt::format("\"{}\" is named twice", recorder::shown(name)));
    result.judges.push_back(name);
    ++result.probabilities.subjects;
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      if (c == judge) continue;
      std::string fault;
      const double p = recorder::readFiniteNumber(row.cells[c], fault);
      if (!fault.empty()) failCell(table, row.line, table.columns[c], fault);
      if (p < 0.0 || p > 1.0)
        failCell(table, row.line, table.columns[c], fmt::format("{} is no probability from 0 to 1", p));
      result.probabilities.values.push_back(p);
    }
  }
  const Expected<AngoffCut> cut = angoffCut(result.probabilities);
  if (!cut) throw Error(ErrorKind::refused, Where{table.path}, cut.reason());
  result.cut = *cut;
  constexpr double rounding = 1e-9;  // sums of probabilities miss whole numbers by their last bits
  result.needed = static_cast<std::size_t>(std::ceil(cut->cut - rounding));
  return result;
}

}  // namespace calot::analytics
