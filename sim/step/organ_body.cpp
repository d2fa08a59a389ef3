// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/organ_body.h"

#include <algorithm>

namespace calot {

OrganBody::OrganBody(const Model& model, std::size_t organ, const SolidSolver::Settings& settings,
                     const SolidSolver::Settings& responses, Executor& executor, const ComplianceShelf& shelf)
    : organ_(organ),
      solid_(model.organs()[organ].solid),
      settings_(settings),
      executor_(executor),
      rest_(solid_, responses, executor, {}, shelf) {}

std::span<const Vec3> OrganBody::position(const State& state) const { return state.organ[organ_].position; }
std::span<const Vec3> OrganBody::velocity(const State& state) const { return state.organ[organ_].velocity; }
std::uint32_t& OrganBody::quietSteps(State& state) const { return state.organ[organ_].quietSteps; }

void addAttachments(std::span<const TieLoad> ties, double step, std::span<const Vec3> position,
                    std::vector<Attachment>& out) {
  for (const TieLoad& tie : ties) {
    Attachment attachment;
    attachment.point = tie.place;
    const double damper = step * tie.stiffness + tie.damping;
    attachment.force = tie.stiffness * (tie.target - tie.place.of(position)) + damper * tie.velocity;
    attachment.damper = damper * Mat3::Identity();
    out.push_back(attachment);
  }
}

void OrganBody::assembleUnconstrained(State& state, const Vec3& gravity, std::span<const Vec3> force,
                                      std::span<const TieLoad> ties, const Surroundings& loads) {
  load_.assign(loads.attachments.begin(), loads.attachments.end());
  addAttachments(ties, settings_.step, position(state), load_);
  solver_.assembleUnconstrained(solid_, state.organ[organ_], gravity, force, settings_, executor_,
                                {load_, {}, loads.joints});
}

Mat3 OrganBody::rotation(const State& state, int node) const {
  return nodeRotation(solid_, state.organ[organ_], node).toRotationMatrix();
}

bool OrganBody::advance(State& state) { return solver_.advance(solid_, state.organ[organ_], {}, settings_.step); }

void OrganBody::stop(State& state) const {
  std::vector<Vec3>& velocity = state.organ[organ_].velocity;
  std::fill(velocity.begin(), velocity.end(), Vec3::Zero());
}

bool OrganSkin::follow(const State& /*state*/) { return false; }

void OrganSkin::place(const State& state, std::vector<Vec3>& out) const {
  model_.embedding.map(state.organ[organ_].position, out);
}

SolidSolver::Impulse OrganSkin::influence(const std::array<int, 3>& corner, const Vec3& weight) const {
  SolidSolver::Impulse out;
  for (std::size_t c = 0; c < 3; ++c) {
    const Embedding::Anchor& anchor = model_.embedding.anchors()[static_cast<std::size_t>(corner[c])];
    for (std::size_t a = 0; a < 4; ++a) addShare(out, anchor.node[a], weight[static_cast<int>(c)] * anchor.weight[a]);
  }
  return out;
}

}  // namespace calot
