// SPDX-License-Identifier: GPL-3.0-or-later
// Two groups over repeated attempts.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analytics/design/design_report.h"
#include "analytics/statistics/mixed_models.h"

namespace calot::analytics {
namespace {

struct RepeatedRow {
  const DesignFigure* figure = nullptr;
  RepeatedGroups model;
  Expected<RandomIntercept> overall = NoResult{""};
  std::string first;               ///< occasion
  std::vector<std::string> steps;  ///< what the terms of the occasion are about
};

/// The first occasion at which the figure has values, and what its later ones are called.
void nameOccasions(const DesignData& data, RepeatedRow& row) {
  if (data.numbered) {
    row.first = "the first";
    row.steps = {"each " + data.occasionWord};
    return;
  }
  for (std::size_t o = 0; o < data.occasions.size(); ++o) {
    const auto& values = row.figure->values;
    if (std::none_of(values.begin(), values.end(), [o](const DesignValue& v) { return v.occasion == o; })) continue;
    if (row.first.empty()) {
      row.first = data.occasions[o];
    } else {
      row.steps.push_back(data.occasions[o]);
    }
  }
}

DesignJson termJson(const ModelTerm& term) {
  return {{"estimate", term.estimate},
          {"error", term.error},
          {"t", term.t},
          {"df", term.df},
          {"p", term.p},
          {"interval", intervalJson(term.interval)}};
}

std::vector<std::string> termCells(const std::string& figure, const std::string& name, const ModelTerm& term,
                                   const std::string& adjusted) {
  return {figure,
          name,
          significant(term.estimate),
          intervalText(term.interval),
          fmt::format("{:.2f}", term.t),
          significant(term.df),
          pText(term.p),
          adjusted};
}

DesignJson repeatedJson(const RepeatedRow& row) {
  const RepeatedGroups& m = row.model;
  DesignJson occasion = DesignJson::array(), interaction = DesignJson::array();
  for (std::size_t s = 0; s < m.occasion.size(); ++s) {
    occasion.push_back(termJson(m.occasion[s]));
    occasion.back()["of"] = row.steps[s];
    interaction.push_back(termJson(m.interaction[s]));
    interaction.back()["of"] = row.steps[s];
  }
  DesignJson json{{"figure", row.figure->name},          {"unit", row.figure->unit},
                  {"participants", m.participants},      {"attempts", m.attempts},
                  {"group", termJson(m.group)},          {"occasion", occasion},
                  {"interaction", interaction},          {"between_variance", m.betweenVariance},
                  {"within_variance", m.withinVariance}, {"restricted_log_likelihood", m.restrictedLogLikelihood}};
  json["overall"] = row.overall ? DesignJson{{"difference", row.overall->estimate},
                                             {"error", row.overall->error},
                                             {"df", row.overall->df},
                                             {"p", row.overall->p},
                                             {"interval", intervalJson(row.overall->interval)}}
                                : reasonJson(row.overall.reason());
  return json;
}

}  // namespace

void analyseRepeated(const DesignData& data, const DesignChoices& choices, DesignReport& report) {
  const OccasionKind kind = data.numbered ? OccasionKind::number : OccasionKind::named;
  std::vector<RepeatedRow> rows;
  std::vector<std::pair<std::string, std::string>> refused;
  std::vector<std::optional<double>> p;
  for (const DesignFigure& figure : data.figures) {
    std::vector<OccasionValue> values;
    std::vector<ModelAttempt> attempts;
    std::vector<std::size_t> sites;
    for (const DesignValue& v : figure.values) {
      const DesignPerson& person = data.people[v.person];
      double occasion = static_cast<double>(v.occasion);
      if (data.numbered && data.source == "table") occasion = std::stod(data.occasions[v.occasion]);
      values.push_back({v.person, person.group == 0, occasion, v.value});
      attempts.push_back({v.person, person.group == 0, person.stratum, v.value});
      if (!data.strata.empty()) sites.push_back(person.stratum);
    }
    const Expected<RepeatedGroups> model = repeatedGroups(values, kind, sites);
    if (!model) {
      refused.emplace_back(figure.name, model.reason());
      continue;
    }
    RepeatedRow& row = rows.emplace_back(RepeatedRow{&figure, *model, randomIntercept(attempts), "", {}});
    nameOccasions(data, row);
    for (const ModelTerm& term : model->interaction) p.emplace_back(term.p);
  }
  askForResults(data, rows.size(), refused);
  const std::vector<std::optional<double>> adjusted = holmOver(p);
  ReportTable table =
      tableOf("Group, occasion and interaction", {"=figure", "=term", "estimate", "95 %", "t", "df", "p", "Holm"});
  ReportTable spread = tableOf("Variances", {"=figure", "participants", "attempts", "sd between", "sd within",
                                             "difference overall", "95 %", "p"});
  report.json["results"] = DesignJson::array();
  std::size_t next = 0;
  for (const RepeatedRow& row : rows) {
    const RepeatedGroups& m = row.model;
    const std::string title = figureTitle(*row.figure);
    table.rows.push_back(
        termCells(title, fmt::format("{} less {}, at {}", data.groups[0], data.groups[1], row.first), m.group, ""));
    for (std::size_t s = 0; s < m.occasion.size(); ++s)
      table.rows.push_back(termCells("", fmt::format("{}, {}", row.steps[s], data.groups[1]), m.occasion[s], ""));
    for (std::size_t s = 0; s < m.interaction.size(); ++s)
      table.rows.push_back(termCells("", fmt::format("{}, {} less {}", row.steps[s], data.groups[0], data.groups[1]),
                                     m.interaction[s], pOrDash(adjusted[next++])));
    spread.rows.push_back({title, fmt::format("{}", m.participants), fmt::format("{}", m.attempts),
                           significant(std::sqrt(m.betweenVariance)), significant(std::sqrt(m.withinVariance)),
                           row.overall ? significant(row.overall->estimate) : "-",
                           row.overall ? intervalText(row.overall->interval) : "-",
                           row.overall ? pText(row.overall->p) : "-"});
    report.json["results"].push_back(repeatedJson(row));
  }
  report.tables = {std::move(table), std::move(spread)};
  report.notes.push_back(fmt::format(
      "Occasion: {}. The interaction is by how much the groups' changes differ; Holm: over the {} interactions. "
      "Difference overall: {} less {} over all attempts, without occasion.",
      data.numbered ? fmt::format("the number of the {}, one slope, counted from the first", data.occasionWord)
                    : fmt::format("\"{}\", each against the first", data.occasionWord),
      p.size(), data.groups[0], data.groups[1]));
  noteRefused(report, refused);
  report.methods = fmt::format(
      "Group, occasion and their interaction were estimated by a mixed model with a random intercept for each "
      "participant, by restricted maximum likelihood, with Student's t and the degrees of freedom of inner and outer "
      "terms{}. The interactions' p values were adjusted by Holm's method.",
      data.strata.empty() ? "" : fmt::format("; the strata of \"{}\" had constants of their own", choices.strata));
}

}  // namespace calot::analytics
