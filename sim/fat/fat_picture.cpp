// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/fat/fat_model.h"

#include <algorithm>

#include "sim/math/floating_point.h"
#include "sim/math/linear.h"

namespace calot {

FatPicture::FatPicture(const FatModel& model)
    : model_(model), field_(model.field()), fill_(model.lattice(), model.cellsPerCube()), surface_(model.lattice()) {
  const FloatingPointScope scope;
  fill_.rebuild(field_);
  surface_.rebuild(field_);
  weld();
}

bool FatPicture::update(const CarvedBricks& carved) {
  const FloatingPointScope scope;
  if (field_.raiseTo(carved)) {
    if (field_.changed().empty()) return false;
    fill_.update(field_);
    surface_.update(field_);
  } else {
    static_cast<void>(field_.restore(carved));  // else it is uncarved
    fill_.rebuild(field_);
    surface_.rebuild(field_);
  }
  weld();
  return true;
}

void FatPicture::weld() {
  mesh_ = surface_.mesh();
  carrier_.clear();
  for (const Vec3& p : mesh_.vertex) {
    const int cube = cubeNear(p);
    Carrier carrier;
    carrier.share = model_.shares(cube, Vec3((p - model_.lattice().origin()) / model_.lattice().cell()));
    const Index8& corner = model_.solid().cubes()[slot(cube)];
    for (std::size_t c = 0; c < 8; ++c) carrier.node[c] = corner[c];
    carrier_.push_back(carrier);
  }
}

bool FatPicture::there(int cube) const {
  return cube >= 0 && fill_.counts()[fill_.hexahedron(model_.hexahedronOfCube(cube))] > 0;
}

int FatPicture::cubeNear(const Vec3& rest) const {
  const BrickLattice& lattice = model_.lattice();
  const double edge = lattice.cell() * model_.cellsPerCube();
  const Vec3 at = (rest - lattice.origin()) / edge;
  Index3 h;
  for (int a = 0; a < 3; ++a)
    h[a] = std::clamp(static_cast<int>(std::min(notNegative(at[a]), 1e6)), 0, model_.hexahedra()[a] - 1);
  const int own = model_.cubeAt(h);
  if (there(own)) return own;
  const auto distance = [&](const Index3& cube) {
    Vec3 off;
    for (int a = 0; a < 3; ++a) {
      off[a] = std::max({0.0, static_cast<double>(cube[a]) - at[a], at[a] - static_cast<double>(cube[a] + 1)});
    }
    return off.squaredNorm();
  };
  int best = -1;
  double least = 1e300;
  const auto offer = [&](int cube) {
    if (!there(cube)) return;
    const double d = distance(model_.hexahedronOfCube(cube));
    if (d < least) best = cube;
    least = std::min(least, d);
  };
  for (int d = 0; d < 27; ++d) offer(model_.cubeAt(h + Index3(d % 3 - 1, d / 3 % 3 - 1, d / 9 - 1)));
  if (best >= 0) return best;
  for (std::size_t c = 0; c < model_.solid().cubes().size(); ++c) offer(static_cast<int>(c));
  return std::max(best, 0);
}

void FatPicture::positions(const std::vector<Vec3>& solid, std::vector<Vec3>& out) const {
  const FloatingPointScope scope;
  out.clear();
  out.reserve(carrier_.size());
  for (const Carrier& carrier : carrier_) {
    Vec3 x = Vec3::Zero();
    for (std::size_t c = 0; c < 8; ++c) x += carrier.share[c] * solid[slot(carrier.node[c])];
    out.push_back(x);
  }
}

}  // namespace calot
