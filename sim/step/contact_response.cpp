// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/contact_response.h"

#include <algorithm>

#include "sim/step/contact_dimples.h"
#include "sim/step/instrument_motion.h"
#include "sim/step/warm_start.h"

namespace calot {

namespace {

/// Velocity of a body at a contact point (m/s); zero without a body.
Vec3 velocityAt(const Bodies& bodies, const State& state, const ContactBlock& block) {
  Vec3 v = Vec3::Zero();
  if (block.body == ContactBlock::none) return v;
  const std::span<const Vec3> velocity = bodies[block.body].velocity(state);
  for (std::size_t k = 0; k < block.place.count; ++k)
    v += block.place.weight[k] * velocity[static_cast<std::size_t>(block.place.node[k])];
  return v;
}

}  // namespace

void reduceToHand(const Bodies& bodies, const State& state, const InstrumentTravels& travels,
                  const ContactSystem& contact, std::size_t hand, std::uint64_t step, ContactSet& set) {
  set.step = static_cast<std::int64_t>(step);
  set.reference = travels[hand].reference;
  set.kind.clear();
  set.limit.clear();
  set.direction.clear();
  set.free.clear();
  set.rate.clear();
  set.compliance.clear();
  set.lambda.clear();
  for (const ContactBlock& block : contact.blocks) {
    const std::array<ToolRow, 3>* const tool = block.toolOf(hand);
    if (tool == nullptr) continue;
    set.kind.push_back(block.kind);
    set.limit.push_back(block.limit);
    const Vec3 velocity = velocityAt(bodies, state, block);
    for (std::size_t k = 0; k < block.rows(); ++k) {
      const std::size_t i = block.row + k;
      double free = contact.freeGap[i] - (*tool)[k].dot(travels[hand].stretch);
      for (const ContactBlock& b : contact.blocks) {
        for (std::size_t j = b.row; j < b.row + b.rows(); ++j) {
          if (b.toolOf(hand) != nullptr) {
            set.compliance.push_back(contact.compliance[i * contact.rows + j]);
          } else {
            free += contact.compliance[i * contact.rows + j] * contact.lambda[j];
          }
        }
      }
      set.direction.push_back((*tool)[k]);
      set.free.push_back(free);
      double rate = -block.direction[k].dot(velocity);
      if (block.isClash()) {
        const Vec3 gone = state.hand[1 - hand].simulatedPosition - travels[1 - hand].before.position;
        rate += (*block.toolOf(1 - hand))[k].head<3>().dot(gone) / bodies.step();
      }
      set.rate.push_back(rate);
      set.lambda.push_back(contact.lambda[i]);
    }
  }
}

void ContactResponse::integrateTissue(Surfaces& surfaces, Bodies& bodies, const Activity& activity, State& state,
                                      StepLog& log) {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (!activity.awake[b]) continue;
    diverged_[b] = !bodies[b].advance(state);
    if (diverged_[b]) {
      log.miss(miss::solver);
      log.emit(EventKind::solverMiss, StepLog::noHand, bodies.firstStructure(b), Vec3::Zero(), 1e300);
    }
    if (const double speed = bodies[b].heldBack(); speed > 0.0) {
      log.miss(miss::speed);
      log.emit(EventKind::motionHeldBack, StepLog::noHand, bodies.firstStructure(b), Vec3::Zero(), speed);
    }
  }
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (activity.awake[b]) surfaces.markBodyStale(b);
  }
}

/// The instrument goes where the virtual coupling and the contact forces are in balance.
void ContactResponse::integrateInstrument(std::size_t hand, const InstrumentTravel& travel,
                                          const ContactSystem& contact, State& state, HandResult& result) const {
  HandState& s = state.hand[hand];
  const HandDescription& description = model_.scene().hands[hand];
  ToolRow push = ToolRow::Zero();
  for (const ContactBlock& block : contact.blocks) {
    const std::array<ToolRow, 3>* const tool = block.toolOf(hand);
    if (tool == nullptr) continue;
    for (std::size_t k = 0; k < block.rows(); ++k) push += contact.lambda[block.row + k] * (*tool)[k];
  }
  Vec3 way = travel.stretch.head<3>() + push.head<3>() / description.couplingStiffness;
  const double size = way.norm();
  if (size > maxSlide) way *= maxSlide / size;
  const double roll =
      std::clamp(travel.stretch[3] + push[3] / description.rollStiffness, -maxRollStretch, maxRollStretch);
  const Pose pose = movedTool(description.port, simulatedPose(s), way, roll);
  s.simulatedPosition = pose.position;
  s.simulatedOrientation = pose.orientation;
  result.contactForce = push.head<3>();
  result.contactTorque = push[3];
}

void ContactResponse::run(Surfaces& surfaces, Bodies& bodies, const Activity& activity,
                          const InstrumentTravels& travels, const ContactSystem& contact, State& state,
                          ContactSets& sets, StepResult& result, StepLog& log) {
  storeWarmStart(contact, state);
  storeDimples(model_, bodies.step(), contact, state);
  integrateTissue(surfaces, bodies, activity, state, log);
  for (std::size_t h = 0; h < handCount; ++h) integrateInstrument(h, travels[h], contact, state, result.hand[h]);
  for (std::size_t h = 0; h < handCount; ++h) {
    reduceToHand(bodies, state, travels, contact, h, result.step, sets[h]);
  }
  surfaces.refresh(state);
  for (std::size_t h = 0; h < handCount; ++h) resolver_.run(surfaces, h, state, result.contact);
}

}  // namespace calot
