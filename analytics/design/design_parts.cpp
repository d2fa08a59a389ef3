// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/design/design_parts.h"

#include <fmt/format.h>

#include "analytics/statistics/multiplicity.h"
#include "recorder/base/errors.h"

namespace calot::analytics {

std::string intervalText(double lower, double upper) {
  return fmt::format("[{}, {}]", significant(lower), significant(upper));
}
std::string intervalText(const Interval& interval) { return intervalText(interval.lower, interval.upper); }
std::string intervalText(const Expected<Interval>& interval) { return interval ? intervalText(*interval) : "-"; }

DesignJson intervalJson(const Interval& interval) {
  return {{"lower", interval.lower}, {"upper", interval.upper}, {"level", interval.level}, {"method", interval.method}};
}
DesignJson optionalJson(const std::optional<double>& value) { return value ? DesignJson(*value) : DesignJson(nullptr); }
DesignJson reasonJson(const std::string& reason) { return {{"value", nullptr}, {"reason", reason}}; }

ReportTable tableOf(const std::string& title, const std::vector<std::string>& columns) {
  ReportTable table{title, {}, {}};
  for (const std::string& column : columns) {
    const bool left = column.empty() || column[0] == '=';
    table.columns.emplace_back(left && !column.empty() ? column.substr(1) : column,
                               left ? TextTable::Align::left : TextTable::Align::right);
  }
  return table;
}

std::vector<std::optional<double>> holmOver(const std::vector<std::optional<double>>& p) {
  std::vector<double> known;
  for (const auto& value : p) {
    if (value) known.push_back(*value);
  }
  std::vector<std::optional<double>> adjusted(p.size());
  const Expected<std::vector<double>> values = holm(known);
  if (!values) return adjusted;
  std::size_t next = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (p[i]) adjusted[i] = (*values)[next++];
  }
  return adjusted;
}

std::string figureTitle(const DesignFigure& figure) {
  return figure.unit.empty() ? figure.name : fmt::format("{} [{}]", figure.name, figure.unit);
}

void noteRefused(DesignReport& report, const std::vector<std::pair<std::string, std::string>>& refused) {
  constexpr std::size_t most = 10;
  for (std::size_t i = 0; i < refused.size() && i < most; ++i)
    report.notes.push_back(fmt::format("Not analysed: {}: {}.", refused[i].first, refused[i].second));
  if (refused.size() > most) report.notes.push_back(fmt::format("Nor {} more figures.", refused.size() - most));
}

void askForResults(const DesignData& data, std::size_t analysed,
                   const std::vector<std::pair<std::string, std::string>>& refused) {
  if (analysed > 0) return;
  throw Error(ErrorKind::refused, Where{data.where},
              refused.empty() ? std::string("there is no figure to analyse")
                              : fmt::format("no figure can be analysed; {}: {}", refused[0].first, refused[0].second));
}

std::optional<bool> firstShouldBeLarger(const DesignData& data, const DesignFigure& figure) {
  if (figure.direction == Direction::none || data.better.empty()) return std::nullopt;
  return (figure.direction == Direction::higher) == (data.better == data.groups[0]);
}

}  // namespace calot::analytics
