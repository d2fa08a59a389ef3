// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/multiplicity.h"

#include <algorithm>
#include <numeric>

namespace calot::analytics {
namespace {

std::string objection(std::span<const double> p) {
  if (p.empty()) return "no p values";
  if (!std::all_of(p.begin(), p.end(), [](double v) { return v >= 0.0 && v <= 1.0; }))
    return "a p value is outside of [0, 1]";
  return {};
}

std::vector<std::size_t> ascending(std::span<const double> p) {
  std::vector<std::size_t> order(p.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return p[a] < p[b] || (p[a] == p[b] && a < b); });
  return order;
}

}  // namespace

Expected<std::vector<double>> holm(std::span<const double> p) {
  using Result = Expected<std::vector<double>>;
  if (const std::string reason = objection(p); !reason.empty()) return Result::none(reason);
  const std::vector<std::size_t> order = ascending(p);
  std::vector<double> adjusted(p.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    largest = std::max(largest, std::min(1.0, static_cast<double>(p.size() - i) * p[order[i]]));
    adjusted[order[i]] = largest;
  }
  return adjusted;
}

Expected<std::vector<double>> benjaminiHochberg(std::span<const double> p) {
  using Result = Expected<std::vector<double>>;
  if (const std::string reason = objection(p); !reason.empty()) return Result::none(reason);
  const std::vector<std::size_t> order = ascending(p);
  std::vector<double> adjusted(p.size());
  double smallest = 1.0;
  for (std::size_t i = p.size(); i-- > 0;) {
    smallest = std::min(smallest, static_cast<double>(p.size()) * p[order[i]] / static_cast<double>(i + 1));
    adjusted[order[i]] = smallest;
  }
  return adjusted;
}

}  // namespace calot::analytics
