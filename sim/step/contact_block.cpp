// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/contact_block.h"

namespace calot {

void ContactSystem::numberRows() {
  rows = 0;
  kinds.clear();
  limits.clear();
  for (ContactBlock& block : blocks) {
    block.row = rows;
    rows += block.rows();
    kinds.push_back(block.kind);
    limits.push_back(block.limit);
  }
}

void addNodalForces(std::span<const ContactBlock> blocks, std::size_t body, std::size_t nodes,
                    std::span<const double> forces, double scale, std::vector<Vec3>& nodal) {
  for (const ContactBlock& block : blocks) {
    for (const bool other : {false, true}) {
      if ((other ? block.other : block.body) != body) continue;
      Vec3 force = Vec3::Zero();
      for (std::size_t k = 0; k < block.rows(); ++k) force += forces[block.row + k] * block.direction[k];
      if (force.isZero(0.0)) continue;
      if (nodal.empty()) nodal.assign(nodes, Vec3::Zero());
      const SolidSolver::Impulse& place = other ? block.otherPlace : block.place;
      const double sign = other ? scale : -scale;
      for (std::size_t k = 0; k < place.count; ++k) {
        nodal[static_cast<std::size_t>(place.node[k])] += sign * place.weight[k] * force;
      }
    }
  }
}

}  // namespace calot
