// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/haptics/port_force.h"

#include <algorithm>

namespace calot {

Vec3 portForce(const PortModel& model, const Vec3& tip, double& seal) {
  Vec3 force = Vec3::Zero();
  if (!model.felt()) return force;
  const Vec3 reach = tip - model.port;
  const double length = reach.norm();
  const Vec3 axis = reach / length;
  if (model.trocarFriction > 0.0) {
    if (seal < 0.0) seal = length;
    const double maxStretch = model.trocarFriction / model.sealStiffness;
    const double stretch = std::clamp(length - seal, -maxStretch, maxStretch);
    seal = length - stretch;
    force -= (model.sealStiffness * stretch) * axis;
  }
  if (model.wallStiffness > 0.0) {
    const Vec3 across = model.neutralAxis - axis * axis.dot(model.neutralAxis);
    force += (model.wallStiffness / length) * across;
  }
  return force;
}

}  // namespace calot
