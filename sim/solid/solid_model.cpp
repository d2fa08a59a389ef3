// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/solid/solid_model.h"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <utility>

namespace calot {

SolidModel::SolidModel(std::vector<Vec3> rest, std::vector<Index4> tetrahedra, const std::vector<bool>& fixed,
                       Material material)
    : rest_(std::move(rest)),
      tetrahedra_(std::move(tetrahedra)),
      material_(material),
      elements_(TetrahedralElements(rest_, tetrahedra_)),
      system_({tetrahedra_, {}}, fixed) {
  mass_.assign(rest_.size(), 0.0);
  for (std::size_t e = 0; e < tetrahedra_.size(); ++e) {
    const double quarter = 0.25 * material_.density * elements().restVolume(e);
    for (int a = 0; a < 4; ++a) mass_[static_cast<std::size_t>(tetrahedra_[e][a])] += quarter;
  }
  wholeMass_ = std::accumulate(mass_.begin(), mass_.end(), 0.0);
}

SolidModel::SolidModel(std::vector<Vec3> rest, std::vector<Index8> cubes, double edge, const std::vector<bool>& fixed,
                       Material material)
    : rest_(std::move(rest)),
      cube_(std::move(cubes)),
      material_(material),
      elements_(HexahedralElements(cube_, edge, material_.lame)),
      system_({{}, cube_}, fixed) {
  mass_.assign(rest_.size(), 0.0);
  const double eighth = 0.125 * material_.density * (edge * edge * edge);
  for (const Index8& cube : cube_) {
    for (const int node : cube) mass_[static_cast<std::size_t>(node)] += eighth;
  }
  wholeMass_ = std::accumulate(mass_.begin(), mass_.end(), 0.0);
}

std::size_t SolidModel::groups() const { return laneGroups(elementCount()); }

double SolidModel::volume(std::span<const Vec3> position, std::span<const double> fill) const {
  return madeOfCubes() ? hexahedra().volume(position, fill) : elements().volume(position);
}

Mat3 rotationOf(std::span<const RotationGroup> rotation, int element) {
  const auto e = static_cast<std::size_t>(element);
  const RotationGroup& group = rotation[e / laneCount];
  const std::size_t l = e % laneCount;
  return Quat(group[0][l], group[1][l], group[2][l], group[3][l]).toRotationMatrix();
}

SolidState restState(const SolidModel& model) {
  SolidState state;
  state.position = model.rest();
  state.velocity.assign(model.nodes(), Vec3::Zero());
  RotationGroup identity{};
  identity[0].fill(1.0);
  state.rotation.assign(model.groups(), identity);
  state.quietSteps = 1U << 20U;
  state.volume = model.volume(state.position);
  return state;
}

void SolidModel::massOf(std::span<const double> fill, std::vector<double>& mass) const {
  mass.assign(rest_.size(), 0.0);
  const double edge = hexahedra().edge();
  const double eighth = 0.125 * material_.density * (edge * edge * edge);
  for (std::size_t e = 0; e < cube_.size(); ++e) {
    for (const int node : cube_[e]) mass[static_cast<std::size_t>(node)] += fill[e] * eighth;
  }
}

void SolidModel::preload(std::span<const Vec3> displacement) {
  if (madeOfCubes()) {
    std::get<HexahedralElements>(elements_).preload(displacement);
  } else {
    std::get<TetrahedralElements>(elements_).preload(displacement, material_.lame);
  }
}

std::vector<std::int32_t> SolidModel::elementsAt(std::size_t node) const {
  std::vector<std::int32_t> out;
  for (const SolidSystem::Contribution& corner : system_.incident(node)) out.push_back(corner.element);
  return out;
}

}  // namespace calot
