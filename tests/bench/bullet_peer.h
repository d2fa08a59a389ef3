// SPDX-License-Identifier: GPL-3.0-or-later
// Bullet's deformable bodies as a peer of deformation: its neo-Hookean tetrahedra in single precision, implicit.
#pragma once

#include <functional>
#include <vector>

#include "sim/math/linear.h"

namespace calot::bench {

/// A body that is held at some nodes and hangs in gravity.
struct HangingBody {
  std::vector<Vec3> node;  ///< m, at rest
  std::vector<Index4> tetrahedron;
  std::vector<bool> fixed;  ///< per node
  double youngModulus = 5e3, poissonRatio = 0.45, density = 1000.0;
  double step = 0.02;                     ///< s
  std::function<Vec3(int step)> gravity;  ///< m/s^2
  /// What pulls on the nodes besides (N, per node); none where it is not set.
  std::function<std::vector<Vec3>(int step)> load = nullptr;
};

/// Where its nodes end, and what a step took.
struct Hung {
  std::vector<Vec3> position;  ///< m
  double seconds = 0.0;        ///< CPU time of a step, mean
};

struct BulletBudget {
  int newtonSteps = 0;     ///< most of them a step; 0: all as the library comes
  int iterations = 0;      ///< most of conjugate gradients in each
  double tolerance = 0.0;  ///< of the residual's square relative to the first
};

Hung hangInBullet(const HangingBody& body, int steps, const BulletBudget& budget);

}  // namespace calot::bench
