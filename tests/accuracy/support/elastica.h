// SPDX-License-Identifier: GPL-3.0-or-later
// Large deflection of a slender cantilever, in closed form.
#pragma once

#include <boost/math/special_functions/ellint_1.hpp>
#include <boost/math/special_functions/ellint_2.hpp>
#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

namespace calot::test {

struct TipMotion {
  double down = 0.0;  ///< w / L
  double back = 0.0;  ///< u / L
};

/// The inextensible cantilever under a dead transverse force at its tip: with load = P L^2 / EI, t the slope at the tip
/// and k^2 = (1 + sin t) / 2, sin f = 1 / (k sqrt 2) (Bisshopp and Drucker 1945, Quart. Appl. Math. 3:272):
///   sqrt(load) = K(k) - F(f, k),  w / L = 1 - 2 / sqrt(load) (E(k) - E(f, k)),  1 - u / L = sqrt(2 sin t / load).
inline TipMotion elastica(double load) {
  const auto modulus = [](double t) { return std::sqrt(0.5 * (1.0 + std::sin(t))); };
  const auto amplitude = [](double k) { return std::asin(1.0 / (k * std::numbers::sqrt2)); };
  const auto excess = [&](double t) {
    const double k = modulus(t);
    return boost::math::ellint_1(k) - boost::math::ellint_1(k, amplitude(k)) - std::sqrt(load);
  };
  std::uintmax_t most = 200;
  const std::pair<double, double> bracket = boost::math::tools::bisect(
      excess, 1e-4, 0.5 * std::numbers::pi - 1e-4, boost::math::tools::eps_tolerance<double>(50), most);
  const double t = 0.5 * (bracket.first + bracket.second);
  const double k = modulus(t);
  return {1.0 - 2.0 / std::sqrt(load) * (boost::math::ellint_2(k) - boost::math::ellint_2(k, amplitude(k))),
          1.0 - std::sqrt(2.0 * std::sin(t) / load)};
}

}  // namespace calot::test
