// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/study_view.h"

#include <algorithm>
#include <set>
#include <span>

#include "analytics/cohort/cohort_database.h"
#include "analytics/cohort/withdraw.h"
#include "analytics/design/design_report.h"
#include "analytics/report/report_document.h"
#include "analytics/report/study_output.h"
#include "analytics/report/study_people.h"
#include "analytics/report/study_protocol.h"
#include "analytics/report/study_rows.h"
#include "gui/words/problem_words.h"
#include "recorder/base/errors.h"
#include "recorder/base/files.h"

namespace calot::gui {
namespace {

using Access = analytics::CohortDatabase::Access;

// A veil (alpha, red, green, blue) over whatever ground the window has, so that letters keep their contrast on a light
// and on a dark one.
constexpr const char* headRow = "<tr bgcolor=\"#38808080\">";
constexpr const char* stripedRow = "<tr bgcolor=\"#18808080\">";

/// @param veiled the row has a ground, which letters would put behind themselves once more
std::string cell(const std::string& text, const char* tag, bool right, bool veiled) {
  const std::string shown = analytics::escaped(text);
  return std::string("<") + tag + " style=\"white-space:nowrap\"" + (right ? " align=\"right\"" : " align=\"left\"") +
         ">" + (veiled ? "<span style=\"background-color:transparent\">" + shown + "</span>" : shown) + "</" + tag +
         ">";
}

std::string tableText(const analytics::ReportTable& table) {
  std::string html = "<h3>" + analytics::escaped(table.title) +
                     "</h3><table cellspacing=\"0\" cellpadding=\"3\" border=\"0\">" + headRow;
  const auto right = [&](std::size_t column) {
    return column < table.columns.size() && table.columns[column].second == analytics::Align::right;
  };
  for (std::size_t c = 0; c < table.columns.size(); ++c) html += cell(table.columns[c].first, "th", right(c), true);
  html += "</tr>";
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    html += r % 2 == 1 ? stripedRow : "<tr>";
    for (std::size_t c = 0; c < table.rows[r].size(); ++c) html += cell(table.rows[r][c], "td", right(c), r % 2 == 1);
    html += "</tr>";
  }
  return html + "</table>";
}

std::string paragraph(const std::string& text) { return "<p>" + analytics::escaped(text) + "</p>"; }

/// Registers the attempts that were exported. @return a warning, or empty
std::string noteExport(const analytics::Study& study, const std::string& database, const std::string& kind,
                       const std::string& target) {
  try {
    std::vector<std::string> attempts;
    for (const analytics::AttemptRow& attempt : analytics::CohortDatabase(database, Access::read).listAttempts()) {
      if (study.groupOf.count(attempt.uuid) > 0) attempts.push_back(attempt.uuid);
    }
    analytics::recordExport(database, kind, target, attempts);
    return {};
  } catch (const Error& error) {
    return "The export could not be registered for later withdrawal: " + problemText(error);
  }
}

}  // namespace

analytics::Study studyOf(const std::string& database, const StudyRequest& request,
                         const analytics::StudyProgress& progress) {
  if (request.check) {
    if (progress) progress(0.0, "checking the cohort");
    analytics::refuseUnsound(database);
  }
  analytics::StudyOptions options = request.options;
  const bool chosen = std::count(options.groups.begin(), options.groups.end(), "") == 0;
  if (!request.protocol.empty() || !chosen) options.groups.clear();
  const analytics::CohortDatabase cohort(database, Access::read);
  for (const analytics::RegisteredProtocol& p : cohort.protocols()) {
    if (p.sha256 != request.protocol) continue;
    options.protocol = analytics::ProtocolInUse{
        analytics::parseProtocol(std::as_bytes(std::span(p.text)), p.name), cohort.protocols(p.name), {}};
  }
  if (options.protocol) return analytics::makeProtocolStudy(cohort, options, false, progress);
  analytics::Study study = analytics::makeStudy(cohort, options, progress);
  analytics::addRatings(study, cohort);
  return study;
}

std::vector<std::string> groupsOf(const std::vector<analytics::AttemptRow>& attempts, analytics::Grouping grouping) {
  std::set<std::string> names;
  for (const analytics::AttemptRow& attempt : attempts) {
    const std::string& name = grouping == analytics::Grouping::performer ? attempt.profile : attempt.group;
    if (!name.empty()) names.insert(name);
  }
  return {names.begin(), names.end()};
}

std::string studyText(const analytics::Study& study) {
  std::string html;
  if (study.synthetic)
    html += "<p style=\"background-color:#f0e442; color:#000000\"><b>&nbsp;" +
            analytics::escaped(analytics::watermarkText) + "&nbsp;</b></p>";
  html += "<h2>" + analytics::escaped(analytics::studyTitle(study)) + "</h2>";
  html += "<p><b>" + analytics::escaped(analytics::registrationText(study)) + "</b></p>" +
          tableText(analytics::primaryTable(study));
  if (!analytics::forestsOf(study).empty()) html += std::string("<p><img src=\"") + forestAddress + "\"></p>";
  const analytics::ReportTable coverage = analytics::coverageTable(study);
  if (!study.coverage.empty())
    html += coverage.rows.empty() ? paragraph(analytics::coverageNote(study)) : tableText(coverage);
  for (const std::string& note : analytics::primaryNotes(study)) html += paragraph(note);
  html += "<h3>Population</h3>";
  for (const std::string& line : analytics::studyHead(study)) html += paragraph(line);
  html += tableText(analytics::flowTable(study, study.groups));
  if (const analytics::ReportTable people = analytics::peopleTable(study); !people.rows.empty())
    html += tableText(people);
  html += "<h3>Methods</h3>" + paragraph(analytics::studyMethods(study)) + "<h2>Appendix</h2>";
  for (const std::string& note : analytics::appendixNotes(study)) html += paragraph(note);
  for (const analytics::ReportTable& table : analytics::appendixTables(study)) {
    if (table.title != coverage.title) html += tableText(table);
  }
  return html;
}

RocCurve rocOf(const std::vector<double>& first, const std::vector<double>& second, bool lowerIsPositive) {
  struct Value {
    double score;
    bool first;
  };
  std::vector<Value> values;
  values.reserve(first.size() + second.size());
  const double sign = lowerIsPositive ? -1.0 : 1.0;
  for (const double v : first) values.push_back({sign * v, true});
  for (const double v : second) values.push_back({sign * v, false});
  std::sort(values.begin(), values.end(), [](const Value& a, const Value& b) { return a.score > b.score; });
  RocCurve curve;
  curve.lowerIsPositive = lowerIsPositive;
  curve.points.push_back({0.0, 0.0});
  curve.area = 0.0;
  std::size_t positives = 0, negatives = 0;
  for (std::size_t i = 0; i < values.size();) {
    // Equal values change hands together.
    for (const double score = values[i].score; i < values.size() && values[i].score == score; ++i)
      ++(values[i].first ? positives : negatives);
    const RocPoint point{static_cast<double>(negatives) / static_cast<double>(second.size()),
                         static_cast<double>(positives) / static_cast<double>(first.size())};
    const RocPoint& before = curve.points.back();
    curve.area += (point.falsePositive - before.falsePositive) * 0.5 * (point.truePositive + before.truePositive);
    curve.points.push_back(point);
  }
  return curve;
}

RocCurve rocOf(const analytics::StudyRow& row) {
  return rocOf(row.values[0], row.values[1], row.hypothesis == analytics::Hypothesis::firstSmaller);
}

std::optional<analytics::Drawing> drawRoc(const RocCurve& curve, const std::string& title,
                                          const analytics::PlotFrame& frame) {
  analytics::PlotSeries chance, found;
  chance.ink = 2;
  chance.points = {{0.0, 0.0}, {1.0, 1.0}};
  for (const RocPoint& p : curve.points) found.points.emplace_back(p.falsePositive, p.truePositive);
  return analytics::drawLines({.title = title,
                               .axis = "share of the first group found",
                               .below = "share of the second group taken for the first",
                               .series = {chance, found},
                               .marks = {},
                               .frame = frame});
}

std::string exportStudy(const analytics::Study& study, const std::string& database, const std::string& target,
                        bool html) {
  if (html)
    recorder::writeText(target, analytics::pageHtml(analytics::studyDocument(study)), true);
  else
    analytics::writeStudyCsv(study, target, true);
  return noteExport(study, database, html ? "study-html" : "study-csv", target);
}

}  // namespace calot::gui
