// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/warm_start.h"

#include <algorithm>

namespace calot {

namespace {

/// The last step's force at a block's contact point (N); zero where there was none.
Vec3 lastForce(const State& state, const ContactBlock& block) {
  Vec3 force = Vec3::Zero();
  if (block.isTissueOnTissue()) {
    const std::vector<std::uint64_t>& keys = state.tissue.key;
    const auto found = std::lower_bound(keys.begin(), keys.end(), block.key);
    if (found != keys.end() && *found == block.key) {
      force = state.tissue.force[static_cast<std::size_t>(found - keys.begin())] * block.direction[0];
    }
  } else if (block.isGrasp()) {
    force = state.hand[block.hand].graspForce[block.anchor];
  } else {
    const HandState& hand = state.hand[block.hand];
    for (std::size_t k = 0; k < hand.contactKey.size(); ++k) {
      if (hand.contactKey[k] == block.key) force = hand.contactForce[k];
    }
  }
  return force;
}

}  // namespace

void loadWarmStart(const State& state, ContactSystem& contact) {
  contact.numberRows();
  contact.carried.clear();
  for (const ContactBlock& block : contact.blocks) {
    const Vec3 force = lastForce(state, block);
    for (std::size_t k = 0; k < block.rows(); ++k) contact.carried.push_back(force.dot(block.direction[k]));
    projectOntoFrictionCone(block.kind, block.limit, std::span(contact.carried).subspan(block.row, block.rows()));
  }
  contact.lambda = contact.carried;
}

void storeWarmStart(const ContactSystem& contact, State& state) {
  for (HandState& hand : state.hand) {
    hand.contactKey.clear();
    hand.contactForce.clear();
  }
  state.tissue.key.clear();
  state.tissue.force.clear();
  for (const ContactBlock& block : contact.blocks) {
    Vec3 force = Vec3::Zero();
    for (std::size_t k = 0; k < block.rows(); ++k) force += contact.lambda[block.row + k] * block.direction[k];
    if (block.isTissueOnTissue()) {
      state.tissue.key.push_back(block.key);
      state.tissue.force.push_back(contact.lambda[block.row]);
    } else if (block.isGrasp()) {
      state.hand[block.hand].graspForce[block.anchor] = force;
    } else {
      state.hand[block.hand].contactKey.push_back(block.key);
      state.hand[block.hand].contactForce.push_back(force);
    }
  }
}

}  // namespace calot
