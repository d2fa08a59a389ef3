// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/random.h"

#include <cmath>

#include "sim/math/elementary.h"

namespace calot {

double Random::normal() {
  // Marsaglia and Bray (1964): (u, v) uniform in the unit disc gives u sqrt(-2 ln(s) / s), s = u^2 + v^2. The second
  // value is discarded: it would be hidden state.
  for (;;) {
    const double u = uniform(-1.0, 1.0);
    const double v = uniform(-1.0, 1.0);
    const double s = u * u + v * v;
    if (s > 0.0 && s < 1.0) return u * std::sqrt(-2.0 * logarithm(s) / s);
  }
}

}  // namespace calot
