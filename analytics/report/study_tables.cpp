// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/study_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

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
    table.rows.push_back({rowName(row), n, significant(analysis->difference),
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

}  // namespace calot::analytics
