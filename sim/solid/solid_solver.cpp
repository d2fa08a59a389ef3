// SPDX-License-Identifier: GPL-3.0-or-later
// Implicit Euler of one solid.
#include <algorithm>
#include <cmath>

#include "sim/math/floating_point.h"
#include "sim/solid/solid.h"

namespace calot {

namespace {

constexpr std::size_t nodesPerTask = 128;
/// Greatest speed of a cube's corner, and of any other node relative to the mean of its solid (m/s). No hand moves
/// tissue as fast. It occurs at a corner that belongs only to a nearly empty cube, or in contact of crumpled tissue,
/// whose compliance differs much from that of the reference configuration.
constexpr double maxNodeSpeed = 5.0;
/// With a lattice, the remaining error has no smooth part, which displaces most: ten times the tolerance gives the same
/// error as sweeps alone (docs/explanation/simulation.md).
constexpr double smoothErrorFactor = 10.0;
constexpr double weightless = 0.1;  ///< share of a node's reference mass below which clamping is not reported

/// Coefficients of mass and stiffness in the matrix of a step.
StiffnessAssembly::Scale scaleOf(const SolidModel& model, double step) {
  const SolidModel::Material& m = model.material();
  return {1.0 + m.massDamping * step, step * step + m.stiffnessDamping * step};
}

}  // namespace

namespace {

Vec3 weighted(const auto& place, std::span<const Vec3> values) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < place.count; ++k) {
    sum += place.weight[k] * values[static_cast<std::size_t>(place.node[k])];
  }
  return sum;
}

}  // namespace

Vec3 MaterialPoint::of(std::span<const Vec3> values) const { return weighted(*this, values); }

Vec3 SolidSolver::Impulse::of(std::span<const Vec3> values) const { return weighted(*this, values); }

Mat3 JointAttachment::block(std::size_t i, std::size_t j) const {
  Mat3 m;
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 0; b < 3; ++b) {
      m(static_cast<int>(a), static_cast<int>(b)) = damper[(3 * i + a) * 3 * point.size() + 3 * j + b];
    }
  }
  return m;
}

inline Vec3 SolidSolver::cornerForce(const SolidModel& model, const SolidSystem::Contribution& contribution) const {
  const auto e = static_cast<std::size_t>(contribution.element);
  const auto a = static_cast<std::size_t>(contribution.a);
  const std::size_t l = e % laneCount;
  const auto& lanes = model.madeOfCubes() ? hexahedron_[e / laneCount].force[a] : element_[e / laneCount].force[a];
  return {lanes[0][l], lanes[1][l], lanes[2][l]};
}

/// Chooses the whole system or that of the remaining cubes.
void SolidSolver::chooseSystem(const SolidModel& model, std::span<const double> fill) {
  if (std::find(fill.begin(), fill.end(), 0.0) == fill.end()) {
    if (system_ != &model.system()) ++systemVersion_;
    system_ = &model.system();
    return;
  }
  const auto isThere = [](double share) { return static_cast<std::uint8_t>(share > 0.0 ? 1 : 0); };
  const auto alike = [&](double share, std::uint8_t there) { return isThere(share) == there; };
  if (system_ == &part_ && std::equal(fill.begin(), fill.end(), present_.begin(), present_.end(), alike)) return;
  present_.resize(fill.size());
  std::transform(fill.begin(), fill.end(), present_.begin(), isThere);
  part_ = SolidSystem(model.system(), present_);
  system_ = &part_;
  ++systemVersion_;
}

void SolidSolver::linearise(const SolidModel& model, const SolidState& state, const Settings& settings,
                            std::span<const double> fill, Executor& executor) {
  const SolidModel::Material& m = model.material();
  const double ahead = settings.step + m.stiffnessDamping;
  chooseSystem(model, fill);
  rotation_ = state.rotation;
  if (model.madeOfCubes()) {
    hexahedron_.resize(model.groups());
    model.hexahedra().evaluate(state.position, state.velocity, ahead, settings.rotationSweeps, fill, rotation_,
                               hexahedron_, executor);
    if (!fill.empty()) model.massOf(fill, mass_);
  } else {
    element_.resize(model.groups());
    model.elements().evaluate(state.position, state.velocity, ahead, m.lame, settings.rotationSweeps, rotation_,
                              element_, executor);
  }
  precompute(model, settings, executor);
  if (settings.lattice && CoarseLattice::isWorthwhile(model)) {
    lattice_->rotate(rotation_);
  } else {
    lattice_.reset();  // from an earlier step
    latticeModel_ = nullptr;
  }
  stiffness_.assemble(model, *system_, rotation_, fill, fill.empty() ? model.mass() : mass_,
                      scaleOf(model, settings.step), executor, values_);
}

void SolidSolver::precompute(const SolidModel& model, const Settings& settings, Executor& executor) {
  if (!settings.lattice || !CoarseLattice::isWorthwhile(model)) return;
  const StiffnessAssembly::Scale scale = scaleOf(model, settings.step);
  if (latticeModel_ == &model && latticeScale_.mass == scale.mass && latticeScale_.stiffness == scale.stiffness) return;
  std::vector<float> rest;
  stiffness_.assemble(model, model.system(), restState(model).rotation, {}, model.mass(), scale, executor, rest);
  lattice_.emplace(model, rest);
  latticeModel_ = &model;
  latticeScale_ = scale;
}

SolveReport SolidSolver::solveJoined(std::span<SolidSolver* const> solids, std::span<const Coupled> couplings,
                                     const Settings& settings) {
  std::vector<ConjugateGradient::Part> parts;
  std::vector<ConjugateGradient::Coupled> coupled;
  double mass = 0.0;
  bool smooth = true;
  for (SolidSolver* solid : solids) {
    CoarseLattice* lattice = solid->lattice_ ? &*solid->lattice_ : nullptr;
    parts.push_back({solid->cg_, solid->system_->matrix(), solid->values_, lattice, solid->b_, solid->x_});
    mass += solid->wholeMass_;
    smooth = smooth && lattice != nullptr;
  }
  for (const Coupled& c : couplings) coupled.push_back({c.first, c.second, c.by});
  SolveGoal goal{settings.tolerance, settings.cap, settings.speedTolerance * std::sqrt(mass), settings.goesOn};
  if (smooth) {
    goal.tolerance *= smoothErrorFactor;
    goal.absolute *= smoothErrorFactor;
  }
  const SolveReport report = ConjugateGradient::solveJoined(parts, coupled, goal);
  for (SolidSolver* solid : solids) solid->addSolution();
  return report;
}

/// freeVelocity_ += x_
void SolidSolver::addSolution() {
  for (const int f : system_->nodes()) {
    const auto node = static_cast<std::size_t>(f);
    const std::size_t at = system_->offsetOf(node);
    freeVelocity_[node] += Vec3(x_[at], x_[at + laneCount], x_[at + 2 * laneCount]);
  }
}

void SolidSolver::addAttachments(const Settings& settings, std::span<const Attachment> attachments) {
  for (const Attachment& attachment : attachments) {
    if (addToElement(attachment, settings.step)) continue;
    addPair(attachment.point, attachment.point, attachment.damper, settings.step);
  }
}

/// Same as addPair() for an isotropic spring in a known element, without a search.
/// @return false: not such a spring
bool SolidSolver::addToElement(const Attachment& attachment, double step) {
  const MaterialPoint& point = attachment.point;
  const double damper = attachment.damper(0, 0);
  if (system_ == &part_ && point.element >= 0 && present_[static_cast<std::size_t>(point.element)] == 0) return false;
  if (point.element < 0 || attachment.damper != Mat3(damper * Mat3::Identity())) return false;
  const std::uint32_t* slot = system_->blockOffsets(static_cast<std::size_t>(point.element));
  for (std::size_t a = 0; a < point.count; ++a) {
    for (std::size_t b = 0; b < point.count; ++b, ++slot) {
      if (*slot == SolidSystem::noSlot) continue;
      const auto own = static_cast<float>((step * (point.weight[a] * point.weight[b])) * damper);
      for (std::size_t i = 0; i < 3; ++i) values_[*slot + 4 * i * laneCount] += own;
    }
  }
  return true;
}

void SolidSolver::addJoint(const Settings& settings, const JointAttachment& joint) {
  for (std::size_t i = 0; i < joint.point.size(); ++i) {
    for (std::size_t j = 0; j < joint.point.size(); ++j) {
      const Mat3 damper = joint.block(i, j);
      if (!damper.isZero(0.0)) addPair(joint.point[i], joint.point[j], damper, settings.step);
    }
  }
}

/// Adds step * damper between two points to the matrix, rows at p.
void SolidSolver::addPair(const MaterialPoint& p, const MaterialPoint& q, const Mat3& damper, double step) {
  const bool isotropic = damper == Mat3(damper(0, 0) * Mat3::Identity());
  for (std::size_t a = 0; a < p.count; ++a) {
    const int row = system_->row(static_cast<std::size_t>(p.node[a]));
    if (row < 0) continue;
    for (std::size_t b = 0; b < q.count; ++b) {
      const int column = system_->row(static_cast<std::size_t>(q.node[b]));
      if (column < 0) continue;
      const bool mirrored = column > row;  // its transpose is added as well, since the damper is symmetric
      const std::uint32_t at = mirrored ? system_->blockOffset(column, row) : system_->blockOffset(row, column);
      if (mirrored && at != SolidSystem::noSlot) continue;
      const double share = step * (p.weight[a] * q.weight[b]);
      if (isotropic && at != SolidSystem::noSlot) {
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
      if (at == SolidSystem::noSlot) {
        extra_.push_back({static_cast<std::size_t>(row), static_cast<std::size_t>(column), block});
        continue;
      }
      for (std::size_t k = 0; k < 9; ++k) values_[at + k * laneCount] += block[k];
    }
  }
}

SolveReport SolidSolver::solveUnconstrained(const SolidModel& model, SolidState& state, const Vec3& gravity,
                                            std::span<const Vec3> external, const Settings& settings,
                                            Executor& executor, const Surroundings& surroundings) {
  assembleUnconstrained(model, state, gravity, external, settings, executor, surroundings);
  SolidSolver* self = this;
  return solveJoined({&self, 1}, {}, settings);
}

void SolidSolver::assembleUnconstrained(const SolidModel& model, SolidState& state, const Vec3& gravity,
                                        std::span<const Vec3> external, const Settings& settings, Executor& executor,
                                        const Surroundings& surroundings) {
  linearise(model, state, settings, surroundings.fill, executor);
  load(model, state, gravity, external, settings, executor, surroundings);
}

void SolidSolver::load(const SolidModel& model, SolidState& state, const Vec3& gravity, std::span<const Vec3> external,
                       const Settings& settings, Executor& executor, const Surroundings& surroundings) {
  const double h = settings.step;
  state.rotation.swap(rotation_);
  addAttachments(settings, surroundings.attachments);
  extra_.clear();
  for (const JointAttachment& joint : surroundings.joints) addJoint(settings, joint);

  // Accumulate loads in double.
  load_.assign(external.begin(), external.end());
  if (!surroundings.attachments.empty() || !surroundings.joints.empty()) load_.resize(model.nodes(), Vec3::Zero());
  const auto addLoad = [&](const MaterialPoint& point, const Vec3& force) {
    for (std::size_t k = 0; k < point.count; ++k) {
      load_[static_cast<std::size_t>(point.node[k])] += point.weight[k] * force;
    }
  };
  for (const Attachment& attachment : surroundings.attachments) {
    addLoad(attachment.point, attachment.force - attachment.damper * attachment.point.of(state.velocity));
  }
  for (const JointAttachment& joint : surroundings.joints) {
    for (std::size_t i = 0; i < joint.point.size(); ++i) {
      Vec3 force = joint.force[i];
      for (std::size_t j = 0; j < joint.point.size(); ++j) {
        force -= joint.block(i, j) * joint.point[j].of(state.velocity);
      }
      addLoad(joint.point[i], force);
    }
  }
  const std::vector<double>& masses = surroundings.fill.empty() ? model.mass() : mass_;
  b_.assign(system_->matrix().vectorSize(), 0.0F);
  x_.resize(system_->matrix().vectorSize());
  const std::size_t free = system_->nodes().size();
  executor.run((free + nodesPerTask - 1) / nodesPerTask, [&](std::size_t task) {
    const FloatingPointScope scope;
    const std::size_t last = std::min(free, (task + 1) * nodesPerTask);
    for (std::size_t f = task * nodesPerTask; f < last; ++f) {
      const auto node = static_cast<std::size_t>(system_->nodes()[f]);
      Vec3 force = Vec3::Zero();
      for (const SolidSystem::Contribution& corner : system_->incident(node)) force += cornerForce(model, corner);
      force += masses[node] * (gravity - model.material().massDamping * state.velocity[node]);
      if (!load_.empty()) force += load_[node];
      for (int i = 0; i < 3; ++i) {
        b_[system_->offsetOf(node) + static_cast<std::size_t>(i) * laneCount] = static_cast<float>(h * force[i]);
      }
    }
  });
  wholeMass_ = model.wholeMass();
  cg_.precompute(system_->matrix(), values_, extra_);
  freeVelocity_.assign(model.nodes(), Vec3::Zero());
  for (const int f : model.freeNodes()) {
    freeVelocity_[static_cast<std::size_t>(f)] = state.velocity[static_cast<std::size_t>(f)];
  }
}

SolveReport SolidSolver::responses(const SolidModel& model, std::span<const Impulse> impulses, const Settings& settings,
                                   std::vector<std::vector<Vec3>>& response) {
  const std::size_t size = system_->matrix().vectorSize() * laneCount;
  b_.assign(size, 0.0F);
  x_.resize(size);
  for (std::size_t n = 0; n < impulses.size(); ++n) {
    for (std::size_t k = 0; k < impulses[n].count; ++k) {
      const int r = system_->row(static_cast<std::size_t>(impulses[n].node[k]));
      if (r < 0) continue;
      for (int i = 0; i < 3; ++i) {
        b_[static_cast<std::size_t>(r) * laneStride + static_cast<std::size_t>(i) * laneCount + n] +=
            static_cast<float>(impulses[n].weight[k] * impulses[n].impulse[i]);
      }
    }
  }
  const SolveReport report = cg_.solveMany(system_->matrix(), values_, b_, x_, settings.tolerance, settings.cap);
  response.resize(impulses.size());
  for (std::size_t n = 0; n < impulses.size(); ++n) {
    response[n].assign(model.nodes(), Vec3::Zero());
    for (const int f : system_->nodes()) {
      const auto node = static_cast<std::size_t>(f);
      const std::size_t at = static_cast<std::size_t>(system_->row(node)) * laneStride + n;
      response[n][node] = Vec3(x_[at], x_[at + laneCount], x_[at + 2 * laneCount]);
    }
  }
  return report;
}

SolveReport SolidSolver::applyImpulses(std::span<const Vec3> impulse, const Settings& settings) {
  takeImpulses(impulse);
  SolidSolver* self = this;
  return solveJoined({&self, 1}, {}, settings);
}

void SolidSolver::takeImpulses(std::span<const Vec3> impulse) {
  b_.assign(system_->matrix().vectorSize(), 0.0F);
  x_.resize(system_->matrix().vectorSize());
  if (impulse.empty()) return;
  for (const int f : system_->nodes()) {
    const auto node = static_cast<std::size_t>(f);
    for (int i = 0; i < 3; ++i) {
      b_[system_->offsetOf(node) + static_cast<std::size_t>(i) * laneCount] = static_cast<float>(impulse[node][i]);
    }
  }
}

bool SolidSolver::advance(const SolidModel& model, SolidState& state, std::span<const Vec3> correction, double step) {
  bool finite = true;
  heldBack_ = 0.0;
  const auto asked = [&](int free) {
    const auto node = static_cast<std::size_t>(free);
    return correction.empty() ? freeVelocity_[node] : Vec3(freeVelocity_[node] + correction[node]);
  };
  Vec3 mean = Vec3::Zero();
  for (const int free : model.freeNodes()) {
    const Vec3 velocity = asked(free);
    if (!model.madeOfCubes() && velocity.allFinite()) mean += velocity / static_cast<double>(model.freeNodes().size());
  }
  for (const int free : model.freeNodes()) {
    const auto node = static_cast<std::size_t>(free);
    Vec3 velocity = asked(free);
    const double speed = (velocity - mean).norm();
    if (speed > maxNodeSpeed) {
      const bool weighs = mass_.empty() || mass_[node] > weightless * model.mass()[node];
      if (weighs) heldBack_ = std::max(heldBack_, speed);
      velocity = mean + maxNodeSpeed / speed * (velocity - mean);
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
