// SPDX-License-Identifier: GPL-3.0-or-later
// The first result of a study: hypotheses or leading figures as one table, and as a forest plot.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "analytics/report/forest_plot.h"
#include "analytics/report/study_coverage.h"
#include "analytics/report/study_tables.h"

namespace calot::analytics {
namespace {

using Align = TextTable::Align;

std::string withUnit(const StudyRow& row) {
  return row.unit.empty() || row.unit == "1" ? rowName(row) : fmt::format("{} ({})", rowName(row), row.unit);
}

std::string supportText(const Study& study, const StudyRow& row) {
  if (!row.test) return "no test";
  if (!row.supported) return "out of reach";
  if (!*row.supported) return "no";
  const CoverageRow* coverage = coverageOf(study, row);
  return coverage != nullptr && coverageDiffers(*coverage) ? "yes, but coverage differs" : "yes";
}

/// The study says which values its hypotheses expect to be larger.
bool isDirected(const Study& study) { return study.protocol && !study.protocol->masked; }

std::string resultTitle(const Study& study) {
  if (study.protocol) return "Primary hypotheses";
  const bool table2 = std::all_of(study.rows.begin(), study.rows.end(), [](const StudyRow& row) {
    return !row.leading || familyOf(row.checkpoint) == CheckpointFamily::paper;
  });
  return table2 ? "Figures of the paper's Table 2" : "Outcomes";
}

/// One line of the table; `adjusted` by Holm for what leads, by Benjamini and Hochberg for secondary hypotheses.
std::vector<std::string> resultLine(const Study& study, const StudyRow& row, const std::optional<double>& adjusted) {
  std::vector<std::string> line{withUnit(row)};
  if (isDirected(study)) line.push_back(row.hypothesis == Hypothesis::firstLarger ? study.groups[0] : study.groups[1]);
  line.push_back(fmt::format("{} + {}", row.group[0].n, row.group[1].n));
  if (!isDirected(study)) {
    line.push_back(significantOrDash(row.group[0].median, 3));
    line.push_back(significantOrDash(row.group[1].median, 3));
  }
  line.push_back(row.shift ? significant(*row.shift, 3) : "-");
  line.push_back(row.shiftInterval ? fmt::format("[{}, {}]", significant(row.shiftInterval->lower, 3),
                                                 significant(row.shiftInterval->upper, 3))
                                   : "-");
  line.push_back(row.area ? fmt::format("{:.2f}", row.area->value.a) : "-");
  line.push_back(row.area ? fmt::format("[{:.2f}, {:.2f}]", row.area->a.lower, row.area->a.upper) : "-");
  line.push_back(row.test ? pText(row.test->p) + (row.test->exact ? "" : "~") : "-");
  line.push_back(pOrDash(adjusted));
  line.push_back(pOrDash(row.attainableP));
  if (isDirected(study)) line.push_back(supportText(study, row));
  return line;
}

ReportTable resultTable(const Study& study, std::string title, const char* adjustment) {
  ReportTable table{std::move(title), {{study.protocol ? "hypothesis" : "figure", Align::left}}, {}};
  if (isDirected(study)) table.columns.emplace_back("larger", Align::left);
  table.columns.emplace_back("n", Align::right);
  if (!isDirected(study)) {
    for (const std::string& group : study.groups) table.columns.emplace_back(cutTo(group, 10), Align::right);
  }
  for (const char* name : {"shift", "95 %", "A", "95 %", "p", adjustment, "smallest"})
    table.columns.emplace_back(name, Align::right);
  if (isDirected(study)) table.columns.emplace_back("supported", Align::left);
  return table;
}

std::string resultLegend(const Study& study) {
  const std::string &a = study.groups[0], &b = study.groups[1];
  const std::string superiority =
      study.better.empty()
          ? fmt::format("that one of {} has the larger value ({})", a,
                        study.protocol ? "directions are masked" : "nobody said who is expected to do better")
          : fmt::format("that one of {} is better than one of {}, by {}", study.better, study.better == a ? b : a,
                        study.protocol ? "the hypothesis" : "the figure's own direction");
  return fmt::format(
      "{}shift: {} - {}, Hodges-Lehmann. A: probability {}, ties half. p: Mann-Whitney, two-sided. {} smallest: least "
      "adjusted p that groups of these sizes and these ties can give.",
      isDirected(study) ? "larger: the group whose values are expected to be larger. "
                        : fmt::format("{}, {}: medians. ", a, b),
      a, b, superiority, study.family);
}

std::string reachWarning(const Study& study) {
  const double level = study.protocol ? study.protocol->level : usualLevel;
  std::size_t tested = 0, beyond = 0;
  double least = 1.0;
  for (const StudyRow& row : study.rows) {
    if (!row.leading || !row.attainableP) continue;
    ++tested;
    beyond += isOutOfReach(row, level) ? 1 : 0;
    least = std::min(least, *row.attainableP);
  }
  if (beyond == 0) return {};
  return fmt::format(
      "Warning: for {} of {} figures no adjusted p of these groups can be {:g} or less, however far apart they are "
      "(the "
      "smallest is {}). The study cannot decide on them: that is neither support nor evidence against.",
      beyond, tested, level, pText(least));
}

/// A p does not know how exact the simulation is.
std::string simulationWarning(const Study& study) {
  std::string undecided;
  for (const StudyRow& row : study.rows) {
    if (!row.leading || !row.simulation || !row.simulation->area || row.simulation->decided()) continue;
    undecided += (undecided.empty() ? "" : ", ") + rowName(row);
  }
  if (undecided.empty()) return {};
  return fmt::format(
      "Warning: which group is ahead is not decided by this simulation, but by its step, mesh or constants, for: {}.",
      undecided);
}

}  // namespace

ReportTable primaryTable(const Study& study) {
  ReportTable table = resultTable(study, resultTitle(study), "Holm");
  for (const StudyRow& row : study.rows) {
    if (row.leading) table.rows.push_back(resultLine(study, row, row.holm));
  }
  return table;
}

ReportTable secondaryTable(const Study& study) {
  ReportTable table = resultTable(study, "Secondary hypotheses", "BH");
  for (const StudyRow& row : study.rows) {
    if (row.role == Role::secondary) table.rows.push_back(resultLine(study, row, row.benjaminiHochberg));
  }
  return table;
}

std::vector<std::string> primaryNotes(const Study& study) {
  std::vector<std::string> notes{resultLegend(study)};
  if (std::string text = reachWarning(study); !text.empty()) notes.push_back(std::move(text));
  if (std::string text = simulationWarning(study); !text.empty()) notes.push_back(std::move(text));
  for (std::string& note : coverageWarnings(study)) notes.push_back(std::move(note));
  for (std::string& warning : intervalWarnings(study, true)) notes.push_back(std::move(warning));
  notes.insert(notes.end(), study.remarks.begin(), study.remarks.end());
  if (study.protocol) {
    for (const std::string& deviation : study.protocol->deviations)
      notes.push_back("Deviation from the protocol: " + deviation);
  }
  explainMissing(study, true, notes);
  return notes;
}

std::optional<Drawing> forestOf(const Study& study) {
  ForestPlot plot{.title = resultTitle(study) + ": A with its 95 % interval",
                  .below = study.better.empty() ? study.groups[1] + " larger" : "against the hypothesis",
                  .above = study.better.empty() ? study.groups[0] + " larger" : study.better + " better, as expected",
                  .rows = {},
                  .synthetic = study.synthetic};
  if (isDirected(study)) plot.above = "as the hypothesis says";
  for (const StudyRow& row : study.rows) {
    if (row.leading && row.area)
      plot.rows.push_back({rowName(row), row.area->value.a, row.area->a.lower, row.area->a.upper});
  }
  if (plot.rows.empty()) return std::nullopt;
  return drawForest(plot);
}

}  // namespace calot::analytics
