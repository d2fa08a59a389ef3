// SPDX-License-Identifier: GPL-3.0-or-later
// Learning over attempts: curves by group, attempts to a criterion; and times of which some were not finished.

#include <fmt/format.h>
#include <algorithm>
#include <map>
#include <utility>

#include "analytics/design/design_report.h"
#include "analytics/report/study_population.h"
#include "analytics/statistics/resampling.h"
#include "analytics/statistics/survival.h"
#include "recorder/base/errors.h"

namespace calot::analytics {
namespace {

constexpr std::size_t curveResamples = 1999, mostWithIntervals = 6;

/// A participant's values over the number of the attempt.
struct PersonalCourse {
  std::vector<double> attempt, value;
};

struct GroupCurve {
  std::vector<double> attempt, mean;  ///< attempts that at least half of the participants made
  std::size_t participants = 0, attempts = 0;
  Expected<LearningCurve> curve = NoResult{"not computed"};
  /// Interval of the plateau: percentile bootstrap over participants, each with all attempts.
  Expected<Interval> plateau = NoResult{"not computed"};
};

using AttemptMeans = std::map<double, std::pair<double, std::size_t>>;  // sum and number, by attempt

void addCourse(AttemptMeans& means, const PersonalCourse& course) {
  for (std::size_t i = 0; i < course.attempt.size(); ++i) {
    auto& [sum, count] = means[course.attempt[i]];
    sum += course.value[i];
    ++count;
  }
}

/// Means of the attempts that at least half of `people` made.
void keepCommon(const AttemptMeans& means, std::size_t people, GroupCurve& curve) {
  for (const auto& [attempt, of] : means) {
    if (2 * of.second < people) continue;
    curve.attempt.push_back(attempt);
    curve.mean.push_back(of.first / static_cast<double>(of.second));
  }
}

/// Curve through the means of each attempt. Values of one participant are not independent, so the fit's own errors are
/// not used. @param resamples 0: no interval @pre courses not empty
GroupCurve groupCurve(const std::vector<PersonalCourse>& courses, std::size_t resamples) {
  GroupCurve result;
  AttemptMeans means;
  std::vector<double> indices;
  for (const PersonalCourse& course : courses) {
    addCourse(means, course);
    indices.push_back(static_cast<double>(indices.size()));
    result.attempts += course.attempt.size();
  }
  result.participants = courses.size();
  keepCommon(means, courses.size(), result);
  result.curve = fitLearningCurve(result.attempt, result.mean);
  if (!result.curve || resamples == 0) return result;
  if (courses.size() < 3) {
    result.plateau = NoResult{"fewer than three participants"};
    return result;
  }
  const auto plateauOf = [&](std::span<const double> drawn) -> Expected<double> {
    AttemptMeans sums;
    for (const double index : drawn) addCourse(sums, courses[static_cast<std::size_t>(index)]);
    GroupCurve resampled;
    keepCommon(sums, drawn.size(), resampled);
    const Expected<LearningCurve> curve = fitLearningCurve(resampled.attempt, resampled.mean);
    return curve ? Expected<double>(curve->plateau) : NoResult{curve.reason()};
  };
  BootstrapOptions options;
  options.resamples = resamples;
  const Expected<Bootstrap> interval = bootstrap(indices, plateauOf, options);
  result.plateau = interval ? Expected<Interval>(interval->interval) : NoResult{interval.reason()};
  return result;
}

using Courses = std::map<std::size_t, PersonalCourse>;  ///< by person

Courses coursesOf(const DesignFigure& figure) {
  Courses courses;
  for (const DesignValue& v : figure.values) {
    courses[v.person].attempt.push_back(v.order);
    courses[v.person].value.push_back(v.value);
  }
  return courses;
}

std::size_t groupsIn(const DesignData& data) { return std::max<std::size_t>(data.groups.size(), 1); }

std::string groupTitle(const DesignData& data, std::size_t g) {
  return data.groups.empty() ? std::string("all") : data.groups[g];
}

ValueTree curveTree(const DesignData& data, const DesignFigure& figure, std::size_t g, const GroupCurve& c) {
  ValueTree tree{{"figure", figure.name},
                 {"unit", figure.unit},
                 {"group", groupTitle(data, g)},
                 {"participants", c.participants},
                 {"attempts", c.attempts},
                 {"attempt", c.attempt},
                 {"mean", c.mean}};
  if (!c.curve) {
    tree["reason"] = c.curve.reason();
    return tree;
  }
  tree.update({{"plateau", c.curve->plateau},
               {"gap", c.curve->gap},
               {"sigma", c.curve->sigma},
               {"plateau_interval", c.plateau}});
  return tree;
}

void addCurve(LinePlot& plot, const std::string& group, std::size_t g, const GroupCurve& c) {
  PlotSeries points{group, g, {}, false, false}, line{"", g, {}, true, false};
  for (std::size_t i = 0; i < c.attempt.size(); ++i) points.points.emplace_back(c.attempt[i], c.mean[i]);
  constexpr int pieces = 40;
  for (int i = 0; i <= pieces; ++i) {
    const double x = c.attempt.front() + (c.attempt.back() - c.attempt.front()) * i / pieces;
    line.points.emplace_back(x, c.curve->at(x));
  }
  plot.series.push_back(std::move(points));
  plot.series.push_back(std::move(line));
}

std::string lastOf(const ValueTree& attempts) { return digits4(attempts.back()); }

/// @returns how many curves could be fitted
std::size_t addCurves(const DesignData& data, const DesignChoices& choices, DesignReport& report) {
  ValueTree curves = ValueTree::array(), fitted = ValueTree::array();
  for (const DesignFigure& figure : data.figures) {
    const Courses courses = coursesOf(figure);
    LinePlot plot{figure.name, figure.unit, data.occasionWord, {}, {}, data.synthetic};
    if (choices.criterion) plot.marks.push_back(*choices.criterion);
    for (std::size_t g = 0; g < groupsIn(data); ++g) {
      std::vector<PersonalCourse> of;
      for (const auto& [person, course] : courses) {
        if (data.people[person].group == g) of.push_back(course);
      }
      if (of.empty()) continue;
      const GroupCurve c = groupCurve(of, data.figures.size() <= mostWithIntervals ? curveResamples : 0);
      curves.push_back(curveTree(data, figure, g, c));
      if (!c.curve) {
        report.refused.emplace_back(fmt::format("the curve of {}, {}", figure.name, groupTitle(data, g)),
                                    c.curve.reason());
        continue;
      }
      fitted.push_back(curves.back());
      addCurve(plot, groupTitle(data, g), g, c);
    }
    if (std::optional<Drawing> drawing = drawLines(plot)) report.drawings.push_back(std::move(*drawing));
  }
  report.json["curves"] = std::move(curves);
  if (!fitted.empty())
    report.tables.push_back(tableOf("Curves a - b / x through the groups' means", fitted,
                                    {{"=figure", "", figureTitle},
                                     {"=group", "/group", plain},
                                     {"participants", "/participants", plain},
                                     {"attempts", "/attempts", plain},
                                     {"up to", "/attempt", lastOf},
                                     {"plateau a", "/plateau", digits4},
                                     {"95 %", "/plateau_interval", range4},
                                     {"gap b", "/gap", digits4}}));
  return fitted.size();
}

void addCriterion(const DesignData& data, const DesignChoices& choices, const DesignFigure& figure, Better better,
                  DesignReport& report) {
  std::vector<std::vector<CensoredTime>> times(groupsIn(data));
  for (const auto& [person, course] : coursesOf(figure))
    times[data.people[person].group].push_back(
        attemptsToCriterion(course.value, *choices.criterion, better, choices.run));
  ValueTree groups = ValueTree::array();
  for (std::size_t g = 0; g < times.size(); ++g) {
    const Expected<KaplanMeier> km = kaplanMeier(times[g]);
    groups.push_back({{"group", groupTitle(data, g)},
                      {"participants", times[g].size()},
                      {"reached", km ? km->finished : 0},
                      {"median", km ? km->median : std::nullopt},
                      {"lower", km ? km->lower : std::nullopt},
                      {"upper", km ? km->upper : std::nullopt}});
  }
  report.tables.push_back(
      tableOf(fmt::format("Attempts until {} is {} {}{}", figure.name, better == Better::lower ? "at most" : "at least",
                          significant(*choices.criterion),
                          choices.run > 1 ? fmt::format(", {} in a row", choices.run) : std::string()),
              groups,
              {{"=group", "/group", plain},
               {"participants", "/participants", plain},
               {"reached it", "/reached", plain},
               {"median [95 %]", "",
                [](const ValueTree& g) { return g["reached"] == 0 ? std::string("-") : medianText(g); }}}));
  ValueTree json{
      {"figure", figure.name}, {"criterion", *choices.criterion}, {"run", choices.run}, {"groups", std::move(groups)}};
  if (times.size() == 2) {
    const Expected<LogRank> test = logRank(times[0], times[1]);
    report.notes.push_back(
        test ? fmt::format("Attempts to the criterion, log-rank: z {:+.2f} (positive: {} sooner), p {}.", test->z,
                           data.groups[0], pText(test->p))
             : fmt::format("Attempts to the criterion were not compared: {}.", test.reason()));
    json["log_rank"] = treeOf(test, [](const LogRank& r) { return ValueTree{{"z", r.z}, {"p", r.p}}; });
  }
  report.json["to_criterion"] = json;
}

}  // namespace

void analyseLearning(const DesignData& data, const DesignChoices& choices, DesignReport& report) {
  if (std::all_of(data.figures.begin(), data.figures.end(), [](const DesignFigure& f) { return f.values.empty(); }))
    askForResults(data, report, 0);
  if (choices.criterion && data.figures.size() != 1)
    throw Error(ErrorKind::invalid, Where{data.where},
                fmt::format("a criterion applies to one figure; there are {}", data.figures.size()),
                {Remedy::nameFamily});
  const std::size_t fitted = addCurves(data, choices, report);
  if (!choices.criterion) askForResults(data, report, fitted);
  report.methods = fmt::format(
      "Curves a - b / x were fitted by least squares to the groups' means of each attempt that at least half of the "
      "participants made{}.",
      data.figures.size() <= mostWithIntervals
          ? "; intervals of the plateau are percentile bootstraps of 1,999 resamples of participants (seed 1)"
          : "");
  if (data.figures.size() > mostWithIntervals)
    report.notes.push_back(fmt::format("Intervals of the plateau are given for up to {} figures.", mostWithIntervals));
  if (choices.criterion) {
    const DesignFigure& figure = data.figures[0];
    if (figure.direction == Direction::none)
      throw Error(ErrorKind::refused, Where{data.where},
                  fmt::format("which values of {} are better, lower or higher, is not known", figure.name));
    const Better better = figure.direction == Direction::lower ? Better::lower : Better::higher;
    addCriterion(data, choices, figure, better, report);
    report.methods +=
        " Attempts to the criterion were censored for those who did not reach it, with Kaplan-Meier medians.";
    if (groupsIn(data) == 2) report.methods += " Groups were compared by the log-rank test.";
  }
  report.notes.emplace_back("An attempt without a value of the figure is passed over.");
}

namespace {

using GroupTimes = std::vector<std::vector<CensoredTime>>;

/// @param ranked without censored attempts
GroupTimes timesByGroup(const DesignData& data, const DesignFigure& figure, bool ranked) {
  GroupTimes times(data.groups.size());
  for (const DesignValue& v : figure.values) {
    if (v.ended || !ranked) times[data.people[v.person].group].push_back({v.value, v.finished});
  }
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
  const Hypothesis hypothesis =
      hypothesisOf(Direction::lower, data.better, data.groups).value_or(Hypothesis::firstLarger);
  ValueTree& results = analyseFigures(data, report, [&](const DesignFigure& figure) {
    const GroupTimes times = timesByGroup(data, figure, false), ranked = timesByGroup(data, figure, true);
    const Expected<LogRank> test = logRank(times[0], times[1]);
    if (!test) return Expected<ValueTree>(NoResult{test.reason()});
    LinePlot plot{"Finished: " + figure.name, "%", figure.unit.empty() ? "time" : figure.unit, {}, {}, data.synthetic};
    const Expected<WorstRank> worst = worstRank(ranked[0], ranked[1], hypothesis);
    ValueTree result{
        {"groups", groupsTree(data, times, plot)},
        {"log_rank", {{"observed", test->observed}, {"expected", test->expected}, {"z", test->z}, {"p", test->p}}},
        {"worst_rank", treeOf(worst, worstTree)},
        {"not_ranked", times[0].size() + times[1].size() - ranked[0].size() - ranked[1].size()}};
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
  const bool firstFaster = hypothesis == Hypothesis::firstSmaller;
  report.notes.push_back(data.better.empty()
                             ? fmt::format("A: chance that a participant of {} takes longer than one of {}.",
                                           data.groups[0], data.groups[1])
                             : fmt::format("A: chance that a participant of {} is faster than one of {}.",
                                           data.groups[firstFaster ? 0 : 1], data.groups[firstFaster ? 1 : 0]));
  for (const ValueTree& row : results) {
    if (row["not_ranked"] != 0)
      report.notes.push_back(fmt::format("{}: {} attempts whose motion file only ends are censored, and have no rank.",
                                         figureTitle(row), plain(row["not_ranked"])));
  }
  report.methods =
      "Times were compared by the log-rank test with unfinished attempts censored, and by the rank test with "
      "unfinished "
      "attempts ranked behind all others. Medians are those of Kaplan and Meier with intervals by the log-log "
      "transformation.";
}

}  // namespace calot::analytics
