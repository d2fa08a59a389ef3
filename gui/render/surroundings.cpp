// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/surroundings.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "gui/render/ligament_mesh.h"

namespace calot::gui {
namespace {

/// Ligament and viscera are made for scenes whose y is up: their y of `down` is below this. In others they could hide
/// what is operated on.
constexpr double yUpBelow = -0.5;

bool isOfHilum(StructureRole role) { return role == StructureRole::bileDuct || role == StructureRole::artery; }

/// Height of the lowest point of what is operated on, and of what may be injured (m). The liver's lower border may lie
/// in the omentum.
double lowestOf(const SceneView& view) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const SurfaceView& surface : view.surface) {
    if (surface.role == StructureRole::liver) continue;
    for (const Vec3& p : surface.rest) lowest = std::min(lowest, p.y());
  }
  return lowest;
}

}  // namespace

void Surroundings::update(const SceneView& view) {
  if (const CavityShape shape = cavityShape(view); shape != shape_) {
    wall_ = makeCavity(shape);
    shape_ = shape;
  }
  std::vector<Vec3> vessels;
  for (const SurfaceView& surface : view.surface)
    if (view.down.y() < yUpBelow && isOfHilum(surface.role))
      vessels.insert(vessels.end(), surface.rest.begin(), surface.rest.end());
  if (vessels == vessels_) return;
  ligament_ = makeLigament(vessels);
  viscera_ = makeViscera(vessels, lowestOf(view));
  vessels_ = std::move(vessels);
}

}  // namespace calot::gui
