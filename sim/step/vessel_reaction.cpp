// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/step/vessel_reaction.h"

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

void VesselReaction::assemble(FatMotion& fat, VesselBody& vessel) {
  vessel_ = &vessel;
  row_.clear();
  for (std::size_t i = 0; i < tie_.size(); ++i) {
    if (!(weight_[i] > 0.0)) continue;
    const MaterialPoint& place = placeOf(i);
    Row row;
    row.tie = i;
    for (std::size_t k = 0; k < place.count; ++k) {
      const int r = fat.solver().system().row(static_cast<std::size_t>(place.node[k]));
      if (r < 0 || place.weight[k] == 0.0) continue;
      row.row[row.count] = static_cast<std::uint32_t>(r);
      row.weight[row.count++] = place.weight[k];
    }
    row_.push_back(row);
  }
}

void VesselReaction::addTo(ConjugateGradient& first, ConjugateGradient& /*second*/) {
  push_.assign(vessel_->nodes(), Vec3::Zero());
  for (const Row& row : row_) {
    Vec3 along = Vec3::Zero();
    for (std::size_t k = 0; k < row.count; ++k) {
      const std::array<float, 3> d = first.directionAt(row.row[k]);
      along += row.weight[k] * Vec3(static_cast<double>(d[0]), static_cast<double>(d[1]), static_cast<double>(d[2]));
    }
    push_[nodeOf(row.tie)] += weight_[row.tie] * along;
  }
  vessel_->respond(push_, answer_);
  for (const Row& row : row_) {
    const Vec3 back = -weight_[row.tie] * answer_[nodeOf(row.tie)];
    for (std::size_t k = 0; k < row.count; ++k) {
      const Vec3 share = row.weight[k] * back;
      first.addToProduct(row.row[k], {static_cast<float>(share[0]), static_cast<float>(share[1]),  //
                                      static_cast<float>(share[2])});
    }
  }
}

void VesselReaction::pull(const FatMotion& fat, VesselBody& vessel) {
  push_.assign(vessel.nodes(), Vec3::Zero());
  for (const Row& row : row_) {
    const Vec3 change = placeOf(row.tie).of(fat.freeVelocity()) - fatSeen_[row.tie];
    push_[nodeOf(row.tie)] += weight_[row.tie] * change;
  }
  vessel.applyImpulses(push_);
}

}  // namespace calot
