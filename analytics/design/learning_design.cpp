// SPDX-License-Identifier: GPL-3.0-or-later
// Learning over attempts: curves by group, attempts to a criterion.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "analytics/design/design_report.h"
#include "analytics/design/learning_curves.h"
#include "analytics/statistics/survival.h"
#include "recorder/base/errors.h"

namespace calot::analytics {
namespace {

constexpr std::size_t curveResamples = 1999, mostWithIntervals = 6;

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

DesignJson curveJson(const DesignData& data, const DesignFigure& figure, std::size_t g, const GroupCurve& c) {
  DesignJson json{{"figure", figure.name},
                  {"unit", figure.unit},
                  {"group", groupTitle(data, g)},
                  {"participants", c.participants},
                  {"attempts", c.attempts},
                  {"attempt", c.attempt},
                  {"mean", c.mean}};
  if (!c.curve) {
    json["reason"] = c.curve.reason();
    return json;
  }
  json["plateau"] = c.curve->plateau;
  json["gap"] = c.curve->gap;
  json["sigma"] = c.curve->sigma;
  json["plateau_interval"] = c.plateau ? intervalJson(*c.plateau) : reasonJson(c.plateau.reason());
  return json;
}

/// @returns how many curves could be fitted
std::size_t addCurves(const DesignData& data, const DesignChoices& choices, DesignReport& report,
                      std::vector<std::pair<std::string, std::string>>& refused) {
  ReportTable table = tableOf("Curves a - b / x through the groups' means",
                              {"=figure", "=group", "participants", "attempts", "up to", "plateau a", "95 %", "gap b"});
  report.json["curves"] = DesignJson::array();
  std::size_t fitted = 0;
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
      report.json["curves"].push_back(curveJson(data, figure, g, c));
      if (!c.curve) {
        refused.emplace_back(fmt::format("the curve of {}, {}", figure.name, groupTitle(data, g)), c.curve.reason());
        continue;
      }
      ++fitted;
      table.rows.push_back({figureTitle(figure), groupTitle(data, g), fmt::format("{}", c.participants),
                            fmt::format("{}", c.attempts), significant(c.attempt.back()), significant(c.curve->plateau),
                            intervalText(c.plateau), significant(c.curve->gap)});
      PlotSeries points{groupTitle(data, g), g, {}, false, false}, line{"", g, {}, true, false};
      for (std::size_t i = 0; i < c.attempt.size(); ++i) points.points.emplace_back(c.attempt[i], c.mean[i]);
      constexpr int pieces = 40;
      for (int i = 0; i <= pieces; ++i) {
        const double x = c.attempt.front() + (c.attempt.back() - c.attempt.front()) * i / pieces;
        line.points.emplace_back(x, c.curve->at(x));
      }
      plot.series.push_back(std::move(points));
      plot.series.push_back(std::move(line));
    }
    if (std::optional<Drawing> drawing = drawLines(plot)) report.drawings.push_back(std::move(*drawing));
  }
  if (!table.rows.empty()) report.tables.push_back(std::move(table));
  return fitted;
}

void addCriterion(const DesignData& data, const DesignChoices& choices, const DesignFigure& figure,
                  const Courses& courses, Better better, DesignReport& report) {
  std::vector<std::vector<CensoredTime>> times(groupsIn(data));
  for (const auto& [person, course] : courses)
    times[data.people[person].group].push_back(
        attemptsToCriterion(course.value, *choices.criterion, better, choices.run));
  ReportTable table =
      tableOf(fmt::format("Attempts until {} is {} {}{}", figure.name, better == Better::lower ? "at most" : "at least",
                          significant(*choices.criterion),
                          choices.run > 1 ? fmt::format(", {} in a row", choices.run) : std::string()),
              {"=group", "participants", "reached it", "median [95 %]"});
  DesignJson json{{"figure", figure.name},
                  {"criterion", *choices.criterion},
                  {"run", choices.run},
                  {"groups", DesignJson::array()}};
  for (std::size_t g = 0; g < times.size(); ++g) {
    const Expected<KaplanMeier> km = kaplanMeier(times[g]);
    const auto end = [](const std::optional<double>& v) { return v ? significant(*v) : std::string("-"); };
    table.rows.push_back({groupTitle(data, g), fmt::format("{}", times[g].size()),
                          fmt::format("{}", km ? km->finished : 0),
                          !km          ? "-"
                          : km->median ? fmt::format("{} [{}, {}]", end(km->median), end(km->lower), end(km->upper))
                                       : "not reached"});
    json["groups"].push_back({{"group", groupTitle(data, g)},
                              {"participants", times[g].size()},
                              {"reached", km ? km->finished : 0},
                              {"median", km ? optionalJson(km->median) : DesignJson(nullptr)},
                              {"lower", km ? optionalJson(km->lower) : DesignJson(nullptr)},
                              {"upper", km ? optionalJson(km->upper) : DesignJson(nullptr)}});
  }
  report.tables.push_back(std::move(table));
  if (times.size() == 2) {
    const Expected<LogRank> test = logRank(times[0], times[1]);
    report.notes.push_back(
        test ? fmt::format("Attempts to the criterion, log-rank: z {:+.2f} (positive: {} sooner), p {}.", test->z,
                           data.groups[0], pText(test->p))
             : fmt::format("Attempts to the criterion were not compared: {}.", test.reason()));
    json["log_rank"] = test ? DesignJson{{"z", test->z}, {"p", test->p}} : reasonJson(test.reason());
  }
  report.json["to_criterion"] = json;
}

}  // namespace

void analyseLearning(const DesignData& data, const DesignChoices& choices, DesignReport& report) {
  if (std::all_of(data.figures.begin(), data.figures.end(), [](const DesignFigure& f) { return f.values.empty(); }))
    askForResults(data, 0, {});
  if (choices.criterion && data.figures.size() != 1)
    throw Error(ErrorKind::invalid, Where{data.where},
                fmt::format("a criterion is of one figure; there are {}", data.figures.size()), {Remedy::nameFamily});
  std::vector<std::pair<std::string, std::string>> refused;
  const std::size_t fitted = addCurves(data, choices, report, refused);
  if (!choices.criterion) askForResults(data, fitted, refused);
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
    const Courses courses = coursesOf(figure);
    addCriterion(data, choices, figure, courses, better, report);
    report.methods +=
        " Attempts to the criterion were censored for those who did not reach it, with Kaplan-Meier medians.";
    if (groupsIn(data) == 2) report.methods += " Groups were compared by the log-rank test.";
  }
  report.notes.emplace_back("An attempt without a value of the figure is passed over.");
  noteRefused(report, refused);
}

}  // namespace calot::analytics
