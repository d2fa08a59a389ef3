// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/step/bodies.h"

#include <algorithm>
#include <array>
#include <tuple>

#include "sim/solid/conjugate_gradient.h"

namespace calot {

namespace {

constexpr std::uint32_t none = UINT32_MAX;

std::uint32_t numberOf(const std::vector<std::uint32_t>& ascending, std::uint32_t node) {
  return static_cast<std::uint32_t>(std::lower_bound(ascending.begin(), ascending.end(), node) - ascending.begin());
}

FourFloats fourOf(const Vec3& v) {
  return FourFloats{static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]), 0.0F};
}

Vec3 vectorOf(const FourFloats& v) {
  return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

}  // namespace

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
  grown_ = grown;
  organ_ = organ;
  if (version_ != fat.solver().systemVersion() || summed_ != weight_) {
    sumShares(fat.solver().system(), grown);
    version_ = fat.solver().systemVersion();
    summed_ = weight_;
  }
  response_.precompute(vessel.solver().matrix(), vessel.model().parents(), touched_);
  if (grown_ != nullptr) findReach(vessel);
}

void VesselReaction::sumShares(const SolidSystem& fat, const TieCoupling* grown) {
  std::vector<Share> share;
  touched_.clear();
  for (std::size_t i = 0; i < tie_.size(); ++i) {
    if (!(weight_[i] > 0.0)) continue;
    const MaterialPoint& place = placeOf(i);
    for (std::size_t k = 0; k < place.count; ++k) {
      const int row = fat.row(static_cast<std::size_t>(place.node[k]));
      if (row < 0 || place.weight[k] == 0.0) continue;
      share.push_back(
          {static_cast<std::size_t>(row), static_cast<std::uint32_t>(nodeOf(i)), weight_[i] * place.weight[k]});
      touched_.push_back(share.back().node);
    }
  }
  for (std::size_t i = 0; grown != nullptr && i < grown->size(); ++i) {
    const int node = grown->nodeOf(i, model_.organs().size() + tree_);
    if (node >= 0) touched_.push_back(static_cast<std::uint32_t>(node));
  }
  std::sort(touched_.begin(), touched_.end());
  touched_.erase(std::unique(touched_.begin(), touched_.end()), touched_.end());
  std::stable_sort(share.begin(), share.end(),
                   [](const Share& x, const Share& y) { return std::tie(x.row, x.node) < std::tie(y.row, y.node); });
  row_.clear();
  start_.clear();
  node_.clear();
  shareOf_.clear();
  for (std::size_t k = 0; k < share.size(); ++k) {
    const bool sameRow = k > 0 && share[k].row == share[k - 1].row;
    if (sameRow && share[k].node == share[k - 1].node) {
      shareOf_.back() += static_cast<float>(share[k].weight);
      continue;
    }
    if (!sameRow) {
      row_.push_back(share[k].row);
      start_.push_back(node_.size());
    }
    node_.push_back(numberOf(touched_, share[k].node));
    shareOf_.push_back(static_cast<float>(share[k].weight));
  }
  start_.push_back(node_.size());
}

/// How the nodes answer to impulses where the vessels are grown to an organ.
void VesselReaction::findReach(const VesselBody& vessel) {
  held_.assign(grown_->size(), none);
  reach_.clear();
  for (std::size_t i = 0; i < grown_->size(); ++i) {
    const int node = grown_->nodeOf(i, model_.organs().size() + tree_);
    if (node < 0) continue;
    held_[i] = numberOf(touched_, static_cast<std::uint32_t>(node));
    for (const std::uint32_t n : touched_) {
      const Mat3 block = vessel.block(static_cast<int>(n), node);
      for (int k = 0; k < 3; ++k) reach_.push_back(fourOf(block.col(k)));
    }
  }
}

void VesselReaction::addTo(ConjugateGradient& organ, ConjugateGradient& fat) {
  moved_.assign(touched_.size(), FourFloats{});
  for (std::size_t r = 0; r < row_.size(); ++r) {
    const FourFloats along = fat.directionAt(row_[r]);
    for (std::size_t k = start_[r]; k < start_[r + 1]; ++k) moved_[node_[k]] += shareOf_[k] * along;
  }
  response_.solve(moved_);
  if (grown_ != nullptr) addGrown(organ);
  for (std::size_t r = 0; r < row_.size(); ++r) {
    FourFloats sum{};
    for (std::size_t k = start_[r]; k < start_[r + 1]; ++k) sum -= shareOf_[k] * moved_[node_[k]];
    fat.addToProduct(row_[r], sum);
  }
}

/// Contribution of the organ.
void VesselReaction::addGrown(ConjugateGradient& organ) {
  heldResponse_.assign(held_.size(), Vec3::Zero());
  for (std::size_t i = 0; i < held_.size(); ++i) {
    if (held_[i] != none) heldResponse_[i] = vectorOf(moved_[held_[i]]);
  }
  grown_->react(*organ_, organ, model_.organs().size() + tree_, heldResponse_, heldPush_);
  const FourFloats* column = reach_.data();
  for (std::size_t i = 0; i < held_.size(); ++i) {
    if (held_[i] == none) continue;
    const FourFloats push = fourOf(heldPush_[i]);
    for (FourFloats& moved : moved_) {
      moved += (push[0] * column[0] + push[1] * column[1]) + push[2] * column[2];
      column += 3;
    }
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
