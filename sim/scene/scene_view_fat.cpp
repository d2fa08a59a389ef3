// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstring>

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

FatViewer::FatViewer(const FatModel& model) : model_(model), body_(model), uncarved_(model.field()) {}

bool FatViewer::sameAsLast(const CarvedBricks& carved) const {
  // Bytes: a difference that is none costs a rebuild, not a wrong picture.
  return carved.brick == last_.brick && carved.value.size() == last_.value.size() &&
         (carved.value.empty() || std::memcmp(carved.value.data(), last_.value.data(),
                                              carved.value.size() * sizeof(CarvedBricks::Values)) == 0);
}

void FatViewer::rebuild(const FatState& state) {
  if (made_ || !state.carved.brick.empty()) static_cast<void>(body_.rebuild(state));
  body_.picture(state, picture_);
  last_ = state.carved;
  made_ = true;
  carrier_.clear();
  seared_.clear();
  const BrickLattice& lattice = model_.lattice();
  for (const Vec3& rest : picture_.rest) {
    const int cube = body_.cubeNear(rest);
    const Vec3 at = (rest - lattice.origin()) / lattice.cell();
    const Index8& corner = model_.solid().cubes()[slot(cube)];
    Carrier carrier;
    carrier.share = model_.shares(cube, at);
    for (std::size_t c = 0; c < 8; ++c) carrier.node[c] = corner[c];
    carrier_.push_back(carrier);
    if (last_.brick.empty()) continue;
    const double depth = -sampleField(uncarved_, at).value / lattice.cell();
    const double bare = std::clamp((depth - bareFrom) / (bareFully - bareFrom), 0.0, 1.0);
    seared_.push_back(searing * static_cast<float>(bare));
  }
}

void FatViewer::fill(const FatState& state, SurfaceView& surface) {
  if (!made_ || !sameAsLast(state.carved)) rebuild(state);
  surface.rest = picture_.rest;
  surface.triangle = picture_.triangle;
  surface.charred = seared_;
  surface.position.clear();
  surface.position.reserve(carrier_.size());
  for (const Carrier& carrier : carrier_) {
    Vec3 x = Vec3::Zero();
    for (std::size_t c = 0; c < 8; ++c) x += carrier.share[c] * state.solid.position[slot(carrier.node[c])];
    surface.position.push_back(x);
  }
}

}  // namespace calot
