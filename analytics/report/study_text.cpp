// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/study_output.h"
#include "analytics/report/study_tables.h"

namespace calot::analytics {
namespace {

constexpr std::size_t terminalWidth = 120;

void printTable(const ReportTable& content, std::ostream& out) {
  TextTable table(content.columns);
  for (const auto& row : content.rows) table.add(row);
  out << content.title << '\n';
  table.print(out, terminalWidth);
  out << '\n';
}

/// A sentence over as many lines as it needs.
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

}  // namespace

void printStudy(const Study& study, std::ostream& out) {
  if (study.synthetic) out << watermarkText << '\n';
  printWrapped(studyTitle(study), out);
  out << '\n';
  for (const auto& row : flowTable(study).rows) printWrapped(row[0] + " " + study.counted + " " + row[1], out);
  out << '\n';
  for (const ReportTable& table : studyTables(study)) printTable(table, out);
  for (const std::string& note : studyNotes(study)) printWrapped(note, out);
  if (study.synthetic) out << watermarkText << '\n';
}

}  // namespace calot::analytics
