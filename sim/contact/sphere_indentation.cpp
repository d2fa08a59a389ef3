// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/contact/sphere_indentation.h"

#include "sim/math/elementary.h"

namespace calot {

namespace {

/// Radius of contact at no force, in radii. Larger: light touches are too firm; smaller: Newton steps. Assumed.
constexpr double flattened = 0.03;
constexpr double shallow = 0.1;  ///< below this t, powers of t instead of differences of nearly equal numbers

double hyperbolicTangent(double t) {
  if (t < shallow) {
    const double s = t * t;
    return t * (1.0 - s * (1.0 / 3.0 - s * (2.0 / 15.0 - s * (17.0 / 315.0))));
  }
  const double e = exponential(-2.0 * t);
  return (1.0 - e) / (1.0 + e);
}

/// F / (E* R^2) at t, with tanh(t).
double forceAt(double t, double tanh) {
  if (t < shallow) {
    const double s = t * t;
    return t * s * (4.0 / 3.0 - s * (4.0 / 5.0 - s * (136.0 / 315.0)));
  }
  return (1.0 + tanh * tanh) * t - tanh;
}

/// t of a force. Newton's method; force is convex in t where it is small and straight where it is large.
double contactAt(double force) {
  double t = force < 1.0 ? exponential(logarithm(0.75 * force) / 3.0) : 0.5 * (force + 1.0);
  for (int i = 0; i < 4; ++i) {
    const double s = hyperbolicTangent(t);
    t -= (forceAt(t, s) - force) / (2.0 * s * (s + t * (1.0 - s * s)));
  }
  return t;
}

/// Depth beyond a flat end's, in radii.
double excess(double t, double tanh) { return 0.5 * (tanh - (1.0 - tanh) * (1.0 - tanh) * t); }

}  // namespace

Indentation roundEnd(double force, double radius, double modulus) {
  static const double t0 = 0.5 * logarithm((1.0 + flattened) / (1.0 - flattened));
  static const double force0 = forceAt(t0, flattened);
  static const double excess0 = excess(t0, flattened);
  const double t = contactAt(force / (modulus * radius * radius) + force0);
  const double s = hyperbolicTangent(t);
  return {radius * (excess(t, s) - excess0), (1.0 - s) / (2.0 * s * modulus * radius)};
}

}  // namespace calot
