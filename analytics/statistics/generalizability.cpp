// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/generalizability.h"

#include <cassert>
#include <cmath>
#include <string>

namespace calot::analytics {

DecisionStudy Generalizability::at(std::size_t k) const {
  assert(k > 0);
  const double n = static_cast<double>(k), relative = residual / n, absolute = (facet + residual) / n;
  const auto share = [&](double error) { return person > 0.0 ? person / (person + error) : 0.0; };
  return {share(relative), share(absolute), std::sqrt(relative), std::sqrt(absolute)};
}

Expected<Generalizability> generalizability(const RatingTable& table) {
  if (const std::string reason = objection(table); !reason.empty()) return Expected<Generalizability>::none(reason);
  const MeanSquares m = meanSquares(table);
  Generalizability result;
  result.people = table.subjects;
  result.levels = table.raters;
  const auto component = [&result](double difference, std::size_t count) {
    if (difference < 0.0) result.truncated = true;
    return difference < 0.0 ? 0.0 : difference / static_cast<double>(count);
  };
  result.person = component(m.subjects - m.residual, table.raters);
  result.facet = component(m.raters - m.residual, table.subjects);
  result.residual = m.residual;
  return result;
}

}  // namespace calot::analytics
