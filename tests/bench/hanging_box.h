// SPDX-License-Identifier: GPL-3.0-or-later
// Boxes of jittered tetrahedra that hang in gravity, and our own solver on them.
#pragma once

#include "sim/solid/solid.h"
#include "tests/bench/bullet_peer.h"

namespace calot::bench {

struct BoxSize {
  int tetrahedra, nx, ny, nz;
  int steps;           ///< measured, of ours
  int peerSteps;       ///< measured, of the peer; 0: it takes too long
  double frameworkMs;  ///< a step of the fastest class of the framework that the paper used, at 100 iterations, on a
                       ///< machine like the one of docs/explanation/performance-details.md
};
inline constexpr BoxSize boxSizes[] = {{504, 7, 4, 3, 100, 60, 0.86},    {1500, 10, 5, 5, 100, 60, 1.7},
                                       {5040, 15, 8, 7, 60, 40, 5.1},    {10800, 18, 10, 10, 60, 40, 10.3},
                                       {49152, 32, 16, 16, 20, 0, 59.0}, {202800, 50, 26, 26, 8, 0, 261.0}};

enum class HangingBox {
  soft,      ///< E = 5 kPa: hangs down by its length under a load of 1 N that goes to and fro over its free end
  stiff,     ///< E = 50 kPa: falls without a load
  framework  ///< as the framework was measured: no jitter, E = 10 kPa, gravity alone
};

HangingBody hangingBox(const BoxSize& size, HangingBox kind);

SolidModel modelOf(const HangingBody& body);

struct Own {
  Hung hung;
  double iterations = 0.0;  ///< a step, mean
  bool converged = true;    ///< in all steps
};

Own hangOurs(const SolidModel& model, const HangingBody& body, int steps, double tolerance);

}  // namespace calot::bench
