// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/attempt_sheet.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <ctime>

#include "analytics/assessment/norm.h"
#include "analytics/assessment/verdict.h"
#include "analytics/report/figure_number.h"
#include "analytics/report/grade_sheet.h"
#include "analytics/report/key_figures.h"

namespace calot::analytics {
namespace {

constexpr double sheetWidth = 680.0;                            // of the bars, in the drawing's units: a page's
constexpr double commentHeight = 30.0, signatureHeight = 14.0;  // mm
constexpr std::size_t longest = 420;                            // letters of a severity's sentence on the first page

/// In which order figures are worth a picture: 0 fall short, 1 count, 2 others.
int rankOf(const FigureMoments& figure, const Grade* grade) {
  if (grade != nullptr) {
    for (const GradedFigure& f : grade->figures) {
      if (f.mark.checkpoint == figure.checkpoint && f.mark.subject == figure.subject && f.weak()) return 0;
    }
  }
  return countsByDefault(figure.checkpoint) ? 1 : 2;
}

const CheckpointValue* find(const std::vector<CheckpointValue>& values, std::string_view name) {
  const auto at = std::find_if(values.begin(), values.end(), [&](const CheckpointValue& v) { return v.name == name; });
  return at == values.end() ? nullptr : &*at;
}

std::string who(const AttemptRow& attempt) {
  if (!attempt.participant.empty()) return attempt.participant;
  return attempt.profile.empty() ? recorder::wordFor(attempt.operatorKind) : attempt.profile;
}

/// The verdict's sentences; minor errors by their number alone.
void addVerdict(ReportDocument& document, const AttemptSheet& sheet) {
  if (sheet.grade != nullptr) document.add(cutTo(sheet.grade->verdict, longest));
  for (const auto& [severity, name] : errorCheckpoints()) {
    const CheckpointValue* const value = find(sheet.values, name);
    if (severity == Severity::critical && sheet.grade != nullptr && sheet.grade->criticalErrors.value_or(0.0) > 0.0)
      continue;  // the grade's verdict says them
    if (severity == Severity::minor && value != nullptr && value->value.value_or(0.0) > 0.0) {
      document.add(
          fmt::format("{:.0f} minor {}: see the appendix.", *value->value, *value->value == 1.0 ? "error" : "errors"));
      continue;
    }
    if (value == nullptr || sceneLacks(*value)) continue;
    document.add(cutTo(errorSentence(severity, value), longest));
  }
}

ReportTable valuesTable(const std::vector<CheckpointValue>& values) {
  ReportTable table = tableOf("Figures", {"=figure", "value", "=unit", "="});
  for (const CheckpointValue& v : values) {
    if (sceneLacks(v)) continue;
    const CheckpointDefinition* const definition = definitionOf(v);
    const std::string title = definition != nullptr ? definition->title : v.name;
    const double factor = definition != nullptr ? definition->displayFactor : 1.0;
    const std::string unit = definition != nullptr ? definition->displayUnit : v.unit;
    table.rows.push_back({figureName(title, v.subject.empty() ? "" : "(" + v.subject + ")"),
                          v.value ? figureNumber(definition, *v.value * factor) : "-", unit == "1" ? "" : unit,
                          v.value ? v.note : v.reason});
  }
  return table;
}

}  // namespace

std::string localTime(const std::string& utc) {
  std::tm time{};
  const char* const end = strptime(utc.c_str(), "%Y-%m-%dT%H:%M", &time);
  if (end == nullptr || !utc.ends_with('Z')) return utc;
  const std::time_t seconds = timegm(&time);
  localtime_r(&seconds, &time);
  return fmt::format("{:04}-{:02}-{:02} {:02}:{:02}", time.tm_year + 1900, time.tm_mon + 1, time.tm_mday, time.tm_hour,
                     time.tm_min);
}

std::vector<SheetMoment> worstMoments(const std::vector<ErrorLine>& errors, const std::vector<FigureMoments>& figures,
                                      const Grade* grade) {
  constexpr double apart = 1.0;  // s: two pictures of one moment say no more than one
  std::vector<SheetMoment> worst;
  const auto add = [&](double time, const std::string& caption) {
    const bool near =
        std::any_of(worst.begin(), worst.end(), [&](const SheetMoment& w) { return std::abs(w.time - time) < apart; });
    if (!near && worst.size() < maxSheetMoments) worst.push_back({time, timeText(time) + "  " + caption});
  };
  for (const ErrorLine& error : errors) {
    if (error.severity != Severity::minor)
      add(error.time, fmt::format("{}: {}", nameOf(error.severity), error.counted()));
  }
  std::vector<const FigureMoments*> order;
  for (const FigureMoments& figure : figures) {
    if (!figure.moments.empty()) order.push_back(&figure);
  }
  std::stable_sort(order.begin(), order.end(), [&](const FigureMoments* a, const FigureMoments* b) {
    return rankOf(*a, grade) < rankOf(*b, grade);
  });
  for (const FigureMoments* figure : order) {
    const Moment& most = *std::max_element(figure->moments.begin(), figure->moments.end(),
                                           [](const Moment& a, const Moment& b) { return a.share < b.share; });
    const CheckpointDefinition* const definition = findCheckpoint(figure->checkpoint);
    const std::string title = definition != nullptr ? definition->title : figure->checkpoint;
    add(0.5 * (most.begin + most.end), figure->subject.empty() ? title : title + ", " + figure->subject);
  }
  std::sort(worst.begin(), worst.end(), [](const SheetMoment& a, const SheetMoment& b) { return a.time < b.time; });
  return worst;
}

ReportDocument sheetDocument(const AttemptSheet& sheet) {
  const AttemptRow& attempt = sheet.attempt;
  ReportDocument document;
  document.title =
      fmt::format("{}: {}, {}", sheet.grade != nullptr ? "Grade sheet" : "Attempt", who(attempt), attempt.scene);
  document.synthetic = attempt.synthetic || (sheet.grade != nullptr && sheet.grade->norm.synthetic);
  document.add(
      fmt::format("{}, {}, {}, attempt {}{}.", attempt.startUtc.empty() ? "unknown day" : localTime(attempt.startUtc),
                  recorder::wordFor(attempt.outcome), nameOf(attempt.verification.verdict), attempt.uuid.substr(0, 8),
                  sheet.grade != nullptr
                      ? fmt::format("; norm {}, version {}, {}", sheet.grade->norm.name, sheet.grade->norm.version,
                                    sheet.grade->norm.evidence.empty() ? "formative" : "with evidence of its validity")
                      : std::string("; held against no norm")));
  document.parts.emplace_back(Heading{"Verdict"});
  addVerdict(document, sheet);
  if (const std::vector<KeyFigure> figures = keyFigures(sheet.values, sheet.grade); !figures.empty()) {
    document.parts.emplace_back(Heading{"Figures that count"});
    document.parts.emplace_back(Figures{{drawKeyFigures(figures, sheetWidth, 1)}});
  }
  if (!sheet.pictures.empty()) {
    document.parts.emplace_back(Heading{"Gravest moments"});
    document.parts.emplace_back(Pictures{sheet.pictures});
  } else if (!sheet.picturesMissing.empty()) {
    document.add("No pictures: " + sheet.picturesMissing + ".");
  }
  document.parts.emplace_back(Blank{"Comment", commentHeight});
  document.parts.emplace_back(Blank{"Assessor, date, signature", signatureHeight});
  document.parts.emplace_back(Heading{"Appendix", true});
  if (sheet.grade != nullptr) {
    addGradeAppendix(document, *sheet.grade, sheet.recording, sheet.howToDraw);
    return document;
  }
  document.add(fmt::format("Attempt {}. {}.", attempt.uuid, comparabilityWords(attempt.comparabilityKey)));
  ReportTable table = tableOf("Errors", {"time", "=severity", "=error"});
  for (const ErrorLine& error : sheet.errors)
    table.rows.push_back({timeText(error.time), nameOf(error.severity), error.counted()});
  if (!table.rows.empty()) document.parts.emplace_back(std::move(table));
  document.parts.emplace_back(valuesTable(sheet.values));
  return document;
}

}  // namespace calot::analytics
