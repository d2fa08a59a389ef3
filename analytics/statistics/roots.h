// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <boost/math/tools/roots.hpp>
#include <cassert>
#include <cstdint>

namespace calot::analytics {

/// Root of a continuous function between two points of opposite sign, to machine precision (Alefeld, Potra and Shi's
/// algorithm 748 of Boost.Math). @pre lower < upper; f(lower) f(upper) <= 0.
template <class Function>
double rootBetween(const Function& f, double lower, double upper) {
  const double atLower = f(lower), atUpper = f(upper);
  if (atLower == 0.0) return lower;
  if (atUpper == 0.0) return upper;
  assert(atLower * atUpper < 0.0);
  std::uintmax_t iterations = 200;
  const auto bracket = boost::math::tools::toms748_solve(f, lower, upper, atLower, atUpper,
                                                         boost::math::tools::eps_tolerance<double>(52), iterations);
  return 0.5 * (bracket.first + bracket.second);
}

}  // namespace calot::analytics
