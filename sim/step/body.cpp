// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/body.h"

#include <algorithm>
#include <cassert>

namespace calot {

namespace {

/// Springs to other bodies as a solid takes them.
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

}  // namespace

void SolidBody::linearise(const State& state) {
  SerialExecutor alone;  // it is one task among others
  solver_.linearise(model_, solidOf(state), settings_, fill(), alone);
}

void SolidBody::load(State& state, const Vec3& gravity, std::span<const Vec3> force, std::span<const TieLoad> ties,
                     const Surroundings& loads) {
  load_.assign(loads.attachments.begin(), loads.attachments.end());
  addAttachments(ties, settings_.step, position(state), load_);
  solver_.load(model_, solidOf(state), gravity, force, settings_, executor_, {load_, fill(), loads.joints});
}

void SolidBody::stop(State& state) const {
  std::vector<Vec3>& velocity = solidOf(state).velocity;
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
    : SolidBody(model.fat()[fat]->solid(), settings, responses, executor,
                {model.fat()[fat]->restAttachments(settings.step), model.fat()[fat]->restFill()}, shelf),
      index_(fat),
      fat_(*model.fat()[fat]) {}

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

FatStroke FatMotion::tear(State& state) {
  const FatStroke done = fat_.tear(state.fat[index_]);
  changed_ = changed_ || done.changed;
  return done;
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

VesselBody::VesselBody(const Model& model, std::size_t tree, double step)
    : tree_(tree), beams_(model.vesselTrees()[tree].beams), step_(step) {}

std::span<const Vec3> VesselBody::position(const State& state) const { return state.vessel[tree_].position; }
std::span<const Vec3> VesselBody::velocity(const State& state) const { return state.vessel[tree_].velocity; }
std::uint32_t& VesselBody::quietSteps(State& state) const { return state.vessel[tree_].quietSteps; }

SolveReport VesselBody::solveUnconstrained(State& state, const Vec3& gravity, std::span<const Vec3> force,
                                           std::span<const TieLoad> ties) {
  attachment_.clear();
  for (const TieLoad& tie : ties) {
    attachment_.push_back({tie.place.node[0], tie.stiffness, tie.damping, tie.target, tie.velocity});
  }
  SolveReport report;
  report.converged = solver_.solveUnconstrained(beams_, state.vessel[tree_], {gravity, force, {}, attachment_}, step_);
  report.residual = report.converged ? 0.0 : 1.0;
  report.iterations = 1;
  return report;
}

Mat3 VesselBody::rotation(const State& /*state*/, int /*node*/) const { return Mat3::Identity(); }

bool VesselBody::advance(State& state) {
  report_ = solver_.advance(beams_, state.vessel[tree_]);
  return report_.finite;
}

void VesselBody::stop(State& state) const {
  BeamState& beams = state.vessel[tree_];
  std::fill(beams.velocity.begin(), beams.velocity.end(), Vec3::Zero());
  std::fill(beams.angularVelocity.begin(), beams.angularVelocity.end(), Vec3::Zero());
}

TubeSkin::TubeSkin(const Model& model, std::size_t tree, std::size_t branch)
    : beams_(model.vesselTrees()[tree].beams), tree_(tree), tube_(beams_, branch, tubeSettings) {}

bool TubeSkin::follow(const State& state) {
  const BeamState& beams = state.vessel[tree_];
  if (!tube_.update(beams) && contact_.has_value()) return false;
  BeamState rest = restState(beams_);
  rest.parting = beams.parting;
  rest.partedAt = beams.partedAt;
  tube_.positions(rest, rest_);
  contact_.emplace(rest_, tube_.triangles());
  return true;
}

void TubeSkin::place(const State& state, std::vector<Vec3>& out) const { tube_.positions(state.vessel[tree_], out); }

SolidSolver::Impulse TubeSkin::influence(const std::array<int, 3>& corner, const Vec3& weight) const {
  SolidSolver::Impulse out;
  for (std::size_t c = 0; c < 3; ++c) {
    const BeamInfluence& hung = tube_.influence(corner[c]);
    for (std::size_t k = 0; k < hung.count; ++k) {
      addShare(out, hung.node[k], weight[static_cast<int>(c)] * hung.weight[k]);
    }
  }
  return out;
}

}  // namespace calot
