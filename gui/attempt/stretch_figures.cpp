// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/attempt/stretch_figures.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <map>

namespace calot::gui {
namespace {

constexpr double sameOccasion = 1.0;  // s, as of ErrorList
constexpr const char* minus = "\u2212";

using Values = std::vector<double>;

/// Calls with each bin's value and the share of the bin (s) that lies within the stretch.
template <class Visit>
void forStretch(const Values& values, double bin, double from, double to, Visit&& visit) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double begin = static_cast<double>(i) * bin;
    const double within = std::min(to, begin + bin) - std::max(from, begin);
    if (within > 0.0) visit(values[i], within);
  }
}

double pathOf(const AttemptTrack& track, std::size_t hand, double from, double to) {
  double sum = 0.0;
  forStretch(track.hand[hand].speed, track.bin, from, to, [&](double speed, double within) { sum += speed * within; });
  return sum;
}

double greatestForce(const AttemptTrack& track, std::size_t hand, double from, double to) {
  double greatest = 0.0;
  forStretch(track.hand[hand].force, track.bin, from, to,
             [&](double force, double) { greatest = std::max(greatest, force); });
  return greatest;
}

std::string signedText(double difference, const std::string& magnitude, const std::string& unit) {
  const char* const sign = difference < 0.0 ? minus : "+";
  return sign + magnitude + unit;
}

StretchFigure quantity(std::string title, std::array<double, 2> values, int digits, const std::string& unit) {
  StretchFigure figure{std::move(title), {}, {}};
  const double scale = std::pow(10.0, digits);
  for (double& value : values) value = std::round(value * scale) / scale;  // the difference is of what is shown
  for (std::size_t i = 0; i < 2; ++i) figure.text[i] = fmt::format("{:.{}f} {}", values[i], digits, unit);
  const double difference = values[1] - values[0];
  const std::string magnitude = fmt::format("{:.{}f}", std::abs(difference), digits);
  figure.difference = figure.text[0] == figure.text[1] ? "the same" : signedText(difference, magnitude, ' ' + unit);
  return figure;
}

/// Occasions of errors of a severity within the stretch: one error counts again after a second.
struct Errors {
  int count = 0;
  std::vector<std::string> words;
};
Errors errorsOf(const AttemptTrack& track, Severity severity, double from, double to) {
  Errors found;
  std::map<std::string, double> last;
  for (const TrackEvent& event : track.events) {
    if (event.severity != severity || event.time <= from || event.time > to) continue;
    const auto [at, fresh] = last.try_emplace(event.title, event.time);
    if (fresh) found.words.push_back(event.title);
    if (fresh || event.time - at->second > sameOccasion) ++found.count;
    at->second = event.time;
  }
  return found;
}

StretchFigure errorFigure(const std::array<const AttemptTrack*, 2>& tracks, Severity severity,
                          std::array<double, 2> from, double seconds) {
  StretchFigure figure{std::string(analytics::nameOf(severity)) + " errors", {}, {}};
  std::array<int, 2> counts{};
  for (std::size_t i = 0; i < 2; ++i) {
    const Errors errors = errorsOf(*tracks[i], severity, from[i], from[i] + seconds);
    counts[i] = errors.count;
    figure.text[i] = errors.count == 0 ? "none" : fmt::format("{}: {}", errors.count, fmt::join(errors.words, "; "));
  }
  const int difference = counts[1] - counts[0];
  figure.difference = difference == 0 ? "the same" : signedText(difference, std::to_string(std::abs(difference)), "");
  return figure;
}

}  // namespace

std::optional<double> partingTime(const AttemptTrack& a, const AttemptTrack& b) {
  if (!b.parent.empty() && b.parent == a.attempt) return b.forkTime;
  if (!a.parent.empty() && a.parent == b.attempt) return a.forkTime;
  if (!a.parent.empty() && a.parent == b.parent) return std::min(a.forkTime, b.forkTime);
  return std::nullopt;
}

std::vector<StretchFigure> stretchFigures(const std::array<const AttemptTrack*, 2>& tracks, std::array<double, 2> from,
                                          double seconds) {
  std::vector<StretchFigure> figures;
  for (const Severity severity : {Severity::critical, Severity::major, Severity::minor})
    figures.push_back(errorFigure(tracks, severity, from, seconds));
  constexpr double millimetresOfMetre = 1000.0;
  const auto each = [&](auto&& of) {
    return std::array{of(*tracks[0], from[0], from[0] + seconds), of(*tracks[1], from[1], from[1] + seconds)};
  };
  for (std::size_t h = 0; h < handCount; ++h) {
    const std::string side = h == 0 ? "left" : "right";
    figures.push_back(quantity("path of the " + side + " tip", each([&](const AttemptTrack& track, double a, double b) {
                                 return millimetresOfMetre * pathOf(track, h, a, b);
                               }),
                               0, "mm"));
    figures.push_back(quantity(
        "greatest force, " + side + " hand",
        each([&](const AttemptTrack& track, double a, double b) { return greatestForce(track, h, a, b); }), 1, "N"));
  }
  return figures;
}

QString stretchTable(const std::vector<StretchFigure>& figures, const std::array<QString, 2>& names) {
  const auto cell = [](const QString& text, const char* tag = "td") {
    return QString("<%1 align=\"left\" style=\"padding: 1px 14px 1px 0\">%2</%1>").arg(tag, text.toHtmlEscaped());
  };
  QString rows =
      "<tr>" + cell("", "th") + cell(names[0], "th") + cell(names[1], "th") + cell("difference", "th") + "</tr>";
  for (const StretchFigure& figure : figures) {
    rows += "<tr>" + cell(QString::fromStdString(figure.title));
    for (const std::string& text : figure.text) rows += cell(QString::fromStdString(text));
    rows += cell(QString::fromStdString(figure.difference)) + "</tr>";
  }
  return "<table>" + rows + "</table>";
}

}  // namespace calot::gui
