// SPDX-License-Identifier: GPL-3.0-or-later

#include "sim/step/solid_body.h"

#include <algorithm>
#include <cassert>

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

FatMotion::FatMotion(const Model& model, std::size_t fat, const SolidSolver::Settings& settings,
                     const SolidSolver::Settings& responses, Executor& executor, const ComplianceShelf& shelf)
    : index_(fat),
      settings_(settings),
      executor_(executor),
      fat_(*model.fat()[fat]),
      rest_(model.fat()[fat]->solid(), responses, executor,
            {model.fat()[fat]->restAttachments(settings.step), model.fat()[fat]->restFill()}, shelf) {}

void FatMotion::beginStep(const State& state) {
  if (stale_) {
    [[maybe_unused]] const bool taken = fat_.rebuild(state.fat[index_]);
    assert(taken);  // restoreState() lets nothing else in
    stale_ = false;
    changed_ = true;
  }
  fat_.beginStep(state.fat[index_]);
}

FatStroke FatMotion::stroke(State& state, std::span<const SweptCapsule> tool, double rise) {
  const FatStroke done = fat_.stroke(state.fat[index_], tool, rise);
  changed_ = changed_ || done.changed;
  return done;
}

std::span<const Vec3> FatMotion::position(const State& state) const { return state.fat[index_].solid.position; }
std::span<const Vec3> FatMotion::velocity(const State& state) const { return state.fat[index_].solid.velocity; }
std::uint32_t& FatMotion::quietSteps(State& state) const { return state.fat[index_].solid.quietSteps; }

void FatMotion::assembleUnconstrained(State& state, const Vec3& gravity, std::span<const Vec3> force,
                                      std::span<const TieLoad> ties, const Surroundings& loads) {
  load_.assign(loads.attachments.begin(), loads.attachments.end());
  addAttachments(ties, settings_.step, position(state), load_);
  solver_.assembleUnconstrained(fat_.model().solid(), state.fat[index_].solid, gravity, force, settings_, executor_,
                                {load_, fat_.fill(), loads.joints});
}

Mat3 FatMotion::rotation(const State& state, int node) const { return fat_.rotation(state.fat[index_], node); }

bool FatMotion::advance(State& state) {
  return solver_.advance(fat_.model().solid(), state.fat[index_].solid, {}, settings_.step);
}

void FatMotion::stop(State& state) const {
  std::vector<Vec3>& velocity = state.fat[index_].solid.velocity;
  std::fill(velocity.begin(), velocity.end(), Vec3::Zero());
}

bool FatSkin::follow(const State& /*state*/) {
  const bool changed = motion_.changed_;
  motion_.changed_ = false;
  return changed;
}

void FatSkin::place(const State& state, std::vector<Vec3>& out) const {
  motion_.fat_.contact().positions(motion_.position(state), out);
}

SolidSolver::Impulse FatSkin::influence(const std::array<int, 3>& corner, const Vec3& weight) const {
  return motion_.fat_.contact().influence(corner, weight);
}

}  // namespace calot
