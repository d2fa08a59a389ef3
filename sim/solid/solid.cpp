// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solid/solid.h"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <utility>

namespace calot {

namespace {

/// Rows of one colour that are sorted among themselves by how many blocks they have, so that a slice holds like ones;
/// few enough to stay close to each other.
constexpr std::size_t sortedRows = 128;

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

/// Numbers the rows by colours. @param near neighbours of each node
/// @return how many rows there are, each colour filled up to whole slices
std::size_t SolidModel::orderRows(const std::vector<std::vector<int>>& near) {
  row_.assign(rest_.size(), -1);
  freeNode_.clear();
  for (std::size_t node = 0; node < rest_.size(); ++node) {
    if (!fixed_[node]) freeNode_.push_back(static_cast<int>(node));
  }
  std::vector<int> numberOf(rest_.size(), -1);  // among the free ones
  for (std::size_t i = 0; i < freeNode_.size(); ++i)
    numberOf[static_cast<std::size_t>(freeNode_[i])] = static_cast<int>(i);
  std::vector<std::vector<int>> graph(freeNode_.size());
  for (std::size_t i = 0; i < freeNode_.size(); ++i) {
    for (const int n : near[static_cast<std::size_t>(freeNode_[i])]) {
      if (numberOf[static_cast<std::size_t>(n)] >= 0) graph[i].push_back(numberOf[static_cast<std::size_t>(n)]);
    }
  }
  std::vector<std::vector<int>> colours = coloured(graph);
  std::vector<std::size_t> colourOf(freeNode_.size());
  for (std::size_t c = 0; c < colours.size(); ++c) {
    for (const int i : colours[c]) colourOf[static_cast<std::size_t>(i)] = c;
  }
  std::size_t row = 0;
  for (std::size_t c = 0; c < colours.size(); ++c) {
    const auto blocksOf = [&](int i) {
      const std::vector<int>& own = graph[static_cast<std::size_t>(i)];
      return std::count_if(own.begin(), own.end(), [&](int n) { return colourOf[static_cast<std::size_t>(n)] < c; });
    };
    for (std::size_t first = 0; first < colours[c].size(); first += sortedRows) {
      const std::size_t last = std::min(first + sortedRows, colours[c].size());
      std::stable_sort(colours[c].begin() + static_cast<std::ptrdiff_t>(first),
                       colours[c].begin() + static_cast<std::ptrdiff_t>(last),
                       [&](int a, int b) { return blocksOf(a) > blocksOf(b); });
    }
    for (std::size_t i = 0; i < colours[c].size(); ++i) {
      row_[static_cast<std::size_t>(freeNode_[static_cast<std::size_t>(colours[c][i])])] = static_cast<int>(row + i);
    }
    row += laneGroups(colours[c].size()) * laneCount;
  }
  return row;
}

void SolidModel::buildStructure() {
  const std::size_t nodeCount = rest_.size();
  const std::vector<std::vector<int>> near = neighbours();
  std::vector<std::vector<int>> columns(orderRows(near));
  for (const int node : freeNode_) {
    const int row = row_[static_cast<std::size_t>(node)];
    std::vector<int>& own = columns[static_cast<std::size_t>(row)];
    own.push_back(row);
    for (const int n : near[static_cast<std::size_t>(node)]) {
      const int column = row_[static_cast<std::size_t>(n)];
      if (column >= 0 && column < row) own.push_back(column);
    }
    std::sort(own.begin(), own.end());
  }
  matrix_ = BlockMatrix(columns);

  // Contributions to each block, in element order; incident corners of each node likewise.
  std::vector<std::vector<std::vector<Contribution>>> perSlot(columns.size());
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
        if (c < 0 || c > row_[node]) continue;
        const auto k =
            static_cast<std::size_t>(std::lower_bound(columns[r].begin(), columns[r].end(), c) - columns[r].begin());
        perSlot[r][k].push_back(
            {static_cast<std::int32_t>(e), static_cast<std::uint8_t>(a), static_cast<std::uint8_t>(b)});
      }
    }
  }
  std::vector<std::int32_t> nodeOf(columns.size(), -1);
  for (const int node : freeNode_) nodeOf[static_cast<std::size_t>(row_[static_cast<std::size_t>(node)])] = node;
  for (std::size_t r = 0; r < columns.size(); ++r) {
    rowSlot_.push_back(slotColumn_.size());
    for (std::size_t k = 0; k < columns[r].size(); ++k) {
      slotColumn_.push_back(columns[r][k]);
      slotPlace_.push_back(matrix_.slot(r, k));
      const std::int32_t node = columns[r][k] == static_cast<int>(r) ? nodeOf[r] : -1;
      if (!madeOfCubes()) {
        const std::size_t first = contribution_.size();
        contribution_.insert(contribution_.end(), perSlot[r][k].begin(), perSlot[r][k].end());
        slot_.push_back({slotPlace_.back(), node, first, contribution_.size(), contribution_.size()});
        continue;
      }
      const std::size_t first = cubeBlock_.size();
      std::size_t turned = first;
      for (const bool transposed : {false, true}) {
        for (const Contribution& c : perSlot[r][k]) {
          if ((c.a > c.b) != transposed) continue;
          cubeBlock_.push_back(
              static_cast<std::uint32_t>(36 * static_cast<std::size_t>(c.element) +
                                         HexahedralElements::pairOf(std::min(c.a, c.b), std::max(c.a, c.b))));
        }
        if (!transposed) turned = cubeBlock_.size();
      }
      slot_.push_back({slotPlace_.back(), node, first, cubeBlock_.size(), turned});
    }
  }
  rowSlot_.push_back(slotColumn_.size());
  for (std::size_t e = 0; e < elementCount(); ++e) {
    for (const int a : cornersOf(e)) {
      for (const int b : cornersOf(e)) {
        const int row = row_[static_cast<std::size_t>(a)];
        const int column = row_[static_cast<std::size_t>(b)];
        elementSlot_.push_back(column < 0 || column > row ? noSlot : slotOf(row, column));
      }
    }
  }
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
  return slotPlace_[static_cast<std::size_t>(found - slotColumn_.begin())];
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
