// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/contact_detection.h"

#include <algorithm>
#include <cmath>

#include "sim/step/contact_dimples.h"
#include "sim/step/instrument_motion.h"
#include "sim/step/pressed_patch.h"
#include "sim/step/sleeping.h"

namespace calot {

namespace {

/// A contact block's key has its structure in the bits from here up to the four of the instrument's part.
constexpr unsigned structureShift = 52;
static_assert(maxStructures <= std::size_t{1} << (56U - structureShift));

}  // namespace

void ContactDetection::addInstrumentBlock(const Surfaces& surfaces, const State& state, std::size_t hand,
                                          std::size_t structure, const SurfaceContact& contact,
                                          std::vector<ContactBlock>& blocks) const {
  const StructureModel& touched = model_.structures()[structure];
  const Pose tool = simulatedPose(state.hand[hand]);
  ContactBlock block;
  block.kind = touched.friction > 0.0 ? BlockKind::frictional : BlockKind::unilateral;
  block.limit = touched.friction;
  block.hand = hand;
  block.body = touched.body;
  block.structure = structure;
  block.place = surfaces.skin(structure).influence(contact.node, contact.weight);
  block.key = contact.key | static_cast<std::uint64_t>(structure) << structureShift;
  // Slip along and across the shaft, as far as the surface allows.
  const Mat3 frame = alongAxis(contact.normal, tool.orientation.toRotationMatrix().col(2)).toRotationMatrix();
  block.direction = {contact.normal, frame.col(0), frame.col(1)};
  block.gap = {contact.gap, 0.0, 0.0};
  const Vec3 onAxis = contact.onAxis - dimpleOf(state.hand[hand], structure, contact.key >> 56U);
  for (std::size_t k = 0; k < block.rows(); ++k) {
    block.tool[k] = toolRow(model_.scene().hands[hand].port, tool, onAxis, block.direction[k]);
  }
  if (touched.kind == tissueId<OrganTissue> && model_.scene().solver.dimples) {
    const OrganModel& organ = model_.organs()[touched.index];
    const std::vector<Vec3>& points = surfaces.points(structure);
    block.piece = contact.key >> 56U;
    block.radius = instrument_[hand].capsule[block.piece].radius;
    for (std::size_t k = 0; k < 3; ++k) {
      block.foot += contact.weight[static_cast<int>(k)] * points[static_cast<std::size_t>(contact.node[k])];
    }
    block.smooth = smoothNormal(organ.surface, points, contact.node, contact.weight);
    if (block.smooth.isZero()) block.smooth = contact.normal;
    const SolidSolver::Impulse centre = block.place;
    block.place = pressedPatch(organ, surfaces.skin(structure), contact.node, contact.weight, block.radius);
    block.spread = meshSpread(organ, centre, block.place);
  }
  blocks.push_back(block);
}

void ContactDetection::findInstrumentContacts(Surfaces& surfaces, const Bodies& bodies,
                                              const InstrumentTravels& travels, const State& state,
                                              std::vector<ContactBlock>& blocks) {
  for (std::size_t h = 0; h < handCount; ++h) {
    const HandState& hand = state.hand[h];
    instrument_[h].place(model_.scene().hands[h], hand.instrument, simulatedPose(hand), hand.jaw);
    for (std::size_t s = 0; s < surfaces.size(); ++s) {
      double speed = 0.0;
      for (const Vec3& v : bodies[model_.structures()[s].body].velocity(state))
        speed = std::max(speed, v.squaredNorm());
      const double far = travels[h].reach + std::min(std::sqrt(speed) * bodies.step(), maxSlide);
      found_.clear();
      for (const Capsule& c : instrument_[h].capsule) {
        const double allowed = allowedDepth(model_, state, h, c, s);
        const std::size_t before = found_.size();
        // Where its dimple is, the skin has given way: the capsule meets the mesh as much farther out.
        const Vec3 dimple = dimpleOf(hand, s, c.piece);
        const Vec3 p0 = c.p0 + dimple;
        const Vec3 p1 = c.p1 + dimple;
        const std::span<const std::uint32_t> near = surfaces.patchesNear(s, p0, p1, capsuleSearch(c.radius, far));
        capsuleContacts(surfaces.mesh(s), surfaces.points(s), near, p0, p1, c.radius, far, c.piece, found_);
        if (allowed > 0.0) allowDepth(allowed, far, before, found_);
      }
      for (const SurfaceContact& contact : found_) addInstrumentBlock(surfaces, state, h, s, contact, blocks);
    }
  }
}

/// An instrument on the other: the left one is pushed along the normal, the right one against it.
void ContactDetection::findClashes(const InstrumentTravels& travels, std::vector<ContactBlock>& blocks) {
  clashPoints(instrument_[0], instrument_[1], travels[0].reach + travels[1].reach, clash_);
  for (const ClashPoint& point : clash_) {
    ContactBlock block;
    block.kind = BlockKind::frictional;
    block.limit = instrumentFriction;
    block.hand = 0;
    block.otherHand = 1;
    block.where = 0.5 * (point.onA + point.onB);
    block.key = point.key;
    const Mat3 frame =
        alongAxis(point.normal, instrument_[0].pose.orientation.toRotationMatrix().col(2)).toRotationMatrix();
    block.direction = {point.normal, frame.col(0), frame.col(1)};
    block.gap = {point.gap, 0.0, 0.0};
    for (std::size_t k = 0; k < block.rows(); ++k) {
      block.tool[k] = toolRow(instrument_[0].port, instrument_[0].pose, point.onA, block.direction[k]);
      block.otherTool[k] = -toolRow(instrument_[1].port, instrument_[1].pose, point.onB, block.direction[k]);
    }
    blocks.push_back(block);
  }
}

void ContactDetection::run(Surfaces& surfaces, Bodies& bodies, const InstrumentTravels& travels, State& state,
                           Activity& activity, ContactSystem& contact, ContactResult& result) {
  contact.blocks.clear();
  findInstrumentContacts(surfaces, bodies, travels, state, contact.blocks);
  grasping_.addBlocks(surfaces, state, contact.blocks);
  findClashes(travels, contact.blocks);
  wakeBodies(model_, bodies, travels, contact.blocks, state, activity);
  result.tissueDepth = tissue_.run(surfaces, state, activity.awake, contact.blocks);
  travel_.follow(surfaces, bodies, state, activity.awake);
  result.tissueDepth = std::max(result.tissueDepth,
                                vessels_.run(surfaces, travel_, state, bodies.step(), activity.awake, contact.blocks));
  result.tissueDepth =
      std::max(result.tissueDepth, fat_.run(surfaces, bodies, travel_, state, activity.awake, contact.blocks));
  // What sleeps on both sides needs no force.
  std::erase_if(contact.blocks, [&](const ContactBlock& block) {
    if (block.isClash()) return false;
    return !activity.awake[block.body] && (block.other == ContactBlock::none || !activity.awake[block.other]);
  });
}

}  // namespace calot
