// SPDX-License-Identifier: GPL-3.0-or-later
// Times of attempts of which some were not finished.
#include <fmt/format.h>

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

std::string medianText(const KaplanMeier& km) {
  const auto end = [](const std::optional<double>& v) { return v ? significant(*v) : std::string("-"); };
  return km.median ? fmt::format("{} [{}, {}]", significant(*km.median), end(km.lower), end(km.upper)) : "not reached";
}

PlotSeries stepsOf(const std::string& label, std::size_t ink, const KaplanMeier& km) {
  PlotSeries series{label, ink, {{0.0, 0.0}}, true, true};
  for (const SurvivalStep& step : km.steps) series.points.emplace_back(step.time, 100.0 * (1.0 - step.unfinished));
  return series;
}

void addGroupRows(const DesignData& data, const DesignFigure& figure, const GroupTimes& times, ReportTable& table,
                  LinePlot& plot, DesignJson& json) {
  json = DesignJson::array();
  for (std::size_t g = 0; g < times.size(); ++g) {
    const Expected<KaplanMeier> km = kaplanMeier(times[g]);
    std::size_t finished = 0;
    for (const CensoredTime& t : times[g]) finished += t.finished ? 1 : 0;
    table.rows.push_back({g == 0 ? figureTitle(figure) : "", data.groups[g], fmt::format("{}", times[g].size()),
                          fmt::format("{}", finished), km ? medianText(*km) : km.reason()});
    json.push_back({{"group", data.groups[g]}, {"n", times[g].size()}, {"finished", finished}});
    if (!km) {
      json.back()["reason"] = km.reason();
      continue;
    }
    json.back()["median"] = optionalJson(km->median);
    json.back()["lower"] = optionalJson(km->lower);
    json.back()["upper"] = optionalJson(km->upper);
    plot.series.push_back(stepsOf(data.groups[g], g, *km));
  }
}

DesignJson worstJson(const Expected<WorstRank>& worst) {
  if (!worst) return reasonJson(worst.reason());
  return {{"u", worst->test.u},
          {"p", worst->test.p},
          {"exact", worst->test.exact},
          {"a", worst->effect.value.a},
          {"interval", intervalJson(worst->effect.a)}};
}

}  // namespace

void analyseTimes(const DesignData& data, const DesignChoices& choices, DesignReport& report) {
  if (choices.attemptRule == AttemptRule::mean)
    throw Error(ErrorKind::invalid, "study: times of which some are not finished have no mean", {Remedy::takeFirst});
  ReportTable groups =
      tableOf("Finished, and median time by Kaplan and Meier", {"=figure", "=group", "n", "finished", "median [95 %]"});
  ReportTable tests = tableOf("Comparison", {"=figure", "observed", "expected", "z", "p, log-rank", "Holm",
                                             "A, worst rank", "95 %", "p, worst rank"});
  std::vector<std::pair<std::string, std::string>> refused;
  std::vector<std::optional<double>> p;
  report.json["results"] = DesignJson::array();
  for (const DesignFigure& figure : data.figures) {
    const GroupTimes times = timesByGroup(data, figure);
    const Expected<LogRank> test = logRank(times[0], times[1]);
    if (!test) {
      refused.emplace_back(figure.name, test.reason());
      continue;
    }
    LinePlot plot{"Finished: " + figure.name, "%", figure.unit.empty() ? "time" : figure.unit, {}, {}, data.synthetic};
    DesignJson json;
    addGroupRows(data, figure, times, groups, plot, json);
    const bool firstFaster = data.better != data.groups[1];
    const Expected<WorstRank> worst =
        worstRank(times[0], times[1], firstFaster ? Hypothesis::firstSmaller : Hypothesis::firstLarger);
    tests.rows.push_back({figureTitle(figure), significant(test->observed), significant(test->expected),
                          fmt::format("{:+.2f}", test->z), pText(test->p), "",
                          worst ? fmt::format("{:.3f}", worst->effect.value.a) : "-",
                          worst ? intervalText(worst->effect.a) : "-", worst ? pText(worst->test.p) : "-"});
    p.emplace_back(test->p);
    report.json["results"].push_back(
        {{"figure", figure.name},
         {"unit", figure.unit},
         {"groups", json},
         {"log_rank", {{"observed", test->observed}, {"expected", test->expected}, {"z", test->z}, {"p", test->p}}},
         {"worst_rank", worstJson(worst)}});
    if (std::optional<Drawing> drawing = drawLines(plot)) report.drawings.push_back(std::move(*drawing));
  }
  askForResults(data, p.size(), refused);
  const std::vector<std::optional<double>> adjusted = holmOver(p);
  for (std::size_t i = 0; i < p.size(); ++i) {
    tests.rows[i][5] = pOrDash(adjusted[i]);
    report.json["results"][i]["log_rank"]["p_holm"] = optionalJson(adjusted[i]);
  }
  report.tables = {std::move(groups), std::move(tests)};
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
                                     data.better == data.groups[1] ? data.groups[1] : data.groups[0],
                                     data.better == data.groups[1] ? data.groups[0] : data.groups[1]));
  noteRefused(report, refused);
  report.methods =
      "Times were compared by the log-rank test with unfinished attempts censored, and by the rank test with "
      "unfinished "
      "attempts ranked behind all others. Medians are those of Kaplan and Meier with intervals by the log-log "
      "transformation.";
}

}  // namespace calot::analytics
