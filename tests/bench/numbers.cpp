// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/numbers.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>

#include "tests/bench/figures.h"
#include "tests/bench/thread_clock.h"

#include <nlohmann/json.hpp>

namespace calot::bench {

double quantile(std::vector<double> values, double q) {
  assert(!values.empty());
  const auto rank = static_cast<std::size_t>(std::ceil(q * static_cast<double>(values.size())));
  const std::size_t at = std::clamp<std::size_t>(rank, 1, values.size()) - 1;
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(at), values.end());
  return values[at];
}

double clockOverhead() {
  std::vector<double> between(10001);
  for (double& b : between) {
    const double before = threadSeconds();
    b = threadSeconds() - before;
  }
  return quantile(std::move(between), 0.5);
}

Figures& figures() {
  static Figures all;
  return all;
}

std::string Figures::json() const {
  nlohmann::json map = nlohmann::json::object();
  for (const auto& [name, values] : value_) map[name] = quantile(values, 0.5);
  for (const auto& [name, values] : largest_) map[name] = quantile(values, 1.0);
  return map.dump(2) + "\n";
}

}  // namespace calot::bench
