// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/fat_motion.h"

#include <algorithm>
#include <cassert>

namespace calot {

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
