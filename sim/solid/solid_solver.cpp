// SPDX-License-Identifier: GPL-3.0-or-later
// Implicit Euler of one solid.
#include <algorithm>
#include <cmath>

#include "sim/math/floating_point.h"
#include "sim/solid/solid.h"

namespace calot {

namespace {

constexpr std::size_t nodesPerTask = 128;
constexpr std::size_t blocksPerTask = 1024;
/// Of a cube's corner, and of any other node beyond the mean of its solid (m/s). No hand moves tissue as fast; what
/// does is a corner that only a nearly empty cube holds, thrown about by what holds that cube elsewhere, or contact in
/// crumpled tissue, decided on a compliance that is not that of its shape.
constexpr double fastestNode = 5.0;
constexpr double weightless = 0.1;  ///< of a node's mass at rest: what has less left is held back without a word
constexpr double orphanMass = 1.0;  ///< of a node that only empty cubes hold (kg): it has no neighbours and no load

}  // namespace

/// Block K_ab of one tetrahedron, scaled for the system.
inline void SolidSolver::addBlock(const SolidModel& model, const SolidModel::Contribution& contribution,
                                  std::array<float, 9>& block, float lambda, float mu) const {
  const auto e = static_cast<std::size_t>(contribution.element);
  const std::size_t l = e % laneCount;
  const auto a = static_cast<std::size_t>(contribution.a);
  const auto b = static_cast<std::size_t>(contribution.b);
  const ElementResult& element = element_[e / laneCount];
  const auto volume = static_cast<float>(model.elements().groups()[e / laneCount].volume[l]);
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

/// A block of the matrix of cubes.
inline void SolidSolver::addCubes(const SolidModel& model, const SolidModel::SlotRange& range,
                                  std::array<float, 9>& block, float scale) const {
  std::array<float, 9> sum{};
  std::array<float, 9> turned{};
  static_assert(sizeof(HexahedronBlocks) == 36 * sizeof(std::array<float, 9>));
  const std::array<float, 9>* block0 = hexahedronBlock_.front().data();  // of all cubes, one after the other
  const auto add = [&](std::size_t first, std::size_t last, std::array<float, 9>& to) {
    for (std::size_t c = first; c < last; ++c) {
      const std::array<float, 9>& from = block0[model.cubeBlock_[c]];
      for (std::size_t k = 0; k < 9; ++k) to[k] += from[k];
    }
  };
  add(range.first, range.turned, sum);
  add(range.turned, range.last, turned);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) block[3 * i + j] = scale * (sum[3 * i + j] + turned[3 * j + i]);
  }
}

inline Vec3 SolidSolver::cornerForce(const SolidModel& model, const SolidModel::Contribution& contribution) const {
  const auto e = static_cast<std::size_t>(contribution.element);
  const auto a = static_cast<std::size_t>(contribution.a);
  const std::size_t l = e % laneCount;
  const auto& lanes = model.madeOfCubes() ? hexahedron_[e / laneCount].force[a] : element_[e / laneCount].force[a];
  return {lanes[0][l], lanes[1][l], lanes[2][l]};
}

void SolidSolver::assemble(const SolidModel& model, const Settings& settings, const Surroundings& surroundings,
                           Executor& executor) {
  const double h = settings.step;
  const SolidModel::Material& m = model.material_;
  const auto scale = static_cast<float>(h * h + m.stiffnessDamping * h);
  const double massScale = 1.0 + m.massDamping * h;
  const float lambda = scale * static_cast<float>(m.lame.lambda);
  const float mu = scale * static_cast<float>(m.lame.mu);
  const std::vector<double>& masses = surroundings.fill.empty() ? model.mass_ : mass_;
  values_.assign(model.matrix_.valueCount(), 0.0F);
  const std::size_t tasks = (model.slot_.size() + blocksPerTask - 1) / (blocksPerTask);
  executor.run(tasks, [&](std::size_t task) {
    const FloatingPointScope scope;
    const std::size_t last = std::min(model.slot_.size(), (task + 1) * blocksPerTask);
    for (std::size_t s = task * blocksPerTask; s < last; ++s) {
      const SolidModel::SlotRange& range = model.slot_[s];
      std::array<float, 9> block{};
      if (model.madeOfCubes()) {
        addCubes(model, range, block, scale);
      } else {
        for (std::size_t c = range.first; c < range.last; ++c) {
          addBlock(model, model.contribution_[c], block, lambda, mu);
        }
      }
      if (range.node >= 0) {
        const double own = masses[static_cast<std::size_t>(range.node)];
        const auto mass = static_cast<float>(own > 0.0 ? massScale * own : orphanMass);
        for (std::size_t i = 0; i < 3; ++i) block[4 * i] += mass;
      }
      for (std::size_t k = 0; k < 9; ++k) values_[range.slot + k * laneCount] = block[k];
    }
  });
  addAttachments(model, settings, surroundings.attachments);
  extra_.clear();
  for (const JointAttachment& joint : surroundings.joints) addJoint(model, settings, joint);
}

void SolidSolver::addAttachments(const SolidModel& model, const Settings& settings,
                                 std::span<const Attachment> attachments) {
  for (const Attachment& attachment : attachments) {
    if (addToElement(model, attachment, settings.step)) continue;
    addPair(model, attachment.place, attachment.place, attachment.damper, settings.step);
  }
}

/// The same as addPair() for a spring without a direction of its own in a known element, without a search.
/// @return false: it is none
bool SolidSolver::addToElement(const SolidModel& model, const Attachment& attachment, double step) {
  const SolidPlace& place = attachment.place;
  const double damper = attachment.damper(0, 0);
  if (place.element < 0 || attachment.damper != Mat3(damper * Mat3::Identity())) return false;
  const std::size_t* slot =
      model.elementSlot_.data() + static_cast<std::size_t>(place.element) * (place.count * place.count);
  for (std::size_t a = 0; a < place.count; ++a) {
    for (std::size_t b = 0; b < place.count; ++b, ++slot) {
      if (*slot == SolidModel::noSlot) continue;
      const auto own = static_cast<float>((step * (place.weight[a] * place.weight[b])) * damper);
      for (std::size_t i = 0; i < 3; ++i) values_[*slot + 4 * i * laneCount] += own;
    }
  }
  return true;
}

void SolidSolver::addJoint(const SolidModel& model, const Settings& settings, const JointAttachment& joint) {
  for (std::size_t i = 0; i < joint.place.size(); ++i) {
    for (std::size_t j = 0; j < joint.place.size(); ++j) {
      const Mat3 damper = joint.block(i, j);
      if (!damper.isZero(0.0)) addPair(model, joint.place[i], joint.place[j], damper, settings.step);
    }
  }
}

/// Adds step * damper between two places to the matrix, rows at p.
void SolidSolver::addPair(const SolidModel& model, const SolidPlace& p, const SolidPlace& q, const Mat3& damper,
                          double step) {
  const bool isotropic = damper == Mat3(damper(0, 0) * Mat3::Identity());
  for (std::size_t a = 0; a < p.count; ++a) {
    const int row = model.row(static_cast<std::size_t>(p.node[a]));
    if (row < 0) continue;
    for (std::size_t b = 0; b < q.count; ++b) {
      const int column = model.row(static_cast<std::size_t>(q.node[b]));
      if (column < 0) continue;
      const bool mirrored = column > row;  // its transpose comes as well, for the damper is symmetric
      const std::size_t at = mirrored ? model.slotOf(column, row) : model.slotOf(row, column);
      if (mirrored && at != SolidModel::noSlot) continue;
      const double share = step * (p.weight[a] * q.weight[b]);
      if (isotropic && at != SolidModel::noSlot) {
        const auto own = static_cast<float>(share * damper(0, 0));
        for (std::size_t i = 0; i < 3; ++i) values_[at + 4 * i * laneCount] += own;
        continue;
      }
      std::array<float, 9> block{};
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
          block[3 * i + j] = static_cast<float>(share * damper(static_cast<int>(i), static_cast<int>(j)));
        }
      }
      if (at == SolidModel::noSlot) {
        extra_.push_back({static_cast<std::size_t>(row), static_cast<std::size_t>(column), block});
        continue;
      }
      for (std::size_t k = 0; k < 9; ++k) values_[at + k * laneCount] += block[k];
    }
  }
}

SolveReport SolidSolver::freeMotion(const SolidModel& model, SolidState& state, const Vec3& gravity,
                                    std::span<const Vec3> external, const Settings& settings, Executor& executor,
                                    const Surroundings& surroundings) {
  const double h = settings.step;
  const SolidModel::Material& m = model.material_;
  if (model.madeOfCubes()) {
    hexahedron_.resize(model.groups());
    hexahedronBlock_.resize(model.groups() * laneCount);
    model.hexahedra().evaluate(state.position, state.velocity, h + m.stiffnessDamping, settings.rotationSweeps,
                               surroundings.fill, state.rotation, hexahedron_, hexahedronBlock_, executor);
    if (!surroundings.fill.empty()) model.massOf(surroundings.fill, mass_);
  } else {
    element_.resize(model.groups());
    model.elements().evaluate(state.position, state.velocity, h + m.stiffnessDamping, m.lame, settings.rotationSweeps,
                              state.rotation, element_, executor);
  }
  assemble(model, settings, surroundings, executor);

  // In double until all that acts on a node is known.
  load_.assign(external.begin(), external.end());
  if (!surroundings.attachments.empty() || !surroundings.joints.empty()) load_.resize(model.nodes(), Vec3::Zero());
  const auto addLoad = [&](const SolidPlace& place, const Vec3& force) {
    for (std::size_t k = 0; k < place.count; ++k) {
      load_[static_cast<std::size_t>(place.node[k])] += place.weight[k] * force;
    }
  };
  for (const Attachment& attachment : surroundings.attachments) {
    addLoad(attachment.place, attachment.force - attachment.damper * attachment.place.of(state.velocity));
  }
  for (const JointAttachment& joint : surroundings.joints) {
    for (std::size_t i = 0; i < joint.place.size(); ++i) {
      Vec3 force = joint.force[i];
      for (std::size_t j = 0; j < joint.place.size(); ++j) {
        force -= joint.block(i, j) * joint.place[j].of(state.velocity);
      }
      addLoad(joint.place[i], force);
    }
  }
  const std::vector<double>& masses = surroundings.fill.empty() ? model.mass_ : mass_;
  b_.assign(model.matrix_.vectorSize(), 0.0F);
  x_.resize(model.matrix_.vectorSize());
  const std::size_t free = model.freeNode_.size();
  executor.run((free + nodesPerTask - 1) / nodesPerTask, [&](std::size_t task) {
    const FloatingPointScope scope;
    const std::size_t last = std::min(free, (task + 1) * nodesPerTask);
    for (std::size_t f = task * nodesPerTask; f < last; ++f) {
      const auto node = static_cast<std::size_t>(model.freeNode_[f]);
      if (!(masses[node] > 0.0)) continue;
      Vec3 force = Vec3::Zero();
      for (std::size_t k = model.incidentStart_[node]; k < model.incidentStart_[node + 1]; ++k) {
        force += cornerForce(model, model.incident_[k]);
      }
      force += masses[node] * (gravity - m.massDamping * state.velocity[node]);
      if (!load_.empty()) force += load_[node];
      for (int i = 0; i < 3; ++i) {
        b_[model.offsetOf(node) + static_cast<std::size_t>(i) * laneCount] = static_cast<float>(h * force[i]);
      }
    }
  });
  cg_.prepare(model.matrix_, values_, extra_);
  const SolveReport report = cg_.solve(model.matrix_, values_, b_, x_, settings.tolerance, settings.cap);
  freeVelocity_.assign(model.nodes(), Vec3::Zero());
  for (const int f : model.freeNode_) {
    const auto node = static_cast<std::size_t>(f);
    const std::size_t at = model.offsetOf(node);
    freeVelocity_[node] = state.velocity[node] + Vec3(x_[at], x_[at + laneCount], x_[at + 2 * laneCount]);
  }
  return report;
}

SolveReport SolidSolver::responses(const SolidModel& model, std::span<const Impulse> impulses, const Settings& settings,
                                   std::vector<std::vector<Vec3>>& response) {
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
  const SolveReport report = cg_.solveMany(model.matrix_, values_, b_, x_, settings.tolerance, settings.cap);
  response.resize(impulses.size());
  for (std::size_t n = 0; n < impulses.size(); ++n) {
    response[n].assign(model.nodes(), Vec3::Zero());
    for (const int f : model.freeNode_) {
      const auto node = static_cast<std::size_t>(f);
      const std::size_t at = static_cast<std::size_t>(model.row_[node]) * laneStride + n;
      response[n][node] = Vec3(x_[at], x_[at + laneCount], x_[at + 2 * laneCount]);
    }
  }
  return report;
}

SolveReport SolidSolver::push(const SolidModel& model, std::span<const Vec3> impulse, const Settings& settings) {
  b_.assign(model.matrix_.vectorSize(), 0.0F);
  x_.resize(model.matrix_.vectorSize());
  for (const int f : model.freeNode_) {
    const auto node = static_cast<std::size_t>(f);
    for (int i = 0; i < 3; ++i) {
      b_[model.offsetOf(node) + static_cast<std::size_t>(i) * laneCount] = static_cast<float>(impulse[node][i]);
    }
  }
  const SolveReport report = cg_.solve(model.matrix_, values_, b_, x_, settings.tolerance, settings.cap);
  for (const int f : model.freeNode_) {
    const auto node = static_cast<std::size_t>(f);
    const std::size_t at = model.offsetOf(node);
    freeVelocity_[node] += Vec3(x_[at], x_[at + laneCount], x_[at + 2 * laneCount]);
  }
  return report;
}

bool SolidSolver::advance(const SolidModel& model, SolidState& state, std::span<const Vec3> correction, double step) {
  bool finite = true;
  heldBack_ = 0.0;
  const auto asked = [&](int free) {
    const auto node = static_cast<std::size_t>(free);
    return correction.empty() ? freeVelocity_[node] : Vec3(freeVelocity_[node] + correction[node]);
  };
  Vec3 mean = Vec3::Zero();
  for (const int free : model.freeNode_) {
    const Vec3 velocity = asked(free);
    if (!model.madeOfCubes() && velocity.allFinite()) mean += velocity / static_cast<double>(model.freeNode_.size());
  }
  for (const int free : model.freeNode_) {
    const auto node = static_cast<std::size_t>(free);
    Vec3 velocity = asked(free);
    const double speed = (velocity - mean).norm();
    if (speed > fastestNode) {
      const bool weighs = mass_.empty() || mass_[node] > weightless * model.mass_[node];
      if (weighs) heldBack_ = std::max(heldBack_, speed);
      velocity = mean + fastestNode / speed * (velocity - mean);
    }
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
