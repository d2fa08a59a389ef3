// SPDX-License-Identifier: GPL-3.0-or-later
// Portable elementary functions: libm differs between systems and versions, these give the same bits everywhere. Errors
// are the greatest found against correctly rounded references (tests/sim/math/elementary_test.cpp), in units in the
// last place of the result.
#pragma once

namespace calot {

/// sin(x), cos(x) for |x| <= 1e5 (reduction by pi/2 in four parts, after Cody and Waite). At most 1 ulp, also near
/// zeros. For larger finite arguments the reduction is inexact: the result is in [-1, 1] and the same everywhere, but
/// not accurate, so callers clamp angles. NaN for an argument that is not finite.
double sine(double x);
double cosine(double x);

/// e^x; 0 below -708, +infinity above 709.7. At most 1 ulp.
double exponential(double x);

/// Natural logarithm of x > 0, including subnormals; NaN for x < 0, -infinity at 0. At most 1.1 ulp.
double logarithm(double x);

/// x^(1/3) for x > 0; NaN for x < 0, 0 at 0. At most 2e-15 of it for 1e-12 <= x <= 1e12.
double cubeRoot(double x);

/// Angle of (x, y) in (-pi, pi]; 0 at the origin. The sign of a zero is ignored. At most 2 ulp.
double arctangent2(double y, double x);

/// Arc cosine, argument clamped to [-1, 1]. At most 3 ulp, also near 1.
double arccosine(double x);

}  // namespace calot
