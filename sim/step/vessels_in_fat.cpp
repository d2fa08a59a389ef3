// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/step/coupling.h"

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

VesselsInFat::VesselsInFat(const Model& model, std::size_t body, std::size_t fat, std::size_t tree, double step,
                           FatMotion& fatBody, VesselBody& vessel, GrownVessels* grown)
    : Coupling(grown != nullptr ? grown->organ() : body, body),
      model_(model),
      vesselBody_(model.organs().size() + tree),
      step_(step),
      fat_(fatBody),
      vessel_(vessel),
      grown_(grown) {
  for (std::size_t t = 0; t < model.ties().size(); ++t) {
    const Tie& tie = model.ties()[t];
    if (tie.fat == fat && tie.body[0] == vesselBody_) tie_.push_back(t);
  }
  weight_.assign(tie_.size(), 0.0);
  fatSeen_.assign(tie_.size(), Vec3::Zero());
}

std::size_t VesselsInFat::nodeOf(std::size_t i) const {
  return static_cast<std::size_t>(model_.ties()[tie_[i]].place[0].node[0]);
}

const MaterialPoint& VesselsInFat::placeOf(std::size_t i) const { return model_.ties()[tie_[i]].place[1]; }

bool VesselsInFat::takeState(const State& state) {
  bool holds = false;
  for (std::size_t i = 0; i < tie_.size(); ++i) {
    const Tie& tie = model_.ties()[tie_[i]];
    weight_[i] = step_ * (fat_.fat().tieShare(tie.fatTie) * (step_ * tie.stiffness + tie.damping));
    if (!(weight_[i] > 0.0)) continue;
    holds = true;
    fatSeen_[i] = placeOf(i).of(fat_.velocity(state));
  }
  return holds;
}

void VesselsInFat::assemble() {
  if (version_ != fat_.solver().systemVersion() || summed_ != weight_) {
    sumShares(fat_.solver().system());
    version_ = fat_.solver().systemVersion();
    summed_ = weight_;
  }
  response_.precompute(vessel_.solver().matrix(), vessel_.model().parents(), touched_);
  if (grown_ != nullptr) findReach();
}

void VesselsInFat::sumShares(const SolidSystem& fat) {
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
  for (std::size_t i = 0; grown_ != nullptr && i < grown_->size(); ++i) {
    const int node = grown_->nodeOf(i, vesselBody_);
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
void VesselsInFat::findReach() {
  held_.assign(grown_->size(), none);
  reach_.clear();
  for (std::size_t i = 0; i < grown_->size(); ++i) {
    const int node = grown_->nodeOf(i, vesselBody_);
    if (node < 0) continue;
    held_[i] = numberOf(touched_, static_cast<std::uint32_t>(node));
    for (const std::uint32_t n : touched_) {
      const Mat3 block = vessel_.block(static_cast<int>(n), node);
      for (int k = 0; k < 3; ++k) reach_.push_back(fourOf(block.col(k)));
    }
  }
}

void VesselsInFat::addTo(ConjugateGradient& organ, ConjugateGradient& fat) {
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
void VesselsInFat::addGrown(ConjugateGradient& organ) {
  heldResponse_.assign(held_.size(), Vec3::Zero());
  for (std::size_t i = 0; i < held_.size(); ++i) {
    if (held_[i] != none) heldResponse_[i] = vectorOf(moved_[held_[i]]);
  }
  grown_->react(organ, vesselBody_, heldResponse_, heldPush_);
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

void VesselsInFat::follow() {
  push_.assign(vessel_.nodes(), Vec3::Zero());
  for (std::size_t i = 0; i < tie_.size(); ++i) {
    if (!(weight_[i] > 0.0)) continue;
    const Vec3 now = placeOf(i).of(fat_.freeVelocity());
    push_[nodeOf(i)] += weight_[i] * (now - fatSeen_[i]);
    fatSeen_[i] = now;
  }
  vessel_.applyImpulses(push_);
}

void VesselsInFat::see() { vesselSeen_.assign(vessel_.freeVelocity().begin(), vessel_.freeVelocity().end()); }

void VesselsInFat::passOn(std::size_t body, std::vector<Vec3>& impulse) {
  if (body != bodies()[1]) return;
  for (std::size_t i = 0; i < tie_.size(); ++i) {
    if (!(weight_[i] > 0.0)) continue;
    const Vec3 change = weight_[i] * (vessel_.freeVelocity()[nodeOf(i)] - vesselSeen_[nodeOf(i)]);
    if (change.isZero(0.0)) continue;
    if (impulse.empty()) impulse.assign(fat_.nodes(), Vec3::Zero());
    const MaterialPoint& place = placeOf(i);
    for (std::size_t k = 0; k < place.count; ++k) {
      impulse[static_cast<std::size_t>(place.node[k])] += place.weight[k] * change;
    }
  }
  see();
}

}  // namespace calot
