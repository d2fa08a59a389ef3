// SPDX-License-Identifier: GPL-3.0-or-later
// A solid that is large enough for a coarse lattice (sim/solid/coarse_lattice.h), which no scene of the project is.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/math/fields.h"
#include "sim/math/random.h"
#include "sim/solid/solid.h"
#include "tests/accuracy/support/kuhn_box.h"

namespace calot::test {

/// Digests of position and velocity over some steps of a box of 10,800 tetrahedra that is held at one face, stirred and
/// hangs.
inline std::vector<std::uint64_t> largeSolid(Executor& executor) {
  constexpr int steps = 4;
  KuhnBox box = kuhnBox(18, 10, 10, Vec3(0.0, -0.0375, -0.0375), Vec3(0.15, 0.0375, 0.0375));
  std::vector<bool> fixed(box.node.size(), false);
  for (int k = 0; k <= box.nz; ++k) {
    for (int j = 0; j <= box.ny; ++j) fixed[static_cast<std::size_t>(box.index(0, j, k))] = true;
  }
  const SolidModel model(std::move(box.node), std::move(box.tetrahedron), fixed,
                         {lameConstants(5e3, 0.45), 1000.0, 0.1, 0.01});
  SolidState state = restState(model);
  Random random(29);
  for (const int node : model.freeNodes()) {
    for (int a = 0; a < 3; ++a) state.velocity[static_cast<std::size_t>(node)][a] = 0.2 * (random.uniform() - 0.5);
  }
  SolidSolver solver;
  SolidSolver::Settings settings;
  std::vector<std::uint64_t> digests;
  for (int n = 0; n < steps; ++n) {
    solver.solveUnconstrained(model, state, Vec3(0.0, -9.81, 0.0), {}, settings, executor);
    solver.advance(model, state, {}, settings.step);
    DigestStream digest;
    digest.append(state.position.data(), state.position.size() * sizeof(Vec3));
    digest.append(state.velocity.data(), state.velocity.size() * sizeof(Vec3));
    digests.push_back(digest.value());
  }
  return digests;
}

}  // namespace calot::test
