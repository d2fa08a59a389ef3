// SPDX-License-Identifier: GPL-3.0-or-later
// Learning over attempts: curves by group, attempts to a criterion, cumulative sums by participant.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "analytics/design/design_report.h"
#include "analytics/design/learning_curves.h"
#include "analytics/statistics/cusum.h"
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

const char* formulaOf(CurveShape shape) {
  return shape == CurveShape::inverse ? "a - b / x" : shape == CurveShape::power ? "a - b x^-c" : "a - b exp(-c x)";
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
  json["rate"] = c.curve->rate;
  json["sigma"] = c.curve->sigma;
  json["plateau_interval"] = c.plateau ? intervalJson(*c.plateau) : reasonJson(c.plateau.reason());
  return json;
}

/// @returns how many curves could be fitted
std::size_t addCurves(const DesignData& data, const DesignChoices& choices, DesignReport& report,
                      std::vector<std::pair<std::string, std::string>>& refused) {
  ReportTable table = tableOf(fmt::format("Curves {} through the groups' means", formulaOf(choices.shape)),
                              {"=figure", "=group", "participants", "attempts", "up to", "plateau a", "95 %", "gap b",
                               choices.shape == CurveShape::inverse ? "" : "rate c"});
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
      const GroupCurve c = groupCurve(of, choices.shape, data.figures.size() <= mostWithIntervals ? curveResamples : 0);
      report.json["curves"].push_back(curveJson(data, figure, g, c));
      if (!c.curve) {
        refused.emplace_back(fmt::format("the curve of {}, {}", figure.name, groupTitle(data, g)), c.curve.reason());
        continue;
      }
      ++fitted;
      table.rows.push_back({figureTitle(figure), groupTitle(data, g), fmt::format("{}", c.participants),
                            fmt::format("{}", c.attempts), significant(c.attempt.back()), significant(c.curve->plateau),
                            intervalText(c.plateau), significant(c.curve->gap),
                            choices.shape == CurveShape::inverse ? "" : significant(c.curve->rate)});
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

/// The first limit that the plain sum reaches; after "acceptable" the later attempts are monitored.
struct CusumVerdict {
  std::string text;
  std::optional<std::size_t> acceptable, unacceptable, drop;  ///< attempts from 1
};

CusumVerdict verdictOf(const CusumDesign& design, const std::vector<bool>& failures, const CusumChart& chart) {
  CusumVerdict v;
  if (chart.acceptable && (!chart.unacceptable || *chart.acceptable < *chart.unacceptable)) {
    v.acceptable = *chart.acceptable + 1;
    v.text = fmt::format("acceptable at attempt {}", *v.acceptable);
    const std::vector<bool> later(failures.begin() + static_cast<std::ptrdiff_t>(*v.acceptable), failures.end());
    const CusumChart watched = cusum(design, later, CusumKind::monitoring);
    if (watched.unacceptable) {
      v.drop = *v.acceptable + *watched.unacceptable + 1;
      v.text += fmt::format("; dropped at attempt {}", *v.drop);
    }
  } else if (chart.unacceptable) {
    v.unacceptable = *chart.unacceptable + 1;
    v.text = fmt::format("not acceptable at attempt {}", *v.unacceptable);
  } else {
    v.text = "undecided";
  }
  return v;
}

void addCusum(const DesignData& data, const DesignChoices& choices, const DesignFigure& figure, const Courses& courses,
              Better better, DesignReport& report) {
  const Expected<CusumDesign> design = CusumDesign::scaled(choices.goal);
  if (!design) throw Error(ErrorKind::invalid, "study: cumulative sums: " + design.reason());
  ReportTable table = tableOf("Cumulative sums", {"=participant", "=group", "attempts", "failures", "sum", "=verdict"});
  LinePlot plot{"CUSUM: " + figure.name, "sum", data.occasionWord, {}, {design->lowerLimit(), design->upperLimit()},
                data.synthetic};
  report.json["cusum"] = {{"acceptable_rate", choices.goal.acceptable},
                          {"unacceptable_rate", choices.goal.unacceptable},
                          {"alpha", choices.goal.alpha},
                          {"beta", choices.goal.beta},
                          {"success_step", design->successStep()},
                          {"failure_step", design->failureStep()},
                          {"lower_limit", design->lowerLimit()},
                          {"upper_limit", design->upperLimit()},
                          {"participants", DesignJson::array()}};
  std::vector<bool> labelled(groupsIn(data), false);
  for (const auto& [person, course] : courses) {
    std::vector<bool> failures;
    for (const double value : course.value) failures.push_back(!meets(value, *choices.criterion, better));
    const CusumChart chart = cusum(*design, failures, CusumKind::sequential);
    const CusumVerdict verdict = verdictOf(*design, failures, chart);
    const DesignPerson& p = data.people[person];
    const auto failed = std::count(failures.begin(), failures.end(), true);
    table.rows.push_back({p.name, groupTitle(data, p.group), fmt::format("{}", failures.size()),
                          fmt::format("{}", failed), fmt::format("{:+.2f}", chart.sums.back()), verdict.text});
    const auto number = [](const std::optional<std::size_t>& n) { return n ? DesignJson(*n) : DesignJson(nullptr); };
    report.json["cusum"]["participants"].push_back({{"participant", p.name},
                                                    {"group", groupTitle(data, p.group)},
                                                    {"failures", failed},
                                                    {"sums", chart.sums},
                                                    {"acceptable_at", number(verdict.acceptable)},
                                                    {"unacceptable_at", number(verdict.unacceptable)},
                                                    {"dropped_at", number(verdict.drop)}});
    PlotSeries line{labelled[p.group] ? "" : groupTitle(data, p.group), p.group, {{0.0, 0.0}}, true, false};
    labelled[p.group] = true;
    for (std::size_t i = 0; i < chart.sums.size(); ++i)
      line.points.emplace_back(static_cast<double>(i + 1), chart.sums[i]);
    plot.series.push_back(std::move(line));
  }
  report.tables.push_back(std::move(table));
  report.notes.push_back(fmt::format(
      "Cumulative sums: failure rate {} acceptable, {} not, risks {} and {}; a success adds {}, a failure {}; at {} or "
      "less the participant is acceptable, at {} or more not. After that the sum is held at zero and watched for a "
      "drop.",
      significant(choices.goal.acceptable), significant(choices.goal.unacceptable), significant(choices.goal.alpha),
      significant(choices.goal.beta), significant(design->successStep()), significant(design->failureStep()),
      significant(design->lowerLimit()), significant(design->upperLimit())));
  if (std::optional<Drawing> drawing = drawLines(plot)) report.drawings.push_back(std::move(*drawing));
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
      "Curves {} were fitted by least squares to the groups' means of each attempt that at least half of the "
      "participants made{}.",
      formulaOf(choices.shape),
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
    addCusum(data, choices, figure, courses, better, report);
    report.methods +=
        " Attempts to the criterion were censored for those who did not reach it, with Kaplan-Meier medians; "
        "cumulative "
        "sums are Wald's sequential test in the scaled form.";
    if (groupsIn(data) == 2) report.methods += " Groups were compared by the log-rank test.";
  }
  report.notes.emplace_back("An attempt without a value of the figure is passed over.");
  noteRefused(report, refused);
}

}  // namespace calot::analytics
