// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/report/study_tables.h"
#include "analytics/report/rating_tables.h"

#include <fmt/format.h>
#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "analytics/report/plots.h"
#include "analytics/report/study_coverage.h"

namespace calot::analytics {
namespace {

using Align = TextTable::Align;

std::string brackets(double lower, double upper) {
  return fmt::format("[{}, {}]", significant(lower), significant(upper));
}
std::string share(double a) { return fmt::format("{:.3f}", a); }

using ShownRows = std::vector<const StudyRow*>;

bool hasCorrelation(const StudyRow& row) { return static_cast<bool>(row.withDuration); }

ReportTable valuesTable(const Study& study, const std::string& title, const ShownRows& rows) {
  ReportTable table{title,
                    {{"checkpoint", Align::left},
                     {"unit", Align::left},
                     {"group", Align::left},
                     {"n", Align::right},
                     {"none", Align::right},
                     {"median", Align::right},
                     {"quartile 1", Align::right},
                     {"quartile 3", Align::right},
                     {"mean", Align::right},
                     {"sd", Align::right},
                     {"paper", Align::right}},
                    {}};
  for (const StudyRow* shown : rows) {
    const StudyRow& row = *shown;
    for (std::size_t g = 0; g < 2; ++g) {
      const GroupSummary& s = row.group[g];
      std::string paper;
      if (row.publishedExpert)
        paper = g == 0 ? fmt::format("E {}", *row.publishedExpert) : fmt::format("N {}", *row.publishedNovice);
      table.rows.push_back({g == 0 ? rowName(row) : "", g == 0 ? row.unit : "", study.groups[g], fmt::format("{}", s.n),
                            s.missing == 0 ? "" : fmt::format("{}", s.missing), significantOrDash(s.median),
                            significantOrDash(s.lowerQuartile), significantOrDash(s.upperQuartile),
                            significantOrDash(s.mean), significantOrDash(s.standardDeviation), paper});
    }
  }
  return table;
}

/// No word about the expected direction beside a p that prints as 1.
std::string expectedText(const StudyRow& row) {
  const double p = row.holm.value_or(row.benjaminiHochberg.value_or(row.test ? row.test->p : 1.0));
  if (!row.hypothesis || !row.area || p > 0.99995) return {};
  return !row.asHypothesised ? "neither" : *row.asHypothesised ? "yes" : "no";
}

ReportTable comparisonTable(const Study& study, const std::string& title, const ShownRows& rows) {
  ReportTable table{title,
                    {{"checkpoint", Align::left},
                     {"better", Align::left},
                     {"shift", Align::right},
                     {"95 %", Align::right},
                     {"A", Align::right},
                     {"95 %", Align::right},
                     {"p", Align::right},
                     {"Holm", Align::right},
                     {"BH", Align::right},
                     {"expected", Align::left}},
                    {}};
  if (!study.protocol) table.columns.erase(table.columns.end() - 2);
  for (const StudyRow* shown : rows) {
    const StudyRow& row = *shown;
    table.rows.push_back({rowName(row), row.direction == Direction::none ? "" : nameOf(row.direction),
                          row.shift ? significant(*row.shift) : "-",
                          row.shiftInterval ? brackets(row.shiftInterval->lower, row.shiftInterval->upper) : "-",
                          row.area ? share(row.area->value.a) : "-",
                          row.area ? fmt::format("[{}, {}]", share(row.area->a.lower), share(row.area->a.upper)) : "-",
                          row.test ? pText(row.test->p) + (row.test->exact ? "" : "~") : "-", pOrDash(row.holm)});
    if (study.protocol) table.rows.back().push_back(pOrDash(row.benjaminiHochberg));
    table.rows.back().push_back(expectedText(row));
  }
  return table;
}

ReportTable furtherTable(const Study& study) {
  ReportTable table{"Further",
                    {{"checkpoint", Align::left},
                     {"g", Align::right},
                     {"95 %", Align::right},
                     {"rho (duration)", Align::right},
                     {"p", Align::right},
                     {"n", Align::right}},
                    {}};
  const bool known = std::any_of(study.rows.begin(), study.rows.end(), hasCorrelation);
  for (const StudyRow& row : study.rows) {
    if (hasNoValue(row) || !row.notOutcome.empty()) continue;
    const bool interval = row.hedges && row.hedges->interval, rho = hasCorrelation(row);
    table.rows.push_back({rowName(row), row.hedges ? significant(row.hedges->g, 3) : "-",
                          interval ? fmt::format("[{}, {}]", significant(row.hedges->interval->lower, 3),
                                                 significant(row.hedges->interval->upper, 3))
                                   : "-",
                          rho     ? fmt::format("{:+.3f}", row.withDuration->rho)
                          : known ? "-"
                                  : "",
                          rho     ? pText(row.withDuration->p)
                          : known ? "-"
                                  : "",
                          rho     ? fmt::format("{}", row.withDurationPairs)
                          : known ? "-"
                                  : ""});
  }
  return table;
}

/// Figures whose intervals are points are left out: nothing that is simulated changes them.
ReportTable simulationTable(const Study& study) {
  ReportTable table{"Uncertainty of the simulation",
                    {{"checkpoint", Align::left},
                     {"unit", Align::left},
                     {"half-width", Align::right},
                     {"A", Align::right},
                     {"range of A", Align::right},
                     {"", Align::left}},
                    {}};
  for (const StudyRow& row : study.rows) {
    if (!row.simulation || !row.area) continue;
    const SimulationRange& s = *row.simulation;
    if (s.known == s.values && s.halfWidth == 0.0 && s.decided()) continue;
    const bool turned = row.hypothesis && *row.hypothesis == Hypothesis::firstSmaller;
    std::string range = "-";
    if (s.area) {
      range = turned ? fmt::format("[{}, {}]", share(1.0 - s.area->second), share(1.0 - s.area->first))
                     : fmt::format("[{}, {}]", share(s.area->first), share(s.area->second));
    }
    table.rows.push_back({rowName(row), row.unit, significant(s.halfWidth, 3), share(row.area->value.a), range,
                          !s.area       ? fmt::format("{} of {} values have an interval", s.known, s.values)
                          : s.decided() ? "decided"
                                        : "not decided by this simulation"});
  }
  return table;
}

ReportTable baselineTable(const Study& study) {
  ReportTable table{"At one baseline",
                    {{"outcome", Align::left},
                     {"n", Align::right},
                     {"difference", Align::right},
                     {"95 %", Align::right},
                     {"p", Align::right},
                     {"Holm", Align::right},
                     {"slope", Align::right},
                     {"p, one slope", Align::right}},
                    {}};
  for (const StudyRow& row : study.rows) {
    if (!row.adjusted || hasNoValue(row)) continue;
    const auto& analysis = row.adjusted->analysis;
    const std::string n = fmt::format("{} + {}", row.adjusted->n[0], row.adjusted->n[1]);
    if (!analysis) {
      table.rows.push_back({rowName(row), n, "-", "-", "-", "-", "-", "-"});
      continue;
    }
    table.rows.push_back({rowName(row), n, significant(analysis->estimate),
                          brackets(analysis->interval.lower, analysis->interval.upper), pText(analysis->p),
                          pOrDash(row.adjusted->holm), significant(analysis->slope),
                          analysis->sameSlope ? pText(*analysis->sameSlope) : "-"});
  }
  return table;
}

}  // namespace

std::string studyTitle(const Study& study) {
  return fmt::format("Study ({}): {} against {}", study.heading, study.groups[0], study.groups[1]);
}

std::string rowName(const StudyRow& row) { return figureOfRow(row) + (row.source.empty() ? "" : " (external)"); }

std::string figureOfRow(const StudyRow& row) {
  return row.subject.empty() ? row.checkpoint : fmt::format("{} {}", row.checkpoint, row.subject);
}

ReportTable flowTable(const Study& study) {
  ReportTable table{"Flow", {{study.counted, Align::right}, {"", Align::left}}, {}};
  table.rows.push_back({fmt::format("{}", study.recruited), "in the " + study.source});
  for (const FlowRow& row : study.flow)
    table.rows.push_back({fmt::format("{}", row.attempts), "left out: " + row.reason});
  table.rows.push_back({fmt::format("{}", study.analysed),
                        fmt::format("analysed: {} {} ({} {}), {} {} ({} {}); {}", study.participants[0],
                                    study.groups[0], study.attempts[0], study.counted, study.participants[1],
                                    study.groups[1], study.attempts[1], study.counted, study.attemptRule)});
  return table;
}

bool hasNoValue(const StudyRow& row) { return row.group[0].n == 0 && row.group[1].n == 0; }

std::vector<ReportTable> appendixTables(const Study& study) {
  std::vector<ReportTable> tables;
  const auto add = [&](ReportTable table) {
    if (table.rows.empty()) return;
    dropEmptyColumns(table);
    tables.push_back(std::move(table));
  };
  add(secondaryTable(study));
  std::map<std::optional<CheckpointFamily>, ShownRows> families;  // columns of a table have none, and stand first
  ShownRows apart;
  ShownRows external;
  for (const StudyRow& row : study.rows) {
    if (hasNoValue(row)) continue;
    ShownRows& shown = !row.notOutcome.empty() ? apart
                       : row.source.empty()    ? families[familyOf(row.checkpoint)]
                                               : external;
    shown.push_back(&row);
  }
  for (const auto& [family, rows] : families) {
    const std::string of = family ? ": " + nameOf(*family) : "";
    add(valuesTable(study, "Values" + of, rows));
    add(comparisonTable(study, "Comparison" + of, rows));
  }
  add(valuesTable(study, "Values: external metrics (scripts of the site)", external));
  add(comparisonTable(study, "Comparison: external metrics", external));
  add(valuesTable(study, "No outcomes: not tested", apart));
  for (ReportTable table : {coverageTable(study), furtherTable(study), simulationTable(study), baselineTable(study)})
    add(std::move(table));
  for (const FormReport& report : study.ratings) {
    for (ReportTable& table : ratingTables(report)) add(std::move(table));
  }
  return tables;
}

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
