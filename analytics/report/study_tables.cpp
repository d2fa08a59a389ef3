// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/report/ratings.h"
#include "analytics/report/study_output.h"

#include <fmt/format.h>
#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "analytics/report/figure_number.h"
#include "analytics/report/plots.h"
#include "analytics/report/study_people.h"
#include "analytics/report/study_rows.h"

namespace calot::analytics {
namespace {

using ShownRows = std::vector<const StudyRow*>;

// Texts of cells of a row's tree.
std::string figureText(const ValueTree& row) {
  return figureName(row["checkpoint"], row["subject"]) + (row.contains("source_sha256") ? " (external)" : "") +
         (row["unfinished"][0] != 0 || row["unfinished"][1] != 0 ? " *" : "");
}
std::string withUnit(const ValueTree& row) {
  const std::string unit = row["unit"];
  return unit.empty() || unit == "1" ? figureText(row) : fmt::format("{} ({})", figureText(row), unit);
}
/// Empty without a hypothesis, which an adjusted p belongs to.
std::string adjustedText(const ValueTree& p) { return p.is_null() ? "" : pValue(p); }
std::string betterText(const ValueTree& direction) { return direction == "none" ? "" : plain(direction); }
/// "~" for a p by approximation.
std::string testText(const ValueTree& test) {
  if (test.contains("p") && test["p_holm"].is_null() && test["p_benjamini_hochberg"].is_null()) return {};
  return pValue(test.value("p", ValueTree())) + (test.value("method", "") == "asymptotic" ? "~" : "");
}
std::string sumText(const ValueTree& n) { return fmt::format("{} + {}", n[0].dump(), n[1].dump()); }
std::string sizesText(const ValueTree& groups) {
  return fmt::format("{} + {}", groups[0]["n"].dump(), groups[1]["n"].dump());
}
std::string wholeOrDash(const ValueTree& n) { return n.is_null() ? "-" : n.dump(); }
std::string displayedUnit(const StudyRow& row) { return row.unit == "1" ? "" : row.unit; }
std::string share(double a) { return fmt::format("{:.3f}", a); }

ReportTable valuesTable(const Study& study, const std::string& title, const ShownRows& rows) {
  ReportTable table = tableOf(title, {"=checkpoint", "=unit", "=group", "n", "none", "median", "quartile 1",
                                      "quartile 3", "mean", "sd", "paper"});
  for (const StudyRow* shown : rows) {
    const StudyRow& row = *shown;
    const CheckpointDefinition* const definition = row.source.empty() ? definitionOfFigure(row.checkpoint) : nullptr;
    const auto number = [&](const std::optional<double>& value) {
      return value ? figureNumber(definition, *value) : "-";
    };
    for (std::size_t g = 0; g < 2; ++g) {
      const GroupSummary& s = row.group[g];
      std::string paper;
      if (row.publishedExpert)
        paper = g == 0 ? fmt::format("E {}", *row.publishedExpert) : fmt::format("N {}", *row.publishedNovice);
      table.rows.push_back({g == 0 ? rowName(row) : "", g == 0 ? displayedUnit(row) : "", study.groups[g],
                            fmt::format("{}", s.n), s.missing == 0 ? "" : fmt::format("{}", s.missing),
                            number(s.median), number(s.lowerQuartile), number(s.upperQuartile),
                            significantOrDash(s.mean), significantOrDash(s.standardDeviation), paper});
    }
  }
  return table;
}

/// A row's tree with the test that answers its hypothesis: of a claim with a margin the one-sided test.
ValueTree shownTree(const Study& study, const StudyRow& row) {
  ValueTree tree = rowTree(study, row);
  if (row.margin && row.marginP)
    tree["mann_whitney"].update({{"p", *row.marginP},
                                 {"p_holm", row.holm},
                                 {"p_benjamini_hochberg", row.benjaminiHochberg},
                                 {"method", "exact"}});
  return tree;
}

ReportTable comparisonTable(const Study& study, const std::string& title, const ShownRows& shown) {
  ValueTree rows = ValueTree::array();
  for (const StudyRow* row : shown) rows.push_back(shownTree(study, *row));
  std::vector<TreeColumn> columns{{"=checkpoint", "", figureText},
                                  {"=better", "/direction", betterText},
                                  {"shift", "/shift/hodges_lehmann", figure4},
                                  {"95 %", "/shift_interval", figureRange4},
                                  {"A", "/area/a", share3},
                                  {"95 %", "/area/interval", shares3},
                                  {"p", "/mann_whitney", testText},
                                  {"Holm", "/mann_whitney/p_holm", adjustedText},
                                  {"BH", "/mann_whitney/p_benjamini_hochberg", adjustedText}};
  ReportTable table = tableOf(title, rows, columns);
  table.leastNeeded = {"better", "95 %", "BH"};
  return table;
}

ReportTable furtherTable(const Study& study, const ValueTree& rows) {
  const bool known = std::any_of(study.rows.begin(), study.rows.end(),
                                 [](const StudyRow& row) { return static_cast<bool>(row.withDuration); });
  std::vector<TreeColumn> columns{
      {"=checkpoint", "", figureText}, {"g", "/hedges/g", digits3}, {"95 %", "/hedges/interval", range3}};
  if (known) {
    columns.push_back({"rho (duration)", "/spearman_with_duration/rho", signed3});
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
    table.rows.push_back({rowName(row), displayedUnit(row), significant(s.halfWidth, 3), share(row.area->value.a),
                          range,
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
    // The paper's table is of the paper's task.
    const bool elsewhere = family == CheckpointFamily::paper && study.publishedSource.empty();
    const std::string of = !family ? "" : elsewhere ? ": time, path and tissue" : ": " + nameOf(*family);
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
  if (coverage == nullptr || !samplingDiffers(study, *coverage)) return "yes";
  return coverageDiffers(*coverage) ? "yes, but coverage differs" : "yes, but trackers differ";
}

/// The study says which values its hypotheses expect to be larger.
bool isDirected(const Study& study) { return study.protocol && !study.protocol->masked; }

std::string resultTitle(const Study& study) {
  if (study.protocol) return "Primary hypotheses";
  const bool table2 = std::all_of(study.rows.begin(), study.rows.end(), [](const StudyRow& row) {
    return !row.leading || familyOf(row.checkpoint) == CheckpointFamily::paper;
  });
  return table2 && !study.publishedSource.empty() ? "Figures of the paper's Table 2" : "Outcomes";
}

double levelOf(const Study& study) { return study.protocol ? study.protocol->level : usualLevel; }

/// @param adjusted where the adjusted p is: by Holm for what leads, by Benjamini and Hochberg for secondary hypotheses
template <class IsShown>
ReportTable resultTable(const Study& study, const std::string& title, const TreeColumn& adjusted, IsShown isShown) {
  ValueTree rows = ValueTree::array();
  for (const StudyRow& row : study.rows) {
    if (!isShown(row)) continue;
    rows.push_back(shownTree(study, row));
    rows.back()["expected"] = row.claim == Claim::equivalence             ? "="
                              : row.hypothesis == Hypothesis::firstLarger ? ">"
                              : row.hypothesis                            ? "<"
                                                                          : "";
    rows.back()["support"] = supportText(study, row);
    if (!isOutOfReach(row, levelOf(study))) rows.back()["attainable_p"] = nullptr;
  }
  std::vector<TreeColumn> columns{{study.protocol ? "=hypothesis" : "=figure", "", withUnit}};
  columns.push_back({"n", "/groups", sizesText});
  columns.push_back({cutTo(study.groups[0], 10), "/groups/0/median", figure3});
  if (isDirected(study)) columns.push_back({"H", "/expected", plain});
  columns.push_back({cutTo(study.groups[1], 10), "/groups/1/median", figure3});
  columns.insert(columns.end(), {{"shift", "/shift/hodges_lehmann", figure3},
                                 {"95 %", "/shift_interval", figureRange3},
                                 {"A", "/area/a", share2},
                                 {"95 %", "/area/interval", shares2},
                                 {"p", "/mann_whitney", testText},
                                 adjusted,
                                 {"smallest", "/attainable_p", adjustedText}});
  if (isDirected(study)) columns.push_back({"=supported", "/support", plain});
  ReportTable table = tableOf(title, rows, columns);
  table.leastNeeded = {"smallest", "n", "95 %", "95 %", "A", "shift"};
  dropEmptyColumns(table);
  return table;
}

std::string resultLegend(const Study& study) {
  const std::string &a = study.groups[0], &b = study.groups[1];
  const std::string superiority =
      study.better.empty()
          ? fmt::format("that a member of {} has the larger value ({})", a,
                        study.protocol ? "directions are masked" : "nobody said who is expected to do better")
          : fmt::format("that a member of {} does better than a member of {}, by {}", study.better,
                        study.better == a ? b : a, study.protocol ? "the hypothesis" : "the figure's own direction");
  std::string undirected;
  bool tested = false, beyond = false, claimed = false;
  for (const StudyRow& row : study.rows) {
    if (!row.leading) continue;
    tested = tested || row.attainableP;
    claimed = claimed || row.margin;
    beyond = beyond || isOutOfReach(row, levelOf(study));
    if (!row.hypothesis && row.area && !study.better.empty())
      undirected += (undirected.empty() ? "" : ", ") + rowName(row);
  }
  return fmt::format(
      "{}, {}: medians{}. shift: {} - {}, Hodges-Lehmann. A: the probability {}, a tie counting half{}. Each "
      "interval holds for its own figure, not for all at once (not simultaneous). {}{}{}",
      a, b, isDirected(study) ? "; H: which is expected to be larger" : "", a, b, superiority,
      undirected.empty()
          ? ""
          : fmt::format("; for {}, without a direction: that a member of {} has the larger value", undirected, a),
      tested ? fmt::format("p: {}, two-sided{}. ", study.unequalSpread ? "Brunner-Munzel" : "Mann-Whitney",
                           claimed ? "; of claims with a margin one-sided" : "")
             : "",
      study.family, beyond ? " smallest: least adjusted p that groups of these sizes and these ties can give." : "");
}

std::string reachWarning(const Study& study) {
  const double level = levelOf(study);
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
  return resultTable(study, resultTitle(study), {"Holm", "/mann_whitney/p_holm", adjustedText},
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
  for (auto& warnings : {peopleWarnings(study), coverageWarnings(study)})
    notes.insert(notes.end(), warnings.begin(), warnings.end());
  for (std::string& warning : intervalWarnings(study, true)) notes.push_back(std::move(warning));
  notes.insert(notes.end(), study.remarks.begin(), study.remarks.end());
  if (study.protocol) {
    for (const std::string& deviation : study.protocol->deviations)
      notes.push_back("Deviation from the protocol: " + deviation);
  }
  explainMissing(study, true, notes);
  return notes;
}

std::vector<Drawing> forestsOf(const Study& study, std::size_t most) {
  const std::string title = resultTitle(study) + ": A with its 95 % interval";
  const std::string& worse = study.groups[study.better == study.groups[0] ? 1 : 0];
  ForestPlot directed{title, worse + " better", study.better + " better", {}, study.synthetic};
  if (isDirected(study)) {
    directed.below = "against the hypothesis";
    directed.above = "as the hypothesis says";
  }
  ForestPlot other{title, study.groups[1] + " larger", study.groups[0] + " larger", {}, study.synthetic};
  std::size_t left = most;
  for (const StudyRow& row : study.rows) {
    if (!row.leading || !row.area) continue;
    if (left-- == 0) break;
    (row.hypothesis ? directed : other)
        .rows.push_back({rowName(row), row.area->value.a, row.area->a.lower, row.area->a.upper});
  }
  std::vector<Drawing> drawings;
  for (const ForestPlot* plot : {&directed, &other}) {
    if (!plot->rows.empty()) drawings.push_back(drawForest(*plot));
  }
  return drawings;
}

}  // namespace calot::analytics
