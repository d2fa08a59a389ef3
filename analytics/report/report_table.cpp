// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/report_table.h"

namespace calot::analytics {
namespace {

constexpr std::size_t terminalWidth = 120;

}  // namespace

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
