// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstddef>
#include <span>

namespace calot::bench {

/// Slope of log y over log x by least squares: y grows as x to this power. @pre at least two different x, all positive
inline double growthExponent(std::span<const double> x, std::span<const double> y) {
  double meanX = 0.0;
  double meanY = 0.0;
  const auto n = static_cast<double>(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    meanX += std::log(x[i]) / n;
    meanY += std::log(y[i]) / n;
  }
  double xy = 0.0;
  double xx = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xy += (std::log(x[i]) - meanX) * (std::log(y[i]) - meanY);
    xx += (std::log(x[i]) - meanX) * (std::log(x[i]) - meanX);
  }
  return xy / xx;
}

}  // namespace calot::bench
