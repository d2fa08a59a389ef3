// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/study_output.h"
#include "analytics/report/study_tables.h"

namespace calot::analytics {

void printStudy(const Study& study, std::ostream& out) {
  if (study.synthetic) out << watermarkText << '\n';
  printWrapped(studyTitle(study), out);
  for (const std::string& line : protocolLines(study)) printWrapped(line, out);
  out << '\n';
  for (const auto& row : flowTable(study).rows) printWrapped(row[0] + " " + study.counted + " " + row[1], out);
  out << '\n';
  for (const ReportTable& table : studyTables(study)) printTable(table, out);
  for (const std::string& note : studyNotes(study)) printWrapped(note, out);
  printWrapped(studyMethods(study), out);
  if (study.synthetic) out << watermarkText << '\n';
}

}  // namespace calot::analytics
