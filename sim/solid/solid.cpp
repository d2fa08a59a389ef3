// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solid/solid.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/math/floating_point.h"

namespace calot {

namespace {

constexpr std::size_t rowsPerTask = 128;

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

std::vector<std::vector<int>> neighboursOf(std::size_t nodes, const std::vector<Index4>& tetrahedra) {
  std::vector<std::vector<int>> neighbours(nodes);
  for (const Index4& t : tetrahedra) {
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        if (a != b) neighbours[static_cast<std::size_t>(t[a])].push_back(t[b]);
      }
    }
  }
  for (std::vector<int>& list : neighbours) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return neighbours;
}

}  // namespace

SolidModel::SolidModel(std::vector<Vec3> rest, std::vector<Index4> tetrahedra, std::vector<bool> fixed,
                       Material material)
    : rest_(std::move(rest)),
      tetrahedra_(std::move(tetrahedra)),
      fixed_(std::move(fixed)),
      material_(material),
      elements_(rest_, tetrahedra_) {
  mass_.assign(rest_.size(), 0.0);
  for (std::size_t e = 0; e < tetrahedra_.size(); ++e) {
    const double quarter = 0.25 * material_.density * elements_.restVolume(e);
    for (int a = 0; a < 4; ++a) mass_[static_cast<std::size_t>(tetrahedra_[e][a])] += quarter;
  }
  buildStructure();
}

void SolidModel::buildStructure() {
  const std::size_t nodeCount = rest_.size();
  const std::vector<std::vector<int>> neighbours = neighboursOf(nodeCount, tetrahedra_);
  row_.assign(nodeCount, -1);
  for (const int node : breadthFirst(neighbours)) {
    if (fixed_[static_cast<std::size_t>(node)]) continue;
    row_[static_cast<std::size_t>(node)] = static_cast<int>(freeNode_.size());
    freeNode_.push_back(node);
  }
  std::vector<std::vector<int>> columns(freeNode_.size());
  diagonal_.resize(freeNode_.size());
  for (std::size_t r = 0; r < freeNode_.size(); ++r) {
    columns[r].push_back(static_cast<int>(r));
    for (const int n : neighbours[static_cast<std::size_t>(freeNode_[r])]) {
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
  for (std::size_t e = 0; e < tetrahedra_.size(); ++e) {
    for (int a = 0; a < 4; ++a) {
      const auto node = static_cast<std::size_t>(tetrahedra_[e][a]);
      perNode[node].push_back({static_cast<std::int32_t>(e), static_cast<std::uint8_t>(a), 0});
      if (row_[node] < 0) continue;
      const auto r = static_cast<std::size_t>(row_[node]);
      for (int b = 0; b < 4; ++b) {
        const int c = row_[static_cast<std::size_t>(tetrahedra_[e][b])];
        if (c < 0) continue;
        const auto k =
            static_cast<std::size_t>(std::lower_bound(columns[r].begin(), columns[r].end(), c) - columns[r].begin());
        perSlot[r][k].push_back(
            {static_cast<std::int32_t>(e), static_cast<std::uint8_t>(a), static_cast<std::uint8_t>(b)});
      }
    }
  }
  for (std::size_t r = 0; r < columns.size(); ++r) {
    for (std::size_t k = 0; k < columns[r].size(); ++k) {
      const std::size_t first = contribution_.size();
      contribution_.insert(contribution_.end(), perSlot[r][k].begin(), perSlot[r][k].end());
      slot_.push_back({matrix_.slot(r, k), static_cast<std::int32_t>(r), static_cast<int>(k) == diagonal_[r], first,
                       contribution_.size()});
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
  state.rotation.assign(model.elements().groups().size(), identity);
  state.quietSteps = 1U << 20U;
  state.volume = model.elements().volume(state.position);
  return state;
}

void SolidSolver::assemble(const SolidModel& model, const Settings& settings, Executor& executor) {
  const double h = settings.step;
  const SolidModel::Material& m = model.material_;
  const auto scale = static_cast<float>(h * h + m.stiffnessDamping * h);
  const double massScale = 1.0 + m.massDamping * h;
  const float lambda = scale * static_cast<float>(m.lame.lambda);
  const float mu = scale * static_cast<float>(m.lame.mu);
  const std::vector<ElementGroup>& groups = model.elements_.groups();
  values_.assign(model.matrix_.valueCount(), 0.0F);
  const std::size_t tasks = (model.slot_.size() + 8 * rowsPerTask - 1) / (8 * rowsPerTask);
  executor.run(tasks, [&](std::size_t task) {
    const FloatingPointScope scope;
    const std::size_t last = std::min(model.slot_.size(), (task + 1) * 8 * rowsPerTask);
    for (std::size_t s = task * 8 * rowsPerTask; s < last; ++s) {
      const SolidModel::SlotRange& range = model.slot_[s];
      float block[9] = {};
      for (std::size_t c = range.first; c < range.last; ++c) {
        const SolidModel::Contribution& contribution = model.contribution_[c];
        const auto e = static_cast<std::size_t>(contribution.element);
        const ElementResult& element = element_[e / laneCount];
        const std::size_t l = e % laneCount;
        const auto a = static_cast<std::size_t>(contribution.a);
        const auto b = static_cast<std::size_t>(contribution.b);
        const auto volume = static_cast<float>(groups[e / laneCount].volume[l]);
        const float ga[3] = {element.gradient[a][0][l], element.gradient[a][1][l], element.gradient[a][2][l]};
        const float gb[3] = {element.gradient[b][0][l], element.gradient[b][1][l], element.gradient[b][2][l]};
        const float lv = lambda * volume;
        const float mv = mu * volume;
        const float diagonal = mv * ((ga[0] * gb[0] + ga[1] * gb[1]) + ga[2] * gb[2]);
        for (std::size_t i = 0; i < 3; ++i) {
          for (std::size_t j = 0; j < 3; ++j) block[3 * i + j] += lv * (ga[i] * gb[j]) + mv * (gb[i] * ga[j]);
          block[4 * i] += diagonal;
        }
      }
      if (range.diagonal) {
        const auto node = static_cast<std::size_t>(model.freeNode_[static_cast<std::size_t>(range.row)]);
        const auto mass = static_cast<float>(massScale * model.mass_[node]);
        for (std::size_t i = 0; i < 3; ++i) block[4 * i] += mass;
      }
      for (std::size_t i = 0; i < 9; ++i) values_[range.slot + i * laneCount] = block[i];
    }
  });
}

SolveReport SolidSolver::freeMotion(const SolidModel& model, SolidState& state, const Vec3& gravity,
                                    std::span<const Vec3> external, const Settings& settings, Executor& executor) {
  const double h = settings.step;
  const SolidModel::Material& m = model.material_;
  element_.resize(model.elements_.groups().size());
  model.elements_.evaluate(state.position, state.velocity, h + m.stiffnessDamping, m.lame, settings.rotationSweeps,
                           state.rotation, element_, executor);
  assemble(model, settings, executor);

  b_.assign(model.matrix_.vectorSize(), 0.0F);
  x_.resize(model.matrix_.vectorSize());
  const std::size_t rows = model.freeNode_.size();
  executor.run((rows + rowsPerTask - 1) / rowsPerTask, [&](std::size_t task) {
    const FloatingPointScope scope;
    const std::size_t last = std::min(rows, (task + 1) * rowsPerTask);
    for (std::size_t r = task * rowsPerTask; r < last; ++r) {
      const auto node = static_cast<std::size_t>(model.freeNode_[r]);
      Vec3 force = Vec3::Zero();
      for (std::size_t k = model.incidentStart_[node]; k < model.incidentStart_[node + 1]; ++k) {
        const auto e = static_cast<std::size_t>(model.incident_[k].element);
        const auto a = static_cast<std::size_t>(model.incident_[k].a);
        const auto& lanes = element_[e / laneCount].force[a];
        const std::size_t l = e % laneCount;
        force += Vec3(lanes[0][l], lanes[1][l], lanes[2][l]);
      }
      force += model.mass_[node] * (gravity - m.massDamping * state.velocity[node]);
      if (!external.empty()) force += external[node];
      for (int i = 0; i < 3; ++i) {
        b_[laneOffset(r) + static_cast<std::size_t>(i) * laneCount] = static_cast<float>(h * force[i]);
      }
    }
  });
  cg_.prepare(model.matrix_, values_, model.diagonal_, executor);
  const SolveReport report = cg_.solve(model.matrix_, values_, b_, x_, settings.tolerance, settings.cap, executor);
  freeVelocity_.assign(model.nodes(), Vec3::Zero());
  for (std::size_t r = 0; r < rows; ++r) {
    const auto node = static_cast<std::size_t>(model.freeNode_[r]);
    const std::size_t at = laneOffset(r);
    freeVelocity_[node] = state.velocity[node] + Vec3(x_[at], x_[at + laneCount], x_[at + 2 * laneCount]);
  }
  return report;
}

SolveReport SolidSolver::responses(const SolidModel& model, std::span<const Impulse> impulses, const Settings& settings,
                                   std::vector<std::vector<Vec3>>& response, Executor& executor) {
  const std::size_t size = model.matrix_.vectorSize() * laneCount;
  b_.assign(size, 0.0F);
  x_.resize(size);
  for (std::size_t n = 0; n < impulses.size(); ++n) {
    for (std::size_t k = 0; k < impulses[n].count; ++k) {
      const int r = model.row(static_cast<std::size_t>(impulses[n].node[k]));
      if (r < 0) continue;
      for (int i = 0; i < 3; ++i) {
        b_[static_cast<std::size_t>(r) * laneStride + static_cast<std::size_t>(i) * laneCount + n] +=
            static_cast<float>(impulses[n].weight[k] * impulses[n].impulse[i]);
      }
    }
  }
  const SolveReport report = cg_.solveMany(model.matrix_, values_, b_, x_, settings.tolerance, settings.cap, executor);
  response.resize(impulses.size());
  for (std::size_t n = 0; n < impulses.size(); ++n) {
    response[n].assign(model.nodes(), Vec3::Zero());
    for (std::size_t r = 0; r < model.freeNode_.size(); ++r) {
      const std::size_t at = r * laneStride + n;
      response[n][static_cast<std::size_t>(model.freeNode_[r])] =
          Vec3(x_[at], x_[at + laneCount], x_[at + 2 * laneCount]);
    }
  }
  return report;
}

SolveReport SolidSolver::push(const SolidModel& model, std::span<const Vec3> impulse, const Settings& settings,
                              Executor& executor) {
  b_.assign(model.matrix_.vectorSize(), 0.0F);
  x_.resize(model.matrix_.vectorSize());
  for (std::size_t r = 0; r < model.freeNode_.size(); ++r) {
    const Vec3& p = impulse[static_cast<std::size_t>(model.freeNode_[r])];
    for (int i = 0; i < 3; ++i) {
      b_[laneOffset(r) + static_cast<std::size_t>(i) * laneCount] = static_cast<float>(p[i]);
    }
  }
  const SolveReport report = cg_.solve(model.matrix_, values_, b_, x_, settings.tolerance, settings.cap, executor);
  for (std::size_t r = 0; r < model.freeNode_.size(); ++r) {
    const std::size_t at = laneOffset(r);
    freeVelocity_[static_cast<std::size_t>(model.freeNode_[r])] +=
        Vec3(x_[at], x_[at + laneCount], x_[at + 2 * laneCount]);
  }
  return report;
}

std::vector<std::int32_t> SolidModel::elementsAt(std::size_t node) const {
  std::vector<std::int32_t> out;
  for (std::size_t k = incidentStart_[node]; k < incidentStart_[node + 1]; ++k) out.push_back(incident_[k].element);
  return out;
}

bool SolidSolver::advance(const SolidModel& model, SolidState& state, std::span<const Vec3> correction, double step) {
  bool finite = true;
  for (const int free : model.freeNode_) {
    const auto node = static_cast<std::size_t>(free);
    Vec3 velocity = freeVelocity_[node];
    if (!correction.empty()) velocity += correction[node];
    const Vec3 position = state.position[node] + step * velocity;
    if (!velocity.allFinite() || !position.allFinite()) {
      finite = false;
      state.velocity[node].setZero();
      continue;
    }
    state.velocity[node] = velocity;
    state.position[node] = position;
  }
  return finite;
}

}  // namespace calot
