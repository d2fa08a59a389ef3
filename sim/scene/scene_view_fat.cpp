// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "sim/carving/field_sample.h"
#include "sim/scene/scene_view_parts.h"

namespace calot {

namespace {

/// What lies this far below the uncarved surface was laid bare by the hook, in cells: from, fully.
constexpr double bareFrom = 0.4;
constexpr double bareFully = 1.6;
/// Such tissue is seared, not charred through.
constexpr float searing = 0.3F;

}  // namespace

FatViewer::FatViewer(const FatModel& model) : model_(model), uncarved_(model.field()), picture_(model) {}

void FatViewer::sear() {
  const BrickLattice& lattice = model_.lattice();
  seared_.clear();
  for (const Vec3& rest : picture_.rest()) {
    const Vec3 at = (rest - lattice.origin()) / lattice.cell();
    const double depth = -sampleField(uncarved_, at).value / lattice.cell();
    const double bare = std::clamp((depth - bareFrom) / (bareFully - bareFrom), 0.0, 1.0);
    seared_.push_back(searing * static_cast<float>(bare));
  }
}

void FatViewer::fill(const FatState& state, SurfaceView& surface) {
  if (picture_.update(state.carved)) sear();
  surface.rest = picture_.rest();
  surface.triangle = picture_.triangles();
  if (!state.carved.brick.empty()) surface.charred = seared_;
  picture_.positions(state.solid.position, surface.position);
}

}  // namespace calot
