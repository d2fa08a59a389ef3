// SPDX-License-Identifier: GPL-3.0-or-later
// Times of attempts of which some were not finished.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "analytics/design/design_report.h"
#include "analytics/statistics/survival.h"
#include "recorder/base/errors.h"

namespace calot::analytics {
namespace {

using GroupTimes = std::vector<std::vector<CensoredTime>>;

GroupTimes timesByGroup(const DesignData& data, const DesignFigure& figure) {
  GroupTimes times(data.groups.size());
  for (const DesignValue& v : figure.values) times[data.people[v.person].group].push_back({v.value, v.finished});
  return times;
}

PlotSeries stepsOf(const std::string& label, std::size_t ink, const KaplanMeier& km) {
  PlotSeries series{label, ink, {{0.0, 0.0}}, true, true};
  for (const SurvivalStep& step : km.steps) series.points.emplace_back(step.time, 100.0 * (1.0 - step.unfinished));
  return series;
}

/// @param[out] plot a line for each group
ValueTree groupsTree(const DesignData& data, const GroupTimes& times, LinePlot& plot) {
  ValueTree groups = ValueTree::array();
  for (std::size_t g = 0; g < times.size(); ++g) {
    const Expected<KaplanMeier> km = kaplanMeier(times[g]);
    const auto finished = std::count_if(times[g].begin(), times[g].end(), [](const auto& t) { return t.finished; });
    groups.push_back({{"group", data.groups[g]}, {"n", times[g].size()}, {"finished", finished}});
    if (!km) {
      groups.back()["reason"] = km.reason();
      continue;
    }
    groups.back().update({{"median", km->median}, {"lower", km->lower}, {"upper", km->upper}});
    plot.series.push_back(stepsOf(data.groups[g], g, *km));
  }
  return groups;
}

ValueTree worstTree(const WorstRank& worst) {
  return {{"u", worst.test.u},
          {"p", worst.test.p},
          {"exact", worst.test.exact},
          {"a", worst.effect.value.a},
          {"interval", worst.effect.a}};
}

}  // namespace

void analyseTimes(const DesignData& data, const DesignChoices& choices, DesignReport& report) {
  if (choices.attemptRule == AttemptRule::mean)
    throw Error(ErrorKind::invalid, "study: times of which some are not finished have no mean", {Remedy::takeFirst});
  const bool firstFaster = data.better != data.groups[1];
  ValueTree& results = analyseFigures(data, report, [&](const DesignFigure& figure) {
    const GroupTimes times = timesByGroup(data, figure);
    const Expected<LogRank> test = logRank(times[0], times[1]);
    if (!test) return Expected<ValueTree>(NoResult{test.reason()});
    LinePlot plot{"Finished: " + figure.name, "%", figure.unit.empty() ? "time" : figure.unit, {}, {}, data.synthetic};
    const Expected<WorstRank> worst =
        worstRank(times[0], times[1], firstFaster ? Hypothesis::firstSmaller : Hypothesis::firstLarger);
    ValueTree result{
        {"groups", groupsTree(data, times, plot)},
        {"log_rank", {{"observed", test->observed}, {"expected", test->expected}, {"z", test->z}, {"p", test->p}}},
        {"worst_rank", treeOf(worst, worstTree)}};
    if (std::optional<Drawing> drawing = drawLines(plot)) report.drawings.push_back(std::move(*drawing));
    return Expected<ValueTree>(std::move(result));
  });
  addHolm(results, "/log_rank");
  ReportTable groups =
      tableOf("Finished, and median time by Kaplan and Meier", {"=figure", "=group", "n", "finished", "median [95 %]"});
  for (const ValueTree& row : results) {
    std::string title = figureTitle(row);
    for (const ValueTree& group : row["groups"])
      groups.rows.push_back(
          {std::exchange(title, ""), group["group"], plain(group["n"]), plain(group["finished"]), medianText(group)});
  }
  report.tables = {std::move(groups), tableOf("Comparison", results,
                                              {{"=figure", "", figureTitle},
                                               {"observed", "/log_rank/observed", digits4},
                                               {"expected", "/log_rank/expected", digits4},
                                               {"z", "/log_rank/z", signed2},
                                               {"p, log-rank", "/log_rank/p", pValue},
                                               {"Holm", "/log_rank/p_holm", pValue},
                                               {"A, worst rank", "/worst_rank/a", share3},
                                               {"95 %", "/worst_rank/interval", range4},
                                               {"p, worst rank", "/worst_rank/p", pValue}})};
  report.notes.push_back(fmt::format(
      "Observed and expected: attempts of {} that finished, and how many would have at one rate for both groups; z: "
      "positive where {} finishes sooner.",
      data.groups[0], data.groups[0]));
  report.notes.emplace_back(
      "The log-rank test takes an unfinished attempt as followed until its end: right for time limits and failures of "
      "the equipment, not for those who gave up because they were slow. Worst rank puts every unfinished attempt "
      "behind "
      "all others: right where not to finish is the worst result.");
  report.notes.push_back(fmt::format("A: chance that a participant of {} is faster than one of {}.",
                                     data.groups[firstFaster ? 0 : 1], data.groups[firstFaster ? 1 : 0]));
  report.methods =
      "Times were compared by the log-rank test with unfinished attempts censored, and by the rank test with "
      "unfinished "
      "attempts ranked behind all others. Medians are those of Kaplan and Meier with intervals by the log-log "
      "transformation.";
}

}  // namespace calot::analytics
