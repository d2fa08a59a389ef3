// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/stepper.h"

#include <cassert>

#include "sim/math/floating_point.h"
#include "sim/step/stages.h"
#include "sim/step/tissue_effects.h"

namespace calot {

namespace {

StepResult emptyResult(const Model& model) {
  StepResult result;
  Tissues::forEach([&]<class Kind>(std::type_identity<Kind>, TissueId) { Kind::resize(model, result); });
  for (HandResult& hand : result.hand) hand.structureForce.resize(model.structures().size());
  return result;
}

}  // namespace

/// The stages, what they hand on, and what they work on.
struct Stepper::Pipeline {
  Pipeline(const Model& m, Executor& executor, const StepperServices& services)
      : model(m),
        bodies(m, executor, services.compliances),
        surfaces(m, bodies, services.makeBroadPhase, executor),
        activity(m),
        grasping(m),
        sampleStage(m),
        instrumentMotion(m, grasping),
        contactDetection(m, grasping, executor),
        unconstrainedMotion(m),
        contactProblem(m),
        contactSolution(m),
        contactResponse(m),
        tissueEffects(m),
        settling(m, grasping),
        publication(m, bodies),
        result(emptyResult(m)) {}

  const Model& model;
  Bodies bodies;
  Surfaces surfaces;
  Activity activity;
  Grasping grasping;

  SampleStage sampleStage;
  InstrumentMotion instrumentMotion;
  ContactDetection contactDetection;
  UnconstrainedMotion unconstrainedMotion;
  ContactProblemStage contactProblem;
  ContactSolution contactSolution;
  ContactResponse contactResponse;
  TissueEffects tissueEffects;
  Settling settling;
  Publication publication;

  ContactSystem contact;
  ContactSets contactSets;
  StepResult result;
  IncrementalDigest digest;
};

Stepper::Stepper(const Model& model, Executor& executor, const StepperServices& services)
    : p_(std::make_unique<Pipeline>(model, executor, services)) {}
Stepper::~Stepper() = default;

const StepResult& Stepper::step(State& state, std::span<const TickSamples> samples) {
  const FloatingPointScope scope;
  Pipeline& p = *p_;
  assert(samples.size() == p.model.scene().ticksPerStep);
  p.result.step = state.clock.step;
  p.result.contact = {};
  StepLog log{p.result};
  p.activity.beginStep();
  p.bodies.beginStep(state);

  p.sampleStage.run(samples, state, log);
  p.surfaces.refresh(state);
  const InstrumentTravels travels = p.instrumentMotion.run(p.surfaces, state, log, p.result.contact);
  p.result.contact.tissueDepth = p.contactDetection.run(p.surfaces, p.bodies, travels, state, p.activity, p.contact);
  loadWarmStart(state, p.contact);
  p.unconstrainedMotion.run(p.bodies, p.contact, p.activity, state, p.result, log);
  p.result.contact.violation = p.contactProblem.run(p.bodies, p.activity, travels, state, p.contact);
  p.contactSolution.run(p.bodies, p.activity, travels, p.contact, p.result.contact, log);
  p.contactResponse.run(p.surfaces, p.bodies, p.activity, travels, p.contact, state, p.contactSets, p.result, log);
  p.tissueEffects.run(travels, p.surfaces, p.bodies, state, p.activity, p.result, log);
  p.settling.run(p.contact, p.contactResponse.diverged(), p.surfaces, p.bodies, state, p.activity, p.result, log);
  p.publication.run(p.bodies, p.activity, state, p.result);

  ++state.clock.step;
  return p.result;
}

void Stepper::precompute() {
  const FloatingPointScope scope;
  p_->contactDetection.precompute();
  p_->bodies.precompute();
}

const ContactSet& Stepper::contactSet(std::size_t hand) const { return p_->contactSets[hand]; }

const StateDigest& Stepper::digest(const State& state) {
  std::vector<bool> written(state.tissueFrom(), true);
  p_->activity.appendWritten(p_->bodies, written);
  const StateDigest& digest = p_->digest.update(state, written);
  assert(digest == digestOf(state));
  return digest;
}

void Stepper::invalidate() {
  p_->surfaces.invalidate();
  p_->bodies.invalidate();
  p_->contactDetection.invalidate();
  p_->settling.invalidate();
  p_->contactSets = {};
  p_->digest.reset();
}

}  // namespace calot
