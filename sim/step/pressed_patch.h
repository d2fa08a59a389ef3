// SPDX-License-Identifier: GPL-3.0-or-later
// The patch of an organ's skin that takes the force of an instrument's capsule. Internal to this folder.
//
// A force on the corners of one triangle pulls a node down by more than its cell where cells are as small as the tip,
// and into a cone where they are larger: neither is linear any more. So a part of the force goes to a ring of points
// about the contact point. How the skin gives way under such a load follows from the nodes' weights (meshSpread()); the
// dimple is what a round end sinks in beyond that.
#pragma once

#include <array>
#include <vector>

#include "sim/step/body.h"
#include "sim/tissue/organ/organ_tissue.h"

namespace calot {

/// The skin's normal at a place in a triangle, as it varies between those at the corners (Phong 1975); zero where these
/// cancel.
Vec3 smoothNormal(const ContactSurface& mesh, const std::vector<Vec3>& points, const std::array<int, 3>& node,
                  const Vec3& weight);

/// Nodes that take the force of a capsule on a triangle of an organ's skin. Depends on the place alone, not on how the
/// skin is deformed. @param weight barycentric coordinates @param radius of the capsule (m)
SolidSolver::Impulse pressedPatch(const OrganModel& organ, const Skin& skin, const std::array<int, 3>& node,
                                  const Vec3& weight, double radius);

}  // namespace calot
