// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/step/vessel_reaction.h"

#include <algorithm>
#include <array>
#include <tuple>

#include "sim/solid/conjugate_gradient.h"

namespace calot {

VesselReaction::VesselReaction(const Model& model, std::size_t fat, std::size_t tree)
    : model_(model), fat_(fat), tree_(tree) {
  for (std::size_t t = 0; t < model.ties().size(); ++t) {
    const Tie& tie = model.ties()[t];
    if (tie.fat == fat && tie.body[0] == model.organs().size() + tree) tie_.push_back(t);
  }
  weight_.assign(tie_.size(), 0.0);
  fatSeen_.assign(tie_.size(), Vec3::Zero());
}

std::size_t VesselReaction::nodeOf(std::size_t i) const {
  return static_cast<std::size_t>(model_.ties()[tie_[i]].place[0].node[0]);
}

const MaterialPoint& VesselReaction::placeOf(std::size_t i) const { return model_.ties()[tie_[i]].place[1]; }

void VesselReaction::linearise(const State& state, bool awake, const FatMotion& fat, double step) {
  holds_ = false;
  if (!awake) return;
  for (std::size_t i = 0; i < tie_.size(); ++i) {
    const Tie& tie = model_.ties()[tie_[i]];
    weight_[i] = step * (fat.fat().tieShare(tie.fatTie) * (step * tie.stiffness + tie.damping));
    if (!(weight_[i] > 0.0)) continue;
    holds_ = true;
    fatSeen_[i] = placeOf(i).of(fat.velocity(state));
  }
}

void VesselReaction::assemble(FatMotion& fat, VesselBody& vessel, TieCoupling* grown, const SolidSystem* organ) {
  vessel_ = &vessel;
  grown_ = grown;
  organ_ = organ;
  const SolidSystem& system = fat.solver().system();
  share_.clear();
  for (std::size_t i = 0; i < tie_.size(); ++i) {
    if (!(weight_[i] > 0.0)) continue;
    const MaterialPoint& place = placeOf(i);
    for (std::size_t k = 0; k < place.count; ++k) {
      const int row = system.row(static_cast<std::size_t>(place.node[k]));
      if (row < 0 || place.weight[k] == 0.0) continue;
      share_.push_back(
          {static_cast<std::uint32_t>(row), static_cast<std::uint32_t>(nodeOf(i)), weight_[i] * place.weight[k]});
    }
  }
  std::stable_sort(share_.begin(), share_.end(),
                   [](const Share& a, const Share& b) { return std::tie(a.row, a.node) < std::tie(b.row, b.node); });
  std::size_t kept = 0;
  for (std::size_t k = 0; k < share_.size(); ++k) {
    if (kept > 0 && share_[kept - 1].row == share_[k].row && share_[kept - 1].node == share_[k].node) {
      share_[kept - 1].weight += share_[k].weight;
    } else {
      share_[kept++] = share_[k];
    }
  }
  share_.resize(kept);
}

void VesselReaction::addTo(ConjugateGradient& organ, ConjugateGradient& fat) {
  push_.assign(vessel_->nodes(), Vec3::Zero());
  Vec3 along = Vec3::Zero();
  for (std::size_t k = 0; k < share_.size(); ++k) {
    if (k == 0 || share_[k].row != share_[k - 1].row) {
      const std::array<float, 3> d = fat.directionAt(share_[k].row);
      along = Vec3(static_cast<double>(d[0]), static_cast<double>(d[1]), static_cast<double>(d[2]));
    }
    push_[share_[k].node] += share_[k].weight * along;
  }
  vessel_->respond(push_, answer_);
  if (grown_ != nullptr) grown_->react(*organ_, organ, model_.organs().size() + tree_, *vessel_, answer_);
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < share_.size(); ++k) {
    sum -= share_[k].weight * answer_[share_[k].node];
    if (k + 1 < share_.size() && share_[k + 1].row == share_[k].row) continue;
    fat.addToProduct(share_[k].row,
                     {static_cast<float>(sum[0]), static_cast<float>(sum[1]), static_cast<float>(sum[2])});
    sum.setZero();
  }
}

void VesselReaction::pull(const FatMotion& fat, VesselBody& vessel) {
  push_.assign(vessel.nodes(), Vec3::Zero());
  for (std::size_t i = 0; i < tie_.size(); ++i) {
    if (!(weight_[i] > 0.0)) continue;
    const Vec3 now = placeOf(i).of(fat.freeVelocity());
    push_[nodeOf(i)] += weight_[i] * (now - fatSeen_[i]);
    fatSeen_[i] = now;
  }
  vessel.applyImpulses(push_);
}

void VesselReaction::see(const VesselBody& vessel) {
  vesselSeen_.assign(vessel.freeVelocity().begin(), vessel.freeVelocity().end());
}

void VesselReaction::passOn(const FatMotion& fat, const VesselBody& vessel, std::vector<Vec3>& impulse) {
  for (std::size_t i = 0; i < tie_.size(); ++i) {
    if (!(weight_[i] > 0.0)) continue;
    const Vec3 change = weight_[i] * (vessel.freeVelocity()[nodeOf(i)] - vesselSeen_[nodeOf(i)]);
    if (change.isZero(0.0)) continue;
    if (impulse.empty()) impulse.assign(fat.nodes(), Vec3::Zero());
    const MaterialPoint& place = placeOf(i);
    for (std::size_t k = 0; k < place.count; ++k) {
      impulse[static_cast<std::size_t>(place.node[k])] += place.weight[k] * change;
    }
  }
  see(vessel);
}

}  // namespace calot
