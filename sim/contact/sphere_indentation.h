// SPDX-License-Identifier: GPL-3.0-or-later
// A rigid sphere pressed into an elastic half-space, without friction (Sneddon 1965, Int. J. Eng. Sci. 3:47, section
// 5). With the radius of contact a = R tanh(t) and E* = E / (1 - nu^2),
//   depth = R t tanh(t),  F = E* R^2 [(1 + tanh(t)^2) t - tanh(t)],  dF/d(depth) = 2 E* a.
// Shallow, that is Hertz: F = 4/3 E* sqrt(R) depth^(3/2). Deep, a goes towards R, and the sphere presses as the flat
// end of a cylinder does, F = 2 E* R depth + constant: so does a rod with a round end.
//
// Green's function of the same half-space: a force F along the normal, spread over a patch of size s, moves a point at
// the distance r along the surface by F k(r), k(r) = 1 / (pi E* sqrt(r^2 + s^2)); Boussinesq's at r >> s. With
// s = 2 R / pi it is the flat end's own compliance at r = 0: 1 / (2 E* R).
#pragma once

#include <cmath>
#include <numbers>

namespace calot {

/// Something and its derivative by the force.
struct Indentation {
  double depth = 0.0;  ///< m
  double slope = 0.0;  ///< m/N
};

/// By how much deeper a sphere sinks in than the flat end of a cylinder of its radius would under the same force:
/// R/2 [tanh(t) - (1 - tanh(t))^2 t]. Rises from 0 to R/2, the slower the larger the force. The sphere's apex counts as
/// flattened by a thousandth of its radius, so that the slope at no force is finite.
/// @param force N, not negative @param radius m @param modulus E* (Pa)
Indentation roundEnd(double force, double radius, double modulus);

/// Size s of the patch over which the flat end of a cylinder spreads its force (m).
constexpr double flatEndSpread(double radius) { return 2.0 * radius / std::numbers::pi; }

/// k(r) (m/N). @param squaredDistance r^2 (m^2) @param spread s (m) @param modulus E* (Pa)
inline double spreadCompliance(double squaredDistance, double spread, double modulus) {
  return 1.0 / (std::numbers::pi * modulus * std::sqrt(squaredDistance + spread * spread));
}

}  // namespace calot
