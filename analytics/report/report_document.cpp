// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/report/report_document.h"

#include <algorithm>
#include <cstddef>

namespace calot::analytics {
namespace {

constexpr std::size_t terminalWidth = 120;

}  // namespace

void dropEmptyColumns(ReportTable& table) {
  for (std::size_t c = table.columns.size(); c-- > 0;) {
    const auto column = static_cast<std::ptrdiff_t>(c);
    if (std::any_of(table.rows.begin(), table.rows.end(), [&](const auto& row) { return !row[c].empty(); })) continue;
    table.columns.erase(table.columns.begin() + column);
    for (auto& row : table.rows) row.erase(row.begin() + column);
  }
}

void printTable(const ReportTable& content, std::ostream& out) {
  TextTable table(content.columns);
  for (const auto& row : content.rows) table.add(row);
  out << content.title << '\n';
  table.print(out, terminalWidth);
  out << '\n';
}

void printWrapped(const std::string& text, std::ostream& out) {
  std::size_t begin = 0;
  while (text.size() - begin > terminalWidth) {
    std::size_t end = text.rfind(' ', begin + terminalWidth);
    if (end == std::string::npos || end <= begin) end = text.find(' ', begin);
    if (end == std::string::npos) break;
    out << text.substr(begin, end - begin) << '\n';
    begin = end + 1;
  }
  out << text.substr(begin) << '\n';
}

}  // namespace calot::analytics
