// SPDX-License-Identifier: GPL-3.0-or-later
// Contact sets from the simulation to the haptic thread, and the memory that the haptic thread needs for them.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "recorder/live/newest.h"
#include "sim/haptics/haptic_tick.h"
#include "sim/scene/model.h"
#include "sim/scene/samples.h"

namespace calot::recorder {

using ContactSets = std::array<ContactSet, handCount>;
using HapticStates = std::array<HapticState, handCount>;
/// A number for each vector among the fields of a contact set or haptic state; more than mostVectors of them are not
/// looked after (they would grow in the haptic thread).
inline constexpr std::size_t mostVectors = 64;
using VectorSizes = std::array<std::size_t, mostVectors>;

/// The newest contact sets of both hands, handed over without a lock. Sets are copied into slots that keep their
/// memory. Where a set is larger than any before it, the simulation's side makes haptic states with room for it (by
/// running a tick on it) and sends them along: the haptic thread moves into them, and so never allocates.
class ContactExchange {
 public:
  /// @param states, sets what the haptic thread begins with. @param model outlives the exchange.
  ContactExchange(const Model& model, const HapticStates& states, const ContactSets& sets);

  /// Simulation: makes these the newest sets. Allocates only where they grow (counted).
  void publish(const ContactSets& sets);
  /// Simulation: how often a set was larger than any before it.
  [[nodiscard]] std::uint64_t grown() const { return grown_; }

  /// Haptic thread: takes the newest sets, if there are newer ones, with room for them. Neither allocates nor locks.
  void refresh();
  [[nodiscard]] const ContactSets& sets() { return newest_.value().sets; }
  HapticStates& states() { return states_; }

 private:
  struct Slot {
    ContactSets sets;
    HapticStates room;
    std::uint64_t generation = 0;  // of the room
  };
  bool outgrown(const ContactSets& sets);
  void makeRoom(const ContactSets& sets);

  std::array<HapticModel, handCount> model_;
  Newest<Slot> newest_;
  HapticStates states_;        // the haptic thread's
  std::uint64_t adopted_ = 0;  // the haptic thread's: generation of its room
  std::atomic<std::uint64_t> seen_{0};

  // The simulation's: most elements of each vector of a set so far, and room that is enough for all of them.
  std::array<VectorSizes, handCount> most_{};
  HapticStates room_;
  std::uint64_t generation_ = 0, grown_ = 0;
};

}  // namespace calot::recorder
