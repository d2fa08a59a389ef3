// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace calot::analytics {

/// A two-sided confidence interval and how it was made: the method is printed beside the numbers.
struct Interval {
  double lower = 0.0, upper = 0.0;
  double level = 0.95;  ///< asked for
  std::string method;
};

}  // namespace calot::analytics
