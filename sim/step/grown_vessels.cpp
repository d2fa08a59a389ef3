// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/step/coupling.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <utility>

#include "sim/math/symmetric_blocks.h"
#include "sim/solid/conjugate_gradient.h"

namespace calot {

namespace {

/// Adds `block` to a row-major matrix of 3 x 3 blocks, n of them in a row.
void addTo(std::vector<double>& matrix, std::size_t n, std::size_t i, std::size_t j, const Mat3& block) {
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 0; b < 3; ++b) {
      matrix[(3 * i + a) * 3 * n + 3 * j + b] += block(static_cast<int>(a), static_cast<int>(b));
    }
  }
}

Mat3 blockOf(std::span<const double> matrix, std::size_t n, std::size_t i, std::size_t j) {
  Mat3 block;
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 0; b < 3; ++b) {
      block(static_cast<int>(a), static_cast<int>(b)) = matrix[(3 * i + a) * 3 * n + 3 * j + b];
    }
  }
  return block;
}

}  // namespace

GrownVessels::GrownVessels(const Model& model, std::size_t organ, std::vector<std::size_t> ties, double step,
                           OrganBody& organBody, std::vector<VesselBody*> vessels)
    : Coupling(organ, organ),
      model_(model),
      tie_(std::move(ties)),
      step_(step),
      organBody_(organBody),
      vessel_(std::move(vessels)) {
  for (std::size_t i = 0; i < tie_.size(); ++i) {
    const MaterialPoint& place = tie(i).place[0];
    assert(tie(i).body[0] == organ && tie(i).place[1].count == 1);
    organNode_.insert(organNode_.end(), place.node.begin(),
                      place.node.begin() + static_cast<std::ptrdiff_t>(place.count));
    joint_.point.push_back(place);
  }
  std::sort(organNode_.begin(), organNode_.end());
  organNode_.erase(std::unique(organNode_.begin(), organNode_.end()), organNode_.end());
  joint_.force.resize(tie_.size());
  ahead_.resize(tie_.size());
  vesselSeen_.resize(tie_.size());
  force_.resize(tie_.size());
  change_.resize(tie_.size());
  more_.resize(tie_.size());
}

bool GrownVessels::joins(std::size_t body) const {
  if (body == organ()) return true;
  return std::any_of(tie_.begin(), tie_.end(), [&](std::size_t t) { return model_.ties()[t].body[1] == body; });
}

/// 1 / d + h C of the vessels.
void GrownVessels::rigidity(std::vector<double>& out) const {
  const std::size_t n = tie_.size();
  out.assign(9 * n * n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    addTo(out, n, i, i, (1.0 / (step_ * tie(i).stiffness + tie(i).damping)) * Mat3::Identity());
    for (std::size_t j = 0; j < n; ++j) {
      if (vesselOf(i) == vesselOf(j)) addTo(out, n, i, j, step_ * vessel(i).block(nodeOf(i), nodeOf(j)));
    }
  }
}

/// Row i of D times velocities.
Vec3 GrownVessels::applied(std::size_t i, std::span<const Vec3> velocity) const {
  Vec3 sum = Vec3::Zero();
  for (std::size_t j = 0; j < tie_.size(); ++j) {
    if (vesselOf(i) == vesselOf(j)) sum += blockOf(joint_.damper, tie_.size(), i, j) * velocity[j];
  }
  return sum;
}

/// Gathers the vessels' contact-free velocities, and pulls them as if the organ went on as it did.
bool GrownVessels::takeState(const State& state) {
  const std::size_t n = tie_.size();
  for (std::size_t i = 0; i < n; ++i) vessel(i).precomputeCompliance(std::array{nodeOf(i)});
  rigidity(joint_.damper);
  // A sum of 1 / d and what is positive semidefinite.
  if (!invertPositive(joint_.damper, 3 * n)) joint_.damper.assign(9 * n * n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    Vec3 gap =
        tie(i).place[0].of(organBody_.position(state)) - vessel(i).position(state)[static_cast<std::size_t>(nodeOf(i))];
    if (!tie(i).offset.isZero(0.0)) {
      gap += rotationOf(state.organ[organ()].rotation, tie(i).place[0].element) * tie(i).offset;
    }
    ahead_[i] = (tie(i).stiffness / (step_ * tie(i).stiffness + tie(i).damping)) * gap;
    vesselSeen_[i] = velocityOf(i);
    change_[i] = vesselSeen_[i] - ahead_[i];
    force_[i].setZero();
  }
  for (std::size_t i = 0; i < n; ++i) joint_.force[i] = applied(i, change_);
  pull(organBody_.velocity(state));
  return true;
}

void GrownVessels::load(std::size_t body, std::vector<Attachment>& /*attachments*/,
                        std::vector<JointAttachment>& joints) const {
  if (body == organ()) joints.push_back(joint_);
}

/// Adds the impulses that the vessels have received since to the force on the organ.
void GrownVessels::gatherImpulses() {
  for (std::size_t i = 0; i < tie_.size(); ++i) {
    const Vec3& now = velocityOf(i);
    change_[i] = now - vesselSeen_[i];
    vesselSeen_[i] = now;
  }
  for (std::size_t i = 0; i < tie_.size(); ++i) {
    more_[i] = applied(i, change_);
    joint_.force[i] += more_[i];
  }
}

/// Pulls the vessels, with these velocities of the organ's nodes.
void GrownVessels::pull(std::span<const Vec3> organVelocity) {
  gatherImpulses();
  // force = D (V - ...) for the organ's present motion; the vessels get the change.
  for (std::size_t i = 0; i < tie_.size(); ++i) change_[i] = tie(i).place[0].of(organVelocity);
  for (std::size_t i = 0; i < tie_.size(); ++i) {
    const Vec3 force = applied(i, change_) - joint_.force[i];
    more_[i] = force - force_[i];
    force_[i] = force;
  }
  std::size_t i = 0;
  while (i < tie_.size()) {
    const std::size_t first = i;
    impulse_.assign(vessel(i).nodes(), Vec3::Zero());
    for (; i < tie_.size() && vesselOf(i) == vesselOf(first); ++i) {
      impulse_[static_cast<std::size_t>(nodeOf(i))] += step_ * more_[i];
    }
    vessel(first).applyImpulses(impulse_);
    for (std::size_t k = first; k < i; ++k) vesselSeen_[k] = velocityOf(k);
  }
}

void GrownVessels::react(ConjugateGradient& gradient, std::size_t vessel, std::span<const Vec3> response,
                         std::vector<Vec3>& push) {
  const SolidSystem& organ = organBody_.solver().system();
  push.assign(tie_.size(), Vec3::Zero());
  for (std::size_t i = 0; i < tie_.size(); ++i) {
    more_[i].setZero();
    if (vesselOf(i) != vessel) continue;
    const MaterialPoint& place = tie(i).place[0];
    for (std::size_t k = 0; k < place.count; ++k) {
      const int row = organ.row(static_cast<std::size_t>(place.node[k]));
      if (row < 0) continue;
      const FourFloats d = gradient.directionAt(static_cast<std::size_t>(row));
      more_[i] +=
          place.weight[k] * Vec3(static_cast<double>(d[0]), static_cast<double>(d[1]), static_cast<double>(d[2]));
    }
  }
  for (std::size_t i = 0; i < tie_.size(); ++i) {
    if (vesselOf(i) != vessel) continue;
    const Vec3 back = step_ * applied(i, response);
    push[i] = step_ * applied(i, more_) - back;
    const MaterialPoint& place = tie(i).place[0];
    for (std::size_t k = 0; k < place.count; ++k) {
      const int row = organ.row(static_cast<std::size_t>(place.node[k]));
      if (row < 0) continue;
      const Vec3 share = -place.weight[k] * back;
      gradient.addToProduct(
          static_cast<std::size_t>(row),
          FourFloats{static_cast<float>(share[0]), static_cast<float>(share[1]), static_cast<float>(share[2]), 0.0F});
    }
  }
}

/// Holds the impulses on the organ's nodes, for a pull with the velocities that they have.
void GrownVessels::passOn(std::size_t body, std::vector<Vec3>& impulse) {
  if (body != organ()) return;
  gatherImpulses();
  for (std::size_t i = 0; i < tie_.size(); ++i) {
    if (more_[i].isZero(0.0)) continue;
    const MaterialPoint& place = tie(i).place[0];
    if (impulse.empty()) impulse.assign(organBody_.nodes(), Vec3::Zero());
    for (std::size_t k = 0; k < place.count; ++k) {
      impulse[static_cast<std::size_t>(place.node[k])] += (step_ * place.weight[k]) * more_[i];
    }
  }
  pull(organBody_.freeVelocity());
}

void GrownVessels::stiffen(const State& state) {
  const std::size_t n = tie_.size();
  organBody_.precomputeCompliance(organNode_);
  rotation_.clear();
  for (const int node : organNode_) rotation_.push_back(organBody_.rotation(state, node));
  const std::size_t nodes = organNode_.size();
  std::vector<Mat3> between(nodes * nodes);
  for (std::size_t a = 0; a < nodes; ++a) {
    for (std::size_t b = 0; b < nodes; ++b) {
      between[a * nodes + b] = rotation_[a] * organBody_.block(organNode_[a], organNode_[b]) * rotation_[b].transpose();
    }
  }
  const auto number = [&](int node) {
    return static_cast<std::size_t>(std::lower_bound(organNode_.begin(), organNode_.end(), node) - organNode_.begin());
  };
  rigidity(tight_);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      const MaterialPoint& p = tie(i).place[0];
      const MaterialPoint& q = tie(j).place[0];
      Mat3 sum = Mat3::Zero();
      for (std::size_t a = 0; a < p.count; ++a) {
        for (std::size_t b = 0; b < q.count; ++b) {
          // C_ab and C_ba come from different solves, each to its tolerance: their mean.
          const std::size_t x = number(p.node[a]);
          const std::size_t y = number(q.node[b]);
          sum += (0.5 * p.weight[a] * q.weight[b]) * (between[x * nodes + y] + between[y * nodes + x].transpose());
        }
      }
      addTo(tight_, n, i, j, step_ * sum);
    }
  }
  if (!invertPositive(tight_, 3 * n)) tight_.assign(9 * n * n, 0.0);
}

void GrownVessels::responses(const Body& body, std::size_t which, const SolidSolver::Impulse& place,
                             std::span<const Mat3> rotation, std::vector<Mat3>& out) const {
  out.assign(tie_.size(), Mat3::Zero());
  if (which != organ()) {
    for (std::size_t i = 0; i < tie_.size(); ++i) {
      if (vesselOf(i) != which) continue;
      for (std::size_t k = 0; k < place.count; ++k) {
        out[i] -= body.block(nodeOf(i), place.node[k]) * rotation[k].transpose();
      }
    }
    return;
  }
  std::vector<Mat3> atNode(organNode_.size(), Mat3::Zero());
  for (std::size_t a = 0; a < organNode_.size(); ++a) {
    for (std::size_t k = 0; k < place.count; ++k) {
      atNode[a] += body.block(organNode_[a], place.node[k]) * rotation[k].transpose();
    }
    atNode[a] = rotation_[a] * atNode[a];
  }
  for (std::size_t i = 0; i < tie_.size(); ++i) {
    const MaterialPoint& at = tie(i).place[0];
    for (std::size_t k = 0; k < at.count; ++k) {
      const auto a = std::lower_bound(organNode_.begin(), organNode_.end(), at.node[k]) - organNode_.begin();
      out[i] += at.weight[k] * atNode[static_cast<std::size_t>(a)];
    }
  }
}

void GrownVessels::tieImpulses(std::span<const Mat3> responses, std::vector<Mat3>& out) const {
  out.assign(tie_.size(), Mat3::Zero());
  for (std::size_t i = 0; i < tie_.size(); ++i) {
    for (std::size_t j = 0; j < tie_.size(); ++j) out[i] += blockOf(tight_, tie_.size(), i, j) * responses[j];
  }
}

Mat3 GrownVessels::schurComplement(std::span<const Mat3> responses, std::span<const Mat3> tieImpulses) const {
  Mat3 sum = Mat3::Zero();
  for (std::size_t i = 0; i < tie_.size(); ++i) sum += responses[i].transpose() * tieImpulses[i];
  return step_ * sum;
}

}  // namespace calot
