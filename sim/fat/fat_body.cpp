// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/fat/fat_body.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "sim/math/floating_point.h"
#include "sim/math/linear.h"

namespace calot {

namespace {
constexpr double unitsOfCell = 1048576.0;
}  // namespace

FatVolume::FatVolume(const FatModel& model)
    : model_(model),
      unit_(model.lattice().cell() * (model.lattice().cell() * model.lattice().cell()) / unitsOfCell),
      brick_((1 + model.regions()) * model.lattice().brickCount(), 0),
      marked_(model.lattice().brickCount(), 0),
      region_(model.regions(), 0) {
  work_.reserve(marked_.size());
}

void FatVolume::rebuild(const CarvedField& field) {
  std::fill(brick_.begin(), brick_.end(), 0);
  std::fill(region_.begin(), region_.end(), 0);
  total_ = 0;
  for (std::uint32_t b = 0; b < model_.lattice().brickCount(); ++b) measure(field, b);
}

void FatVolume::update(const CarvedField& field) {
  work_.clear();
  for (const std::uint32_t b : field.changed()) {
    mark(b);
    if (!anyBit(field.removed(b))) continue;
    const Index3 at = model_.lattice().brickAt(b);
    for (int a = 0; a < 3; ++a) {
      if (at[a] > 0) mark(model_.lattice().brick(at - Index3::Unit(a)));
      if (at[a] + 1 < model_.lattice().bricks()[a]) mark(model_.lattice().brick(at + Index3::Unit(a)));
    }
  }
  for (const std::uint32_t b : work_) {
    marked_[b] = 0;
    measure(field, b);
  }
}

void FatVolume::mark(std::uint32_t brick) {
  if (marked_[brick] == 0) work_.push_back(brick);
  marked_[brick] = 1;
}

/// Inside nodes of a brick and their neighbours.
BrickBits FatVolume::countedNodes(const CarvedField& field, std::uint32_t brick) const {
  const BrickLattice& lattice = model_.lattice();
  BrickBits bits = dilated(field.bits(brick));
  const Index3 at = lattice.brickAt(brick);
  const auto beside = [&](int axis, int step) -> const BrickBits* {
    const int there = at[axis] + step;
    if (there < 0 || there >= lattice.bricks()[axis]) return nullptr;
    return &field.bits(lattice.brick(at + step * Index3::Unit(axis)));
  };
  if (const BrickBits* b = beside(0, -1)) {
    for (std::size_t z = 0; z < 8; ++z) bits[z] |= ((*b)[z] & columnLast) >> 7U;
  }
  if (const BrickBits* b = beside(0, 1)) {
    for (std::size_t z = 0; z < 8; ++z) bits[z] |= ((*b)[z] & columnFirst) << 7U;
  }
  if (const BrickBits* b = beside(1, -1)) {
    for (std::size_t z = 0; z < 8; ++z) bits[z] |= (*b)[z] >> 56U;
  }
  if (const BrickBits* b = beside(1, 1)) {
    for (std::size_t z = 0; z < 8; ++z) bits[z] |= (*b)[z] << 56U;
  }
  if (const BrickBits* b = beside(2, -1)) bits[0] |= (*b)[7];
  if (const BrickBits* b = beside(2, 1)) bits[7] |= (*b)[0];
  return bits;
}

void FatVolume::measure(const CarvedField& field, std::uint32_t brick) {
  constexpr std::uint32_t nodes = BrickLattice::brickNodes;
  const double* value = field.values().data() + std::size_t{nodes} * brick;
  const double cell = model_.lattice().cell();
  const BrickBits counted = countedNodes(field, brick);
  std::array<std::int32_t, nodes> units{};
  std::int64_t sum = 0;
  if (anyBit(counted)) {
    for (std::uint32_t i = 0; i < nodes; ++i) {
      const double share = std::min(notNegative(0.5 - value[i] / cell), 1.0);
      units[i] = testBit(counted, i) ? static_cast<std::int32_t>(unitsOfCell * share) : 0;
      sum += units[i];
    }
  }
  std::int64_t* kept = brick_.data() + (1 + model_.regions()) * brick;
  total_ += sum - kept[0];
  kept[0] = sum;
  for (std::size_t r = 0; r < model_.regions(); ++r) {
    std::int64_t in = 0;
    forEachBit(model_.region(r)[brick], [&](std::uint32_t local) { in += units[local]; });
    region_[r] += in - kept[1 + r];
    kept[1 + r] = in;
  }
}

namespace {

constexpr double maxSoftening = 8.0;  ///< greatest factor of a node's compliance

/// Calls visit(lattice node) for each that the last stroke moved outside, by bricks.
template <class Visit>
void forEachRemoved(const CarvedField& field, Visit&& visit) {
  for (const std::uint32_t brick : field.changed()) {
    forEachBit(field.removed(brick), [&](std::uint32_t local) { visit(BrickLattice::brickNodes * brick + local); });
  }
}

}  // namespace

FatBody::FatBody(const FatModel& model)
    : model_(model),
      field_(model.field()),
      islands_(model.lattice(), model.anchors()),
      surface_(model.lattice()),
      contact_(model, field_),
      coarse_(model.lattice(), model.cellsPerCube()),
      volume_(model),
      motion_(model),
      fill_(model.solid().cubes().size(), 0.0),
      tieShare_(model.allTies().size(), 0.0),
      tieStart_(model.solid().cubes().size() + 1, 0) {
  for (const FatTie& tie : model.allTies()) ++tieStart_[slot(tie.cube) + 1];
  for (std::size_t c = 0; c < fill_.size(); ++c) tieStart_[c + 1] += tieStart_[c];
  tieOfCube_.resize(tieShare_.size());
  std::vector<std::size_t> next(tieStart_.begin(), tieStart_.end() - 1);
  for (std::size_t t = 0; t < tieShare_.size(); ++t) tieOfCube_[next[slot(model.allTies()[t].cube)]++] = t;
  rebuildAll();
}

bool FatBody::rebuild(const FatState& state) {
  const FloatingPointScope scope;
  const bool good = fits(model_, state);
  const bool restored = field_.restore(good ? state.carved : CarvedBricks{});
  assert(restored);
  static_cast<void>(restored);
  rebuildAll();
  return good;
}

void FatBody::rebuildAll() {
  islands_.rebuild(field_);
  surface_.rebuild(field_);
  contact_.rebuild(surface_);
  coarse_.rebuild(field_);
  volume_.rebuild(field_);
  updateFill(coarse_.changed());
  before_.clear();
}

void FatBody::updateFill(std::span<const std::uint32_t> hexahedra) {
  for (const std::uint32_t h : hexahedra) {
    const int cube = model_.cubeOfHexahedron(h);
    if (cube < 0) continue;
    fill_[slot(cube)] = std::min(1.0, static_cast<double>(coarse_.counts()[h]) / model_.fullCount());
    measureTies(cube);
  }
}

void FatBody::measureTies(int cube) {
  for (std::size_t i = tieStart_[slot(cube)]; i < tieStart_[slot(cube) + 1]; ++i) {
    const FatTie& tie = model_.allTies()[tieOfCube_[i]];
    std::size_t there = 0;
    for (std::size_t n = tie.firstNode; n < tie.lastNode; ++n) there += field_.inside(model_.tieNodes()[n]) ? 1 : 0;
    tieShare_[tieOfCube_[i]] = static_cast<double>(there) / static_cast<double>(tie.lastNode - tie.firstNode);
  }
}

void FatBody::beginStep(const FatState& state) {
  before_.assign(state.solid.position.begin(), state.solid.position.end());
}

FatStroke FatBody::stroke(FatState& state, std::span<const SweptCapsule> tool, double rise) {
  const FloatingPointScope scope;
  assert(before_.size() == state.solid.position.size());
  const double cell = model_.lattice().cell();
  const double depth = carveDepth * cell;
  if (state.carved.brick.capacity() == 0) field_.reserve(state.carved);
  motion_.choose(tool, state.solid.position, before_, fill_, depth);
  field_.begin();
  carve(field_, tool, motion_.boxes(), motion_, depth, rise);
  return finish(state);
}

/// All that follows from a changed field.
FatStroke FatBody::finish(FatState& state) {
  FatStroke out;
  if (field_.changed().empty()) return out;
  const double cell = model_.lattice().cell();
  const double volumeBefore = volume_.total();
  const std::int64_t loose = islands_.remove(field_);
  field_.commit(state.carved);
  surface_.update(field_);
  contact_.update(surface_);
  coarse_.update(field_);
  volume_.update(field_);
  updateFill(coarse_.changed());
  for (const std::uint32_t h : coarse_.changed()) {
    const int cube = model_.cubeOfHexahedron(h);
    if (cube < 0 || fill_[slot(cube)] > 0.0) continue;
    for (const int node : model_.solid().cubes()[slot(cube)]) {
      const std::span<const std::int32_t> around = model_.cubesAt(node);
      const bool held =
          std::any_of(around.begin(), around.end(), [this](std::int32_t c) { return fill_[slot(c)] > 0.0; });
      if (!held) state.solid.velocity[slot(node)].setZero();
    }
  }
  out.changed = true;
  out.islands = cell * (cell * cell) * static_cast<double>(loose);
  out.removed = volumeBefore - volume_.total();
  out.where = meanPosition(state, out.nodes);
  return out;
}

/// Mean position of what the last stroke removed.
Vec3 FatBody::meanPosition(const FatState& state, std::uint32_t& nodes) const {
  Vec3 sum = Vec3::Zero();
  nodes = 0;
  forEachRemoved(field_, [&](std::uint32_t node) {
    const Index3 at = model_.lattice().nodeAt(node);
    const int cube = model_.cubeOfNode(at);
    const std::array<double, 8> share = model_.shares(cube, at.cast<double>());
    const Index8& corner = model_.solid().cubes()[slot(cube)];
    for (std::size_t c = 0; c < 8; ++c) sum += share[c] * state.solid.position[slot(corner[c])];
    ++nodes;
  });
  return nodes == 0 ? sum : Vec3(sum / static_cast<double>(nodes));
}

Mat3 FatBody::rotation(const FatState& state, int node) const {
  Eigen::Vector4d sum = Eigen::Vector4d::Zero();
  Eigen::Vector4d first = Eigen::Vector4d::Zero();
  double atRest = 0.0;
  double left = 0.0;
  for (const std::int32_t cube : model_.cubesAt(node)) {
    const auto c = slot(cube);
    atRest += model_.restFill()[c];
    left += fill_[c];
    if (!(fill_[c] > 0.0)) continue;
    Eigen::Vector4d q;
    for (int i = 0; i < 4; ++i) q[i] = state.solid.rotation[c / laneCount][slot(i)][c % laneCount];
    if (first.isZero(0.0)) first = q;
    sum += q.dot(first) < 0.0 ? Eigen::Vector4d(-q) : q;
  }
  const double size = sum.norm();
  const Quat q = size > 1e-6 ? Quat(sum[0] / size, sum[1] / size, sum[2] / size, sum[3] / size) : Quat::Identity();
  const double softening = left * maxSoftening > atRest ? atRest / left : maxSoftening;
  return std::sqrt(softening) * q.toRotationMatrix();
}

}  // namespace calot
