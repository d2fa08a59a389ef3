// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/report/ratings.h"
#include "analytics/report/study_output.h"

#include <fmt/format.h>
#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "analytics/report/plots.h"
#include "analytics/report/study_rows.h"

namespace calot::analytics {
namespace {

using ShownRows = std::vector<const StudyRow*>;

// Texts of cells of a row's tree.
std::string figureText(const ValueTree& row) {
  return figureName(row["checkpoint"], row["subject"]) + (row.contains("source_sha256") ? " (external)" : "");
}
std::string withUnit(const ValueTree& row) {
  const std::string unit = row["unit"];
  return unit.empty() || unit == "1" ? figureText(row) : fmt::format("{} ({})", figureText(row), unit);
}
std::string betterText(const ValueTree& direction) { return direction == "none" ? "" : plain(direction); }
/// "~" for a p by approximation.
std::string testText(const ValueTree& test) {
  return pValue(test.value("p", ValueTree())) + (test.value("method", "") == "asymptotic" ? "~" : "");
}
/// No word about the expected direction beside a p that prints as 1.
std::string expectedText(const ValueTree& row) {
  double p = 1.0;
  for (const char* key : {"p", "p_benjamini_hochberg", "p_holm"}) {
    const ValueTree value = row["mann_whitney"].value(key, ValueTree());
    if (value.is_number()) p = value;
  }
  if (row["hypothesis"].is_null() || !row["area"].contains("a") || p > 0.99995) return {};
  const ValueTree& expected = row["hypothesis"]["as_expected"];
  return expected.is_null() ? "neither" : expected.get<bool>() ? "yes" : "no";
}
std::string sumText(const ValueTree& n) { return fmt::format("{} + {}", n[0].dump(), n[1].dump()); }
std::string sizesText(const ValueTree& groups) {
  return fmt::format("{} + {}", groups[0]["n"].dump(), groups[1]["n"].dump());
}
std::string wholeOrDash(const ValueTree& n) { return n.is_null() ? "-" : n.dump(); }
std::string share(double a) { return fmt::format("{:.3f}", a); }

ReportTable valuesTable(const Study& study, const std::string& title, const ShownRows& rows) {
  ReportTable table = tableOf(title, {"=checkpoint", "=unit", "=group", "n", "none", "median", "quartile 1",
                                      "quartile 3", "mean", "sd", "paper"});
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

ReportTable comparisonTable(const Study& study, const std::string& title, const ShownRows& shown) {
  ValueTree rows = ValueTree::array();
  for (const StudyRow* row : shown) rows.push_back(rowTree(study, *row));
  std::vector<TreeColumn> columns{{"=checkpoint", "", figureText},
                                  {"=better", "/direction", betterText},
                                  {"shift", "/shift/hodges_lehmann", digits4},
                                  {"95 %", "/shift_interval", range4},
                                  {"A", "/area/a", share3},
                                  {"95 %", "/area/interval", shares3},
                                  {"p", "/mann_whitney", testText},
                                  {"Holm", "/mann_whitney/p_holm", pValue}};
  if (study.protocol) columns.push_back({"BH", "/mann_whitney/p_benjamini_hochberg", pValue});
  columns.push_back({"=expected", "", expectedText});
  return tableOf(title, rows, columns);
}

ReportTable furtherTable(const Study& study, const ValueTree& rows) {
  const bool known = std::any_of(study.rows.begin(), study.rows.end(),
                                 [](const StudyRow& row) { return static_cast<bool>(row.withDuration); });
  std::vector<TreeColumn> columns{
      {"=checkpoint", "", figureText}, {"g", "/hedges/g", digits3}, {"95 %", "/hedges/interval", range3}};
  if (known) {
    columns.push_back({"rho (duration)", "/spearman_with_duration/rho", signed3});
    columns.push_back({"p", "/spearman_with_duration/p", pValue});
    columns.push_back({"n", "/spearman_with_duration/n", wholeOrDash});
  }
  return tableOf("Further", rows, columns);
}

/// Figures whose intervals are points are left out: nothing that is simulated changes them.
ReportTable simulationTable(const Study& study) {
  ReportTable table =
      tableOf("Uncertainty of the simulation", {"=checkpoint", "=unit", "half-width", "A", "range of A", "="});
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

ReportTable baselineTable(const ValueTree& rows) {
  return tableOf("At one baseline", rows,
                 {{"=outcome", "", figureText},
                  {"n", "/at_one_baseline/n", sumText},
                  {"difference", "/at_one_baseline/difference", digits4},
                  {"95 %", "/at_one_baseline/interval", range4},
                  {"p", "/at_one_baseline/p", pValue},
                  {"Holm", "/at_one_baseline/p_holm", pValue},
                  {"slope", "/at_one_baseline/slope", digits4},
                  {"p, one slope", "/at_one_baseline/one_slope/p", pValue}});
}

}  // namespace

std::string studyTitle(const Study& study) {
  return fmt::format("Study ({}): {} against {}", study.heading, study.groups[0], study.groups[1]);
}

std::string rowName(const StudyRow& row) { return figureOfRow(row) + (row.source.empty() ? "" : " (external)"); }

std::string figureOfRow(const StudyRow& row) { return figureName(row.checkpoint, row.subject); }

ReportTable flowTable(const AnalysedData& data, const std::string& whom) {
  ReportTable table = tableOf("Flow", {data.counted, "="});
  table.rows.push_back({fmt::format("{}", data.recruited), "in the " + data.source});
  for (const FlowRow& row : data.flow)
    table.rows.push_back({fmt::format("{}", row.attempts), "left out: " + row.reason});
  table.rows.push_back({fmt::format("{}", data.analysed), fmt::format("analysed: {}; {}", whom, data.attemptRule)});
  return table;
}

ReportTable flowTable(const Study& study) {
  const auto group = [&](std::size_t g) {
    return fmt::format("{} {} ({} {})", study.participants[g], study.groups[g], study.attempts[g], study.counted);
  };
  return flowTable(study, group(0) + ", " + group(1));
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
  ValueTree outcomes = ValueTree::array(), adjusted = ValueTree::array();
  for (const StudyRow& row : study.rows) {
    if (hasNoValue(row)) continue;
    if (row.notOutcome.empty()) outcomes.push_back(rowTree(study, row));
    if (row.adjusted) adjusted.push_back(rowTree(study, row));
  }
  for (ReportTable table :
       {coverageTable(study), furtherTable(study, outcomes), simulationTable(study), baselineTable(adjusted)})
    add(std::move(table));
  for (const FormReport& report : study.ratings) {
    for (ReportTable& table : ratingTables(report)) add(std::move(table));
  }
  return tables;
}

namespace {

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

/// @param adjusted where the adjusted p is: by Holm for what leads, by Benjamini and Hochberg for secondary hypotheses
template <class IsShown>
ReportTable resultTable(const Study& study, const std::string& title, const TreeColumn& adjusted, IsShown isShown) {
  ValueTree rows = ValueTree::array();
  for (const StudyRow& row : study.rows) {
    if (!isShown(row)) continue;
    rows.push_back(rowTree(study, row));
    rows.back()["larger"] = study.groups[row.hypothesis == Hypothesis::firstLarger ? 0 : 1];
    rows.back()["support"] = supportText(study, row);
  }
  std::vector<TreeColumn> columns{{study.protocol ? "=hypothesis" : "=figure", "", withUnit}};
  if (isDirected(study)) columns.push_back({"=larger", "/larger", plain});
  columns.push_back({"n", "/groups", sizesText});
  if (!isDirected(study)) {
    columns.push_back({cutTo(study.groups[0], 10), "/groups/0/median", digits3});
    columns.push_back({cutTo(study.groups[1], 10), "/groups/1/median", digits3});
  }
  columns.insert(columns.end(), {{"shift", "/shift/hodges_lehmann", digits3},
                                 {"95 %", "/shift_interval", range3},
                                 {"A", "/area/a", share2},
                                 {"95 %", "/area/interval", shares2},
                                 {"p", "/mann_whitney", testText},
                                 adjusted,
                                 {"smallest", "/attainable_p", pValue}});
  if (isDirected(study)) columns.push_back({"=supported", "/support", plain});
  return tableOf(title, rows, columns);
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
  return resultTable(study, resultTitle(study), {"Holm", "/mann_whitney/p_holm", pValue},
                     [](const StudyRow& row) { return row.leading; });
}

ReportTable secondaryTable(const Study& study) {
  return resultTable(study, "Secondary hypotheses", {"BH", "/mann_whitney/p_benjamini_hochberg", pValue},
                     [](const StudyRow& row) { return row.role == Role::secondary; });
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
