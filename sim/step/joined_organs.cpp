// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/joined_organs.h"

#include <algorithm>
#include <utility>

namespace calot {

JoinedOrgans::JoinedOrgans(const Model& model, std::vector<OrganBody*> organs, const SolidSolver::Settings& settings,
                           const SolidSolver::Settings& responses)
    : model_(model), organ_(std::move(organs)), settings_(settings), responses_(responses) {
  for (const ConnectiveModel& tie : model.connective()) {
    std::vector<std::array<MaterialPoint, 2>> points;
    for (const Strand& strand : tie.tissue.strands()) points.push_back({strand.a, strand.b});
    tissue_.emplace_back().coupling =
        std::make_unique<PointCoupling>(model.organs()[tie.a].solid, model.organs()[tie.b].solid, points);
  }
  first_.resize(organ_.size());
}

void JoinedOrgans::linearise(const State& state, const std::vector<bool>& awake) {
  for (std::size_t o = 0; o < first_.size(); ++o) first_[o] = o;
  for (std::size_t c = 0; c < tissue_.size(); ++c) {
    const ConnectiveModel& tie = model_.connective()[c];
    const SolidState& a = state.organ[tie.a];
    const SolidState& b = state.organ[tie.b];
    Tissue& tissue = tissue_[c];
    tissue.holds = false;
    if (!awake[tie.a]) continue;  // organs that strands tie are awake together
    calot::linearise(tie.tissue, state.connective[c], {a.position, a.velocity, a.rotation},
                     {b.position, b.velocity, b.rotation}, settings_.step, tissue.loads);
    tissue.holds = !tissue.loads.onA.empty();
    if (!tissue.holds) continue;
    tissue.coupling->assemble(tissue.loads.damper, settings_.step);
    const std::size_t kept = std::min(first_[tie.a], first_[tie.b]);
    const std::size_t merged = std::max(first_[tie.a], first_[tie.b]);
    std::replace(first_.begin(), first_.end(), merged, kept);
  }
  std::size_t groups = 0;
  for (std::size_t o = 0; o < first_.size(); ++o) {
    if (first_[o] != o) continue;
    if (group_.size() == groups) group_.emplace_back();
    std::vector<std::size_t>& group = group_[groups++];
    group.clear();
    for (std::size_t other = o; other < first_.size(); ++other) {
      if (first_[other] == o) group.push_back(other);
    }
  }
  group_.resize(groups);
}

void JoinedOrgans::addAttachments(std::size_t organ, std::vector<Attachment>& out) const {
  for (std::size_t c = 0; c < tissue_.size(); ++c) {
    const ConnectiveModel& tie = model_.connective()[c];
    const ConnectiveLoads& loads = tissue_[c].loads;
    if (!tissue_[c].holds) continue;
    if (tie.a == organ) out.insert(out.end(), loads.onA.begin(), loads.onA.end());
    if (tie.b == organ) out.insert(out.end(), loads.onB.begin(), loads.onB.end());
  }
}

SolveReport JoinedOrgans::solve(std::size_t group, const SolidSolver::Settings& settings) {
  const std::vector<std::size_t>& organs = group_[group];
  const auto number = [&](std::size_t organ) {
    return static_cast<std::size_t>(std::find(organs.begin(), organs.end(), organ) - organs.begin());
  };
  solver_.clear();
  coupled_.clear();
  for (const std::size_t o : organs) solver_.push_back(&organ_[o]->solver());
  for (std::size_t c = 0; c < tissue_.size(); ++c) {
    const ConnectiveModel& tie = model_.connective()[c];
    if (!tissue_[c].holds || first_[tie.a] != organs[0]) continue;
    coupled_.push_back({number(tie.a), number(tie.b), *tissue_[c].coupling});
  }
  return SolidSolver::solveJoined(solver_, coupled_, settings);
}

}  // namespace calot
