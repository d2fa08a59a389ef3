// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/study_output.h"
#include "analytics/report/study_tables.h"

namespace calot::analytics {

void printStudy(const Study& study, std::ostream& out, StudyDetail detail) {
  const auto print = [&](const std::vector<std::string>& lines) {
    for (const std::string& line : lines) printWrapped(line, out);
  };
  if (study.synthetic) out << watermarkText << '\n';
  printWrapped(studyTitle(study), out);
  print(studyHead(study));
  out << '\n';
  for (const auto& row : flowTable(study).rows) printWrapped(row[0] + " " + study.counted + " " + row[1], out);
  out << '\n';
  printTable(primaryTable(study), out);
  print(primaryNotes(study));
  if (detail == StudyDetail::all) {
    out << '\n';
    for (const ReportTable& table : appendixTables(study)) printTable(table, out);
    print(appendixNotes(study));
    printWrapped(studyMethods(study), out);
  }
  if (study.synthetic) out << watermarkText << '\n';
}

}  // namespace calot::analytics
