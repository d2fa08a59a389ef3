// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "analytics/report/box_plot.h"
#include "analytics/report/page_html.h"
#include "analytics/report/study_output.h"
#include "analytics/report/study_tables.h"

namespace calot::analytics {
namespace {

std::string figures(const Study& study) {
  std::string html;
  for (const StudyRow& row : study.rows) {
    html += boxPlotSvg({.title = rowName(row),
                        .axis = row.unit == "1" ? "" : row.unit,
                        .groups = study.groups,
                        .values = {row.values[0], row.values[1]},
                        .synthetic = study.synthetic});
  }
  if (html.empty()) return {};
  return "<h2>Figures</h2>\n<p>Box: quartiles and median; whiskers: the outermost values within 1.5 times the box's "
         "height; a point for each participant.</p>\n<div class=\"figures\">\n" +
         html + "</div>\n";
}

}  // namespace

std::string studyHtml(const Study& study) {
  std::string html = pageBegin(studyTitle(study), study.synthetic) + paragraphHtml(study.where);
  for (const std::string& line : protocolLines(study)) html += paragraphHtml(line);
  html += tableHtml(flowTable(study));
  for (const ReportTable& table : studyTables(study)) html += tableHtml(table);
  html += "<h2>Notes</h2>\n" + listHtml(studyNotes(study)) + paragraphHtml(studyMethods(study));
  return html + figures(study) + pageEnd(study.synthetic);
}

}  // namespace calot::analytics
