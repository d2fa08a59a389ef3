// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/coupling.h"

#include <utility>

namespace calot {

StrandCoupling::StrandCoupling(const Model& model, std::size_t tissue, double step)
    : Coupling(model.connective()[tissue].a, model.connective()[tissue].b),
      model_(model.connective()[tissue]),
      tissue_(tissue),
      step_(step) {
  std::vector<std::array<MaterialPoint, 2>> points;
  for (const Strand& strand : model_.tissue.strands()) points.push_back({strand.a, strand.b});
  coupling_ = std::make_unique<PointCoupling>(model.organs()[model_.a].solid.system(),
                                              model.organs()[model_.b].solid.system(), points);
}

bool StrandCoupling::takeState(const State& state) {
  const SolidState& a = state.organ[model_.a];
  const SolidState& b = state.organ[model_.b];
  calot::linearise(model_.tissue, state.connective[tissue_], {a.position, a.velocity, a.rotation},
                   {b.position, b.velocity, b.rotation}, step_, loads_);
  return !loads_.onA.empty();
}

void StrandCoupling::load(std::size_t body, std::vector<Attachment>& attachments,
                          std::vector<JointAttachment>& /*joints*/) const {
  if (body == model_.a) attachments.insert(attachments.end(), loads_.onA.begin(), loads_.onA.end());
  if (body == model_.b) attachments.insert(attachments.end(), loads_.onB.begin(), loads_.onB.end());
}

FatTies::FatTies(const Model& model, std::size_t organ, std::size_t body, std::vector<std::size_t> ties, double step,
                 OrganBody& organBody, FatMotion& fat)
    : Coupling(organ, body),
      model_(model),
      tie_(std::move(ties)),
      step_(step),
      organ_(organBody),
      fat_(fat),
      damper_(tie_.size()) {
  for (const std::size_t t : tie_) place_.push_back(model.ties()[t].place);
}

bool FatTies::takeState(const State& /*state*/) {
  bool holds = false;
  for (std::size_t i = 0; i < tie_.size(); ++i) {
    const Tie& tie = model_.ties()[tie_[i]];
    damper_[i] = fat_.fat().tieShare(tie.fatTie) * (step_ * tie.stiffness + tie.damping);
    holds = holds || damper_[i] > 0.0;
  }
  return holds;
}

void FatTies::assemble() {
  SolidSolver& fat = fat_.solver();
  if (coupling_ == nullptr || version_ != fat.systemVersion()) {
    coupling_ = std::make_unique<PointCoupling>(organ_.solver().system(), fat.system(), place_);
    version_ = fat.systemVersion();
  }
  coupling_->assemble(damper_, step_);
}

}  // namespace calot
