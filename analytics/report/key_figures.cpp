// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/key_figures.h"

#include <fmt/format.h>
#include <algorithm>

#include "analytics/assessment/norm.h"
#include "analytics/report/figure_number.h"
#include "analytics/report/report_document.h"

namespace calot::analytics {
namespace {

/// A number of this checkpoint as people read it, with its unit.
std::string shown(const CheckpointValue& value, double si) {
  const CheckpointDefinition* const definition = definitionOf(value);
  const bool known = definition != nullptr && definition->version == value.version;
  const std::string& unit = known ? definition->displayUnit : value.unit;
  return figureNumber(known ? definition : nullptr, si * (known ? definition->displayFactor : 1.0)) +
         (unit == "1" ? "" : " " + unit);
}

}  // namespace

bool sceneLacks(const CheckpointValue& value) {
  if (value.availability != Availability::notApplicable) return false;
  const std::string& reason = value.reason;
  return reason.starts_with("the scene has no ") || reason.starts_with("the scene gives this organ no ") ||
         reason.ends_with("in this scene");
}

std::string KeyFigure::number() const { return value.value ? shown(value, *value.value) : value.reason; }

std::string KeyFigure::against() const {
  if (!mark) return {};
  const std::string asked = fmt::format("{} {}", atLeast ? "at least" : "at most", shown(value, *mark));
  return !passed ? asked : *passed ? "passes, " + asked : "falls short, " + asked;
}

std::vector<KeyFigure> keyFigures(const std::vector<CheckpointValue>& values, const Grade* grade) {
  std::vector<KeyFigure> figures;
  for (const std::string_view name : countingCheckpoints()) {
    for (const CheckpointValue& value : values) {
      if (value.name != name || sceneLacks(value)) continue;
      const CheckpointDefinition* const definition = findCheckpoint(name);
      KeyFigure& figure = figures.emplace_back();
      figure.value = value;
      figure.title = definition != nullptr ? definition->title : value.name;
      if (!value.subject.empty()) figure.title += ", " + value.subject;
      if (grade == nullptr) continue;
      for (const GradedFigure& graded : grade->figures) {
        if (graded.mark.checkpoint != value.name || graded.mark.subject != value.subject) continue;
        figure.mark = graded.mark.cut;
        figure.atLeast = graded.mark.direction == Direction::higher;
        figure.passed = graded.passed;
      }
    }
  }
  return figures;
}

Drawing drawKeyFigures(const std::vector<KeyFigure>& figures, double width, std::size_t columns) {
  constexpr double margin = 8.0, titleLetter = 6.2, wordLetter = 5.4;
  constexpr double textLine = 12.0, barTop = 16.0, barHeight = 8.0;
  // Without any mark there is nothing that a bar could be held against.
  const bool marked =
      std::any_of(figures.begin(), figures.end(), [](const KeyFigure& f) { return f.mark.has_value(); });
  const double rowHeight = marked ? 30.0 : 18.0;
  const std::size_t rows = std::max<std::size_t>(1, (figures.size() + columns - 1) / columns);
  Drawing drawing{
      "Figures that count against their pass marks", width, 2.0 * margin + rowHeight * static_cast<double>(rows), {}};
  const double column = (width - margin * static_cast<double>(columns + 1)) / static_cast<double>(columns);
  for (std::size_t i = 0; i < figures.size(); ++i) {
    const KeyFigure& figure = figures[i];
    const std::size_t across = i / rows;
    const double left = margin + static_cast<double>(across) * (column + 2.0 * margin), right = left + column - margin;
    const double top = margin + rowHeight * static_cast<double>(i % rows);
    std::string words = figure.number();
    if (const std::string against = figure.against(); !against.empty()) words += " (" + against + ")";
    words = cutTo(words, static_cast<std::size_t>(0.75 * column / wordLetter));
    const double space = column - wordLetter * static_cast<double>(words.size()) - 2.0 * margin;
    // A long title is cut before hand or organ.
    const std::string tail = figure.value.subject.empty() ? "" : ", " + figure.value.subject;
    const auto letters = static_cast<std::size_t>(std::max(8.0, space / titleLetter));
    drawing.text(Ink::label, left, top + textLine,
                 cutTo(figure.title.substr(0, figure.title.size() - tail.size()),
                       std::max<std::size_t>(8, letters - std::min(letters, tail.size()))) +
                     tail);
    drawing.text(Ink::tick, right, top + textLine, words);
    const double middle = top + barTop + barHeight / 2.0;
    const double value = std::max(0.0, figure.value.value.value_or(0.0)),
                 mark = std::max(0.0, figure.mark.value_or(0.0));
    const double most = 1.1 * std::max(value, mark);
    const auto x = [&](double si) { return left + (most > 0.0 ? std::min(1.0, si / most) : 0.0) * (right - left); };
    const bool weak = figure.passed.has_value() && !*figure.passed;
    if (figure.value.value)
      drawing.marks.push_back({figure.mark ? x(value) : right, figure.mark ? middle : top + textLine,
                               figure.value.name + ' ' + figure.value.subject, figure.title + ": " + words});
    if (!figure.mark) continue;
    drawing.line(Ink::grid, left, middle, right, middle);
    if (figure.value.value)
      drawing.box(weak ? Ink::secondBox : Ink::firstBox, left, top + barTop, std::max(1.0, x(value) - left), barHeight);
    drawing.line(Ink::cut, x(mark), top + barTop - 3.0, x(mark), top + barTop + barHeight + 3.0);
  }
  return drawing;
}

}  // namespace calot::analytics
