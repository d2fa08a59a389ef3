// SPDX-License-Identifier: GPL-3.0-or-later
// Strings of fat: what is left between two parts of it tears when it is pulled, threads sooner than cords.
#include "sim/math/no_fused_pairs.h"  // first

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/fat/fat_body.h"
#include "sim/math/floating_point.h"
#include "sim/math/linear.h"

namespace calot {

namespace {

/// Strain under which a thread of fat tears. Larger: threads are drawn out farther; smaller: they part at a touch.
/// Assumed: no failure stretch of visceral fat was found; lobules hang together by less collagen than the sheets below.
constexpr double threadStrain = 0.5;
/// Strain under which fat of any thickness tears. Larger: cords are drawn out like rubber; smaller: retraction tears
/// what a surgeon would cut. Published: porcine mesentery, fascia and peritoneum fail at stretches of 1.77 to 3.18
/// (White et al., mechanical characterisation of porcine non-intestinal colorectal tissues); the upper end, for whole
/// fat.
constexpr double cordStrain = 2.0;
/// A string whose section, drawn out, is below this is a thread (m^2). Larger: cords tear that a surgeon would cut;
/// smaller: threads hold whole organs. Assumed: a round thread of 1 mm.
constexpr double threadSection = 0.785e-6;
/// Fat so far beside a cube, in its planes, bears the load with it (cells). Larger: threads side by side hold one
/// another. Assumed: half a cube.
constexpr int besideCells = 2;

/// Eigenvalues of a symmetric matrix, and the unit eigenvectors as columns, by rotations that each clear one entry
/// (Jacobi 1846): five rounds leave rounding alone.
void eigen(Mat3& a, Mat3& vectors) {
  vectors.setIdentity();
  constexpr int rounds = 5;
  for (int round = 0; round < rounds; ++round) {
    for (int k = 0; k < 3; ++k) {
      const int p = k == 2 ? 1 : 0;
      const int q = k == 0 ? 1 : 2;
      if (a(p, q) == 0.0) continue;
      const double theta = 0.5 * (a(q, q) - a(p, p)) / a(p, q);
      const double sign = theta < 0.0 ? -1.0 : 1.0;
      const double t = sign / (std::abs(theta) + std::sqrt(theta * theta + 1.0));
      const double c = 1.0 / std::sqrt(t * t + 1.0);
      const double s = t * c;
      for (int i = 0; i < 3; ++i) {
        const double x = a(i, p);
        a(i, p) = c * x - s * a(i, q);
        a(i, q) = s * x + c * a(i, q);
      }
      for (int i = 0; i < 3; ++i) {
        const double x = a(p, i);
        a(p, i) = c * x - s * a(q, i);
        a(q, i) = s * x + c * a(q, i);
        const double v = vectors(i, p);
        vectors(i, p) = c * v - s * vectors(i, q);
        vectors(i, q) = s * v + c * vectors(i, q);
      }
    }
  }
}

/// Right Cauchy-Green tensor of a cube's mean deformation gradient.
Mat3 stretchOf(const Index8& corner, const std::vector<Vec3>& position, double edge) {
  Mat3 f = Mat3::Zero();
  for (std::size_t c = 0; c < 8; ++c) {
    for (int j = 0; j < 3; ++j) f.col(j) += ((c >> j & 1U) != 0 ? 1.0 : -1.0) * position[slot(corner[c])];
  }
  f *= 0.25 / edge;
  Mat3 out;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) out(i, j) = f.col(i).dot(f.col(j));
  }
  return out;
}

struct Pull {
  double strain = 0.0;         ///< along the pull, and no more than such a tension would cause alone
  Vec3 along = Vec3::UnitX();  ///< unit, in the reference configuration
};

/// Tissue that is pressed flat, or swells, is stretched without tension or under tension without being stretched; only
/// what is both is pulled.
Pull pullOf(Mat3 stretch, const LameConstants& lame) {
  Mat3 vectors;
  eigen(stretch, vectors);
  int most = 0;
  double sum = 0.0;
  for (int k = 0; k < 3; ++k) {
    if (stretch(k, k) > stretch(most, most)) most = k;
    sum += std::sqrt(notNegative(stretch(k, k))) - 1.0;
  }
  const double strain = std::sqrt(notNegative(stretch(most, most))) - 1.0;
  const double young = lame.mu * (3.0 * lame.lambda + 2.0 * lame.mu) / (lame.lambda + lame.mu);
  const double tension = (lame.lambda * sum + 2.0 * lame.mu * strain) / young;
  return {std::min(strain, tension), vectors.col(most)};
}

}  // namespace

/// Least section of the fat in a cube and close beside it across a lattice axis (m^2), over the cube's planes of nodes.
double FatBody::section(int cube, int axis) const {
  const BrickLattice& lattice = model_.lattice();
  const int k = model_.cellsPerCube();
  const Index3 first = k * model_.hexahedronOfCube(cube);
  Index3 lower = (first.array() - besideCells).max(0);
  Index3 upper = (first.array() + k - 1 + besideCells).min(lattice.nodes().array() - 1);
  int least = k * k * k * k;
  for (int plane = 0; plane < k; ++plane) {
    lower[axis] = upper[axis] = first[axis] + plane;
    int count = 0;
    forEachIndex(lower, upper, [&](const Index3& n) { count += field_.inside(lattice.node(n)) ? 1 : 0; });
    least = std::min(least, count);
  }
  return lattice.cell() * lattice.cell() * static_cast<double>(least);
}

/// Cube of the string that is stretched most, beyond what it bears; -1: no string is.
int FatBody::overstretched(const FatState& state) const {
  const SolidModel& solid = model_.solid();
  const double edge = model_.cellsPerCube() * model_.lattice().cell();
  const double limit = (1.0 + threadStrain) * (1.0 + threadStrain);
  int found = -1;
  double most = threadStrain;
  for (std::size_t c = 0; c < fill_.size(); ++c) {
    if (!(fill_[c] > 0.0)) continue;
    const Mat3 stretch = stretchOf(solid.cubes()[c], state.solid.position, edge);
    // No eigenvalue is greater than the largest sum of a row (Gershgorin).
    if (!(stretch.cwiseAbs().rowwise().sum().maxCoeff() > limit)) continue;
    const Pull pull = pullOf(stretch, solid.material().lame);
    if (!(pull.strain > most)) continue;
    int axis = 0;
    const double oblique = pull.along.cwiseAbs().maxCoeff(&axis);
    // Fat keeps its volume: what is drawn out grows thin.
    const double least = threadSection * (1.0 + pull.strain) / oblique;
    if (!(pull.strain > cordStrain) && !(section(static_cast<int>(c), axis) < least)) continue;
    most = pull.strain;
    found = static_cast<int>(c);
  }
  return found;
}

FatStroke FatBody::tear(FatState& state) {
  const FloatingPointScope scope;
  const int cube = overstretched(state);
  if (cube < 0) return {};
  const BrickLattice& lattice = model_.lattice();
  if (state.carved.brick.capacity() == 0) field_.reserve(state.carved);
  const int k = model_.cellsPerCube();
  const Index3& h = model_.hexahedronOfCube(cube);
  field_.begin();
  forEachIndex(k * h, coarse_.upper(h).array() - 1, [&](const Index3& n) {
    const std::uint32_t node = lattice.node(n);
    if (!field_.inside(node)) return;
    BrickBits bits{};
    bits[node >> 6U & 7U] = std::uint64_t{1} << (node & 63U);
    field_.remove(node / BrickLattice::brickNodes, bits);
  });
  return finish(state);
}

bool FatBody::joins(std::span<const std::uint32_t> thing, std::uint32_t things) {
  islands_.connect(field_, things);
  for (std::size_t t = 0; t < thing.size(); ++t) {
    const FatTie& tie = model_.allTies()[t];
    for (std::size_t n = tie.firstNode; n < tie.lastNode; ++n) {
      if (field_.inside(model_.tieNodes()[n])) islands_.hang(thing[t], model_.tieNodes()[n]);
    }
  }
  return islands_.connected(0, 1);
}

}  // namespace calot
