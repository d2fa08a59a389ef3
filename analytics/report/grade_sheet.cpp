// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/grade_sheet.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "analytics/assessment/norm.h"
#include "analytics/report/figure_number.h"
#include "analytics/report/plots.h"
#include "analytics/report/terminal_text.h"

namespace calot::analytics {
namespace {

std::string nameOf(const GradedFigure& f) {
  if (f.mark.metric) return f.mark.checkpoint + " (external)";
  return figureName(f.mark.checkpoint, f.mark.subject);
}

ValueTree treeOf(const GradedFigure& f) {
  const auto number = [&](const std::optional<double>& si) { return si ? std::optional(*si * f.displayFactor) : si; };
  ValueTree moments = ValueTree::array(), history = ValueTree::array();
  for (const Moment& m : f.moments.moments) moments.push_back({{"begin", m.begin}, {"end", m.end}, {"share", m.share}});
  for (const HistoryPoint& p : f.history)
    history.push_back({{"attempt", p.attempt}, {"start_utc", p.startUtc}, {"value", p.value}});
  return {{"checkpoint", f.mark.checkpoint},
          {"subject", f.mark.subject},
          {"unit", f.unit},
          {"direction", analytics::nameOf(f.mark.direction)},
          {"value", number(f.value)},
          {"not_judged", f.missing},
          {"cut", number(f.mark.cut)},
          {"cut_lower", number(f.mark.lower)},
          {"cut_upper", number(f.mark.upper)},
          {"log_scale", f.mark.logScale},
          {"in_rule", f.mark.inRule},
          {"passed", f.passed},
          {"open", f.open},
          {"simulation_lower", number(f.interval ? f.interval->lower : std::nullopt)},
          {"simulation_upper", number(f.interval ? f.interval->upper : std::nullopt)},
          {"no_simulation_interval", f.interval ? f.interval->reason : "none was worked out"},
          {"undecided", f.undecided},
          {"within_standard_error", f.near},
          {"standard_error_people", f.error ? std::optional(f.error->people) : std::nullopt},
          {"percentile", f.rank ? std::optional(*f.rank) : std::nullopt},
          {"no_percentile", f.rank.reason()},
          {"competent_members", f.competent},
          {"moments", moments},
          {"no_moments", f.moments.none},
          {"history", history},
          {"plateau", f.curve ? std::optional(f.curve->plateau) : std::nullopt},
          {"no_curve", f.curve.reason()}};
}

std::string title(const Grade& g) {
  return fmt::format("Grade sheet: attempt {} against norm {} {}", g.attempt.uuid.substr(0, 8), g.norm.name,
                     g.norm.version);
}

bool synthetic(const Grade& g) { return g.attempt.synthetic || g.norm.synthetic; }

std::vector<std::string> opening(const Grade& g) {
  std::vector<std::string> lines{useOf(g.norm), g.verdict};
  // Critical errors are in the verdict.
  lines.insert(lines.end(), g.safety.begin() + (g.criticalErrors.value_or(0.0) > 0.0 ? 1 : 0), g.safety.end());
  lines.push_back(
      fmt::format("Attempt {} by {} on {}: {}, {}, {}.", g.attempt.uuid,
                  g.attempt.participant.empty() ? recorder::wordFor(g.attempt.operatorKind) : g.attempt.participant,
                  g.attempt.startUtc.empty() ? "an unknown day" : g.attempt.startUtc, g.attempt.comparabilityKey,
                  recorder::wordFor(g.attempt.outcome), analytics::nameOf(g.attempt.verification.verdict)));
  lines.push_back(fmt::format("Rule of the norm ({}): {}", g.norm.judgedBy, ruleText(g.norm)));
  return lines;
}

// Texts of cells.
std::string unitText(const ValueTree& unit) { return unit == "1" ? "" : plain(unit); }
std::string markText(const ValueTree& f) {
  return f["cut_lower"].is_null() ? "-"
                                  : fmt::format("[{}, {}]", figure4(f["cut_lower"], f), figure4(f["cut_upper"], f));
}
std::string percentileText(const ValueTree& rank) {
  return rank.is_null() ? "-" : fmt::format("{:.0f}", rank.get<double>());
}
std::string passedText(const ValueTree& f) {
  if (f["passed"].is_null()) return "-";
  return fmt::format("{}{}{}{}", f["passed"] == true ? "yes" : "no", f["within_standard_error"] == true ? ", near" : "",
                     f["open"] == true ? ", open" : "", f["undecided"] == true ? ", undecided" : "");
}

/// The simulation's interval; empty where none was worked out.
std::string simulationText(const GradedFigure& f, const ValueTree& tree) {
  if (!f.interval) return "";
  if (!f.interval->lower) return "not known";
  if (*f.interval->lower == *f.interval->upper) return "exact";
  return fmt::format("[{}, {}]", figure4(tree["simulation_lower"], tree), figure4(tree["simulation_upper"], tree));
}

/// @param titled figures by their titles, for people; else by the names that options take
ReportTable figuresTable(const Grade& g, bool titled = false) {
  ValueTree rows = ValueTree::array();
  for (const GradedFigure& f : g.figures) {
    ValueTree& row = rows.emplace_back(treeOf(f));
    row["simulation"] = simulationText(f, row);
    row["rule"] = f.mark.inRule ? "counts" : "";
    row["name"] = titled ? figureName(f.title, f.mark.subject.empty() ? "" : "(" + f.mark.subject + ")") : nameOf(f);
  }
  ReportTable table = tableOf("Figures", rows,
                              {{titled ? "=figure" : "=checkpoint", "/name", plain},
                               {"=unit", "/unit", unitText},
                               {"=better", "/direction", plain},
                               {"value", "/value", figure4},
                               {"simulation", "/simulation", plain},
                               {"pass mark", "/cut", figure4},
                               {"95 %", "", markText},
                               {"=passed", "", passedText},
                               {"=rule", "/rule", plain},
                               {"percentile", "/percentile", percentileText}});
  table.leastNeeded = {"percentile", "95 %", "simulation", "better", "rule", "unit"};
  return table;
}

/// Gaps of the figures, a line for each reason: "path-length left, path-length right: no percentile, 3 members".
std::vector<std::string> gaps(const Grade& g) {
  std::vector<std::pair<std::string, std::string>> namesOf;  // by reason
  const auto add = [&](const GradedFigure& f, const std::string& reason) {
    const auto same = [&](const auto& entry) { return entry.first == reason; };
    const auto known = std::find_if(namesOf.begin(), namesOf.end(), same);
    if (known == namesOf.end()) {
      namesOf.emplace_back(reason, nameOf(f));
    } else {
      known->second += ", " + nameOf(f);
    }
  };
  for (const GradedFigure& f : g.figures) {
    if (!f.missing.empty()) add(f, "not judged, " + f.missing);
    if (f.value && f.passed && !f.rank) add(f, "no percentile, " + f.rank.reason());
  }
  std::vector<std::string> lines;
  lines.reserve(namesOf.size());
  for (const auto& [reason, names] : namesOf) lines.push_back(fmt::format("{}: {}.", names, reason));
  return lines;
}

std::vector<std::string> notes(const Grade& g) {
  std::vector<std::string> lines{
      "pass mark: the value at which an attempt passes, from contrasting groups with its bootstrap interval, or fixed "
      "by a person without one. open: the value lies within that interval. near: the value lies within one standard "
      "error of the mark: that of measurement, from the repeated attempts of five people or more, else that of the "
      "mark "
      "itself. percentile: among the competent members; higher is better."};
  if (std::any_of(g.figures.begin(), g.figures.end(), [](const GradedFigure& f) { return f.interval.has_value(); })) {
    lines.emplace_back(
        "simulation: where the value would lie in an exact simulation with the right constants. undecided: the pass "
        "mark lies within this range, so this simulation does not decide the figure. exact: no simulation changes it. "
        "not known: one of the runs has no such figure.");
  }
  for (const GradedFigure& f : g.figures) {
    if (f.mark.metric)
      lines.push_back(fmt::format("{}: computed by a script of the site, version {}, SHA-256 {}.", nameOf(f),
                                  f.mark.version, f.mark.metric->sha256));
  }
  for (std::string& warning : normWarnings(g.norm)) lines.push_back(std::move(warning));
  for (std::string& line : gaps(g)) lines.push_back(std::move(line));
  lines.insert(lines.end(), g.remarks.begin(), g.remarks.end());
  return lines;
}

std::string momentText(const Moment& m) {
  return fmt::format("{} to {} ({:.0f} % of it)", timeText(m.begin), timeText(m.end), 100.0 * m.share);
}

/// @param recording its file name; empty: no link
TextSpan link(const std::string& recording, std::string text, double begin, double end) {
  if (recording.empty()) return {std::move(text), {}};
  return {std::move(text), fmt::format("{}#t={:.2f},{:.2f}", recording, begin, end)};
}

/// Critical and major errors, the gravest first.
std::vector<ErrorLine> graveErrors(const Grade& g) {
  std::vector<ErrorLine> grave;
  for (const ErrorLine& error : g.errors) {
    if (error.severity != Severity::minor) grave.push_back(error);
  }
  return grave;
}

std::string errorWords(const ErrorLine& error) {
  return std::string(analytics::nameOf(error.severity)) + ", " + error.counted();
}

/// The weak figures with their moments, or the reason why there are none.
std::vector<Paragraph> weakFigures(const Grade& g, const std::string& recording) {
  std::vector<Paragraph> items;
  if (!g.momentsMissing.empty()) {
    if (std::any_of(g.figures.begin(), g.figures.end(), [](const GradedFigure& f) { return f.weak(); }))
      items.push_back({{"weak figures: no moments, " + g.momentsMissing, {}}});
    return items;
  }
  for (const GradedFigure& f : g.figures) {
    if (!f.weak()) continue;
    Paragraph& item = items.emplace_back(Paragraph{{nameOf(f) + ": ", {}}});
    for (const Moment& m : f.moments.moments) {
      if (item.size() > 1) item.push_back({", ", {}});
      item.push_back(link(recording, momentText(m), m.begin, m.end));
    }
    if (item.size() == 1) item.push_back({"no moments, " + f.moments.none, {}});
  }
  return items;
}

std::vector<std::string> momentLines(const Grade& g) {
  std::vector<std::string> lines;
  for (const ErrorLine& error : graveErrors(g)) lines.push_back(errorWords(error) + ": " + timeText(error.time));
  for (const Paragraph& item : weakFigures(g, {})) {
    std::string& line = lines.emplace_back();
    for (const TextSpan& part : item) line += part.text;
  }
  return lines;
}

ReportTable historyTable(const Grade& g) {
  ReportTable table = tableOf("History", {"=checkpoint", "=unit", "attempts", "first", "this", "plateau", "se"});
  for (const GradedFigure& f : g.figures) {
    if (f.history.size() < 2) continue;
    const CheckpointDefinition* const definition = f.mark.metric ? nullptr : findCheckpoint(f.mark.checkpoint);
    table.rows.push_back(
        {nameOf(f), f.unit == "1" ? "" : f.unit, fmt::format("{}", f.history.size()),
         figureNumber(definition, f.history.front().value), figureNumber(definition, f.history.back().value),
         f.curve ? significant(f.curve->plateau) : "-", f.curve ? significant(f.curve->plateauError) : "-"});
  }
  return table;
}

constexpr const char* curveNote =
    "History: the participant's attempts of the same comparability key up to this one, by their start. plateau: of the "
    "curve a - b / x by least squares over the number x of the attempt, with its standard error.";

void addMomentsTo(ReportDocument& document, const Grade& g, const std::string& recording,
                  const std::string& howToDraw) {
  BulletList list;
  for (const ErrorLine& error : graveErrors(g))
    list.items.push_back(
        {{errorWords(error) + ": ", {}}, link(recording, timeText(error.time), error.time, error.time + 1.0)});
  for (Paragraph& item : weakFigures(g, recording)) list.items.push_back(std::move(item));
  if (list.items.empty()) return;
  document.parts.emplace_back(Heading{"Moments"});
  document.parts.emplace_back(std::move(list));
  if (!recording.empty())
    document.add("A link names the recording and the seconds." + (howToDraw.empty() ? "" : " " + howToDraw));
}

}  // namespace

void printGrade(const Grade& g, std::ostream& out) {
  printReport({title(g), synthetic(g), opening(g), {}}, out, [&] {
    const ReportTable history = historyTable(g);
    for (const ReportTable& table : {figuresTable(g), history}) {
      if (!table.rows.empty()) printTable(table, out);
    }
    const std::vector<std::string> moments = momentLines(g);
    if (!moments.empty()) out << "Moments\n";
    for (const std::string& line : moments) printWrapped(line, out);
    if (!moments.empty()) out << '\n';
    for (const std::string& line : notes(g)) printWrapped(line, out);
    if (!history.rows.empty()) printWrapped(curveNote, out);
  });
}

ValueTree gradeTree(const Grade& g) {
  const auto [competent, others] = passRates(g.norm);
  ValueTree tree{{"synthetic", synthetic(g)},
                 {"use", g.norm.evidence.empty() ? "formative" : "evidence attached"},
                 {"use_text", useOf(g.norm)},
                 {"attempt", g.attempt.uuid},
                 {"participant", g.attempt.participant},
                 {"norm", {{"name", g.norm.name}, {"version", g.norm.version}, {"judged_by", g.norm.judgedBy}}},
                 {"critical_errors", g.criticalErrors},
                 {"critical_errors_missing", g.criticalMissing},
                 {"safety", g.safety},
                 {"errors", ValueTree::array()},
                 {"passed", g.passed},
                 {"certain", g.certain},
                 {"within_standard_error", g.near},
                 {"verdict", g.verdict},
                 {"rule", {{"figures", g.inRule}, {"needed", g.needed}, {"passed", g.passedCount}}},
                 {"pass_rate",
                  {{"competent", {competent.passed, competent.members}}, {"others", {others.passed, others.members}}}},
                 {"remarks", g.remarks},
                 {"moments_missing", g.momentsMissing},
                 {"figures", ValueTree::array()}};
  for (const ErrorLine& e : g.errors)
    tree["errors"].push_back(
        {{"severity", analytics::nameOf(e.severity)}, {"error", e.text}, {"count", e.count}, {"worst_at", e.time}});
  for (const GradedFigure& f : g.figures) tree["figures"].push_back(treeOf(f));
  return tree;
}

void addGradeAppendix(ReportDocument& document, const Grade& g, const std::string& recording,
                      const std::string& howToDraw) {
  for (const std::string& line : opening(g)) document.add(line);
  document.parts.emplace_back(figuresTable(g, true));
  addMomentsTo(document, g, recording, howToDraw);
  if (ReportTable history = historyTable(g); !history.rows.empty()) {
    document.parts.emplace_back(std::move(history));
    document.add(curveNote);
    Figures figures;
    for (const GradedFigure& f : g.figures) {
      std::vector<HistoryPlot::Value> values;
      for (const HistoryPoint& p : f.history)
        values.push_back({.attempt = static_cast<double>(values.size() + 1), .value = p.value});
      if (values.size() < 2) continue;
      std::optional<double> cut;
      if (f.mark.cut) cut = *f.mark.cut * f.displayFactor;
      if (auto plot = drawHistory({.title = nameOf(f),
                                   .axis = f.unit == "1" ? "" : f.unit,
                                   .values = std::move(values),
                                   .mark = cut,
                                   .synthetic = synthetic(g)}))
        figures.drawings.push_back(std::move(*plot));
    }
    if (!figures.drawings.empty()) document.parts.emplace_back(std::move(figures));
  }
  document.parts.emplace_back(Heading{"Notes"});
  document.addList(notes(g));
}

}  // namespace calot::analytics
