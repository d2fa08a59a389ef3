// SPDX-License-Identifier: GPL-3.0-or-later
// What is asked of a solid that was treated badly.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/solid/solid.h"

namespace calot::test {

inline bool isFinite(const SolidState& state) {
  for (const Vec3& p : state.position) {
    if (!p.allFinite()) return false;
  }
  for (const Vec3& v : state.velocity) {
    if (!v.allFinite()) return false;
  }
  for (const RotationGroup& group : state.rotation) {
    for (const auto& component : group) {
      for (const double q : component) {
        if (!std::isfinite(q)) return false;
      }
    }
  }
  return true;
}

inline int invertedElements(const SolidModel& model, const SolidState& state) {
  int inverted = 0;
  for (const Index4& t : model.tetrahedra()) {
    const auto at = [&](int c) -> const Vec3& { return state.position[static_cast<std::size_t>(t[c])]; };
    if ((at(1) - at(0)).cross(at(2) - at(0)).dot(at(3) - at(0)) <= 0.0) ++inverted;
  }
  return inverted;
}

inline double maxDisplacement(const SolidModel& model, const SolidState& state) {
  double largest = 0.0;
  for (std::size_t n = 0; n < model.nodes(); ++n)
    largest = std::max(largest, (state.position[n] - model.rest()[n]).norm());
  return largest;
}

/// Kinetic and elastic energy (J). The elastic part from forces and rotations: V sigma : eps / 2 of an element is
/// -1/2 sum_a f_a . (x_a - R X_a).
inline double energy(const SolidModel& model, const SolidState& state) {
  std::vector<RotationGroup> rotation = state.rotation;
  std::vector<ElementResult> result(model.elements().groups().size());
  SerialExecutor executor;
  model.elements().evaluate(state.position, state.velocity, 0.0, model.material().lame, 8, rotation, result, executor);
  double sum = 0.0;
  for (std::size_t n = 0; n < model.nodes(); ++n) sum += 0.5 * model.mass()[n] * state.velocity[n].squaredNorm();
  for (std::size_t e = 0; e < model.tetrahedra().size(); ++e) {
    const std::size_t g = e / laneCount;
    const std::size_t l = e % laneCount;
    const Quat r(rotation[g][0][l], rotation[g][1][l], rotation[g][2][l], rotation[g][3][l]);
    for (std::size_t a = 0; a < 4; ++a) {
      const auto n = static_cast<std::size_t>(model.tetrahedra()[e][static_cast<int>(a)]);
      const Vec3 force(result[g].force[a][0][l], result[g].force[a][1][l], result[g].force[a][2][l]);
      sum -= 0.5 * force.dot(state.position[n] - r * model.rest()[n]);
    }
  }
  return sum;
}

}  // namespace calot::test
