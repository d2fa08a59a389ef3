// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solid/solid.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace calot {

namespace {

/// Breadth-first order from the node of fewest neighbours, neighbours by index: keeps rows that touch near each other.
std::vector<int> breadthFirst(const std::vector<std::vector<int>>& neighbours) {
  std::vector<int> order;
  std::vector<bool> seen(neighbours.size(), false);
  std::vector<int> seeds(neighbours.size());
  for (std::size_t i = 0; i < seeds.size(); ++i) seeds[i] = static_cast<int>(i);
  std::stable_sort(seeds.begin(), seeds.end(), [&](int a, int b) {
    return neighbours[static_cast<std::size_t>(a)].size() < neighbours[static_cast<std::size_t>(b)].size();
  });
  for (const int seed : seeds) {
    if (seen[static_cast<std::size_t>(seed)]) continue;
    seen[static_cast<std::size_t>(seed)] = true;
    order.push_back(seed);
    for (std::size_t at = order.size() - 1; at < order.size(); ++at) {
      for (const int n : neighbours[static_cast<std::size_t>(order[at])]) {
        if (seen[static_cast<std::size_t>(n)]) continue;
        seen[static_cast<std::size_t>(n)] = true;
        order.push_back(n);
      }
    }
  }
  return order;
}

}  // namespace

SolidModel::SolidModel(std::vector<Vec3> rest, std::vector<Index4> tetrahedra, std::vector<bool> fixed,
                       Material material)
    : rest_(std::move(rest)),
      tetrahedra_(std::move(tetrahedra)),
      fixed_(std::move(fixed)),
      material_(material),
      elements_(TetrahedralElements(rest_, tetrahedra_)) {
  mass_.assign(rest_.size(), 0.0);
  for (std::size_t e = 0; e < tetrahedra_.size(); ++e) {
    const double quarter = 0.25 * material_.density * elements().restVolume(e);
    for (int a = 0; a < 4; ++a) mass_[static_cast<std::size_t>(tetrahedra_[e][a])] += quarter;
  }
  buildStructure();
}

SolidModel::SolidModel(std::vector<Vec3> rest, std::vector<Index8> cubes, double edge, std::vector<bool> fixed,
                       Material material)
    : rest_(std::move(rest)),
      cube_(std::move(cubes)),
      fixed_(std::move(fixed)),
      material_(material),
      elements_(HexahedralElements(cube_, edge, material_.lame)) {
  mass_.assign(rest_.size(), 0.0);
  const double eighth = 0.125 * material_.density * (edge * edge * edge);
  for (const Index8& cube : cube_) {
    for (const int node : cube) mass_[static_cast<std::size_t>(node)] += eighth;
  }
  buildStructure();
}

std::size_t SolidModel::groups() const { return laneGroups(elementCount()); }

double SolidModel::volume(std::span<const Vec3> position, std::span<const double> fill) const {
  return madeOfCubes() ? hexahedra().volume(position, fill) : elements().volume(position);
}

std::vector<std::vector<int>> SolidModel::neighbours() const {
  std::vector<std::vector<int>> out(rest_.size());
  for (std::size_t e = 0; e < elementCount(); ++e) {
    for (const int a : cornersOf(e)) {
      for (const int b : cornersOf(e)) {
        if (a != b) out[static_cast<std::size_t>(a)].push_back(b);
      }
    }
  }
  for (std::vector<int>& list : out) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return out;
}

void SolidModel::buildStructure() {
  const std::size_t nodeCount = rest_.size();
  const std::vector<std::vector<int>> near = neighbours();
  row_.assign(nodeCount, -1);
  for (const int node : breadthFirst(near)) {
    if (fixed_[static_cast<std::size_t>(node)]) continue;
    row_[static_cast<std::size_t>(node)] = static_cast<int>(freeNode_.size());
    freeNode_.push_back(node);
  }
  std::vector<std::vector<int>> columns(freeNode_.size());
  diagonal_.resize(freeNode_.size());
  for (std::size_t r = 0; r < freeNode_.size(); ++r) {
    columns[r].push_back(static_cast<int>(r));
    for (const int n : near[static_cast<std::size_t>(freeNode_[r])]) {
      if (row_[static_cast<std::size_t>(n)] >= 0) columns[r].push_back(row_[static_cast<std::size_t>(n)]);
    }
    std::sort(columns[r].begin(), columns[r].end());
    diagonal_[r] = static_cast<int>(std::lower_bound(columns[r].begin(), columns[r].end(), static_cast<int>(r)) -
                                    columns[r].begin());
  }
  matrix_ = BlockMatrix(columns);

  // Contributions to each block, in element order; incident corners of each node likewise.
  std::vector<std::vector<std::vector<Contribution>>> perSlot(freeNode_.size());
  for (std::size_t r = 0; r < columns.size(); ++r) perSlot[r].resize(columns[r].size());
  std::vector<std::vector<Contribution>> perNode(nodeCount);
  for (std::size_t e = 0; e < elementCount(); ++e) {
    const std::span<const int> corner = cornersOf(e);
    for (std::size_t a = 0; a < corner.size(); ++a) {
      const auto node = static_cast<std::size_t>(corner[a]);
      perNode[node].push_back({static_cast<std::int32_t>(e), static_cast<std::uint8_t>(a), 0});
      if (row_[node] < 0) continue;
      const auto r = static_cast<std::size_t>(row_[node]);
      for (std::size_t b = 0; b < corner.size(); ++b) {
        const int c = row_[static_cast<std::size_t>(corner[b])];
        if (c < 0) continue;
        const auto k =
            static_cast<std::size_t>(std::lower_bound(columns[r].begin(), columns[r].end(), c) - columns[r].begin());
        perSlot[r][k].push_back(
            {static_cast<std::int32_t>(e), static_cast<std::uint8_t>(a), static_cast<std::uint8_t>(b)});
      }
    }
  }
  for (std::size_t r = 0; r < columns.size(); ++r) {
    rowSlot_.push_back(slot_.size());
    for (std::size_t k = 0; k < columns[r].size(); ++k) {
      const std::size_t first = contribution_.size();
      contribution_.insert(contribution_.end(), perSlot[r][k].begin(), perSlot[r][k].end());
      slot_.push_back({matrix_.slot(r, k), static_cast<std::int32_t>(r), columns[r][k],
                       static_cast<int>(k) == diagonal_[r], first, contribution_.size()});
    }
  }
  rowSlot_.push_back(slot_.size());
  for (const SlotRange& range : slot_) slotColumn_.push_back(range.column);
  incidentStart_.push_back(0);
  for (const std::vector<Contribution>& list : perNode) {
    incident_.insert(incident_.end(), list.begin(), list.end());
    incidentStart_.push_back(incident_.size());
  }
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

std::size_t SolidModel::slotOf(int row, int column) const {
  const auto first = slotColumn_.begin() + static_cast<std::ptrdiff_t>(rowSlot_[static_cast<std::size_t>(row)]);
  const auto last = slotColumn_.begin() + static_cast<std::ptrdiff_t>(rowSlot_[static_cast<std::size_t>(row) + 1]);
  const auto found = std::lower_bound(first, last, column);
  if (found == last || *found != column) return noSlot;
  return slot_[static_cast<std::size_t>(found - slotColumn_.begin())].slot;
}

void SolidModel::massOf(std::span<const double> fill, std::vector<double>& mass) const {
  mass.assign(rest_.size(), 0.0);
  const double edge = hexahedra().edge();
  const double eighth = 0.125 * material_.density * (edge * edge * edge);
  for (std::size_t e = 0; e < cube_.size(); ++e) {
    for (const int node : cube_[e]) mass[static_cast<std::size_t>(node)] += fill[e] * eighth;
  }
}

std::vector<std::int32_t> SolidModel::elementsAt(std::size_t node) const {
  std::vector<std::int32_t> out;
  for (std::size_t k = incidentStart_[node]; k < incidentStart_[node + 1]; ++k) out.push_back(incident_[k].element);
  return out;
}

Vec3 SolidPlace::of(std::span<const Vec3> values) const {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < count; ++k) sum += weight[k] * values[static_cast<std::size_t>(node[k])];
  return sum;
}

Mat3 JointAttachment::block(std::size_t i, std::size_t j) const {
  Mat3 m;
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 0; b < 3; ++b) {
      m(static_cast<int>(a), static_cast<int>(b)) = damper[(3 * i + a) * 3 * place.size() + 3 * j + b];
    }
  }
  return m;
}

}  // namespace calot
