// SPDX-License-Identifier: GPL-3.0-or-later
// Contact sets from the simulation to the haptic thread, and the memory that the haptic thread needs for them.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "recorder/base/newest.h"
#include "sim/haptics/haptic_tick.h"
#include "sim/scene/model.h"
#include "sim/scene/samples.h"

namespace calot::recorder {

using ContactSets = std::array<ContactSet, handCount>;
using HapticStates = std::array<HapticState, handCount>;
/// Capacity for each vector among the fields of a contact set or haptic state; vectors beyond maxVectors are not
/// tracked (they would grow in the haptic thread).
inline constexpr std::size_t maxVectors = 64;
using VectorSizes = std::array<std::size_t, maxVectors>;

/// Lock-free exchange of the newest contact sets of both hands. Sets are copied into slots whose memory is reused. When
/// a set is larger than any before, the simulation side prepares haptic states of sufficient capacity (by running a
/// tick on it) and publishes them as well; the haptic thread moves its state into them and so never allocates.
class ContactExchange {
 public:
  /// @param states, sets initial values of the haptic thread. @param model outlives the exchange.
  ContactExchange(const Model& model, const HapticStates& states, const ContactSets& sets);

  /// Simulation: publishes these sets. Allocates only if they grow (counted).
  void publish(const ContactSets& sets);
  /// Simulation: number of times a set was larger than any before.
  [[nodiscard]] std::uint64_t grown() const { return grown_; }

  /// Haptic thread: takes newer sets, if any, and capacity for them. Neither allocates nor locks.
  void refresh();
  [[nodiscard]] const ContactSets& sets() { return newest_.value().sets; }
  HapticStates& states() { return states_; }

 private:
  struct Slot {
    ContactSets sets;
    HapticStates room;
    std::uint64_t generation = 0;  // of the capacity
  };
  bool outgrown(const ContactSets& sets);
  void makeRoom(const ContactSets& sets);

  std::array<HapticModel, handCount> model_;
  Newest<Slot> newest_;
  HapticStates states_;        // the haptic thread's
  std::uint64_t adopted_ = 0;  // the haptic thread's: generation of its capacity
  std::atomic<std::uint64_t> seen_{0};

  // The simulation's: greatest size of each vector of a set so far, and haptic states of sufficient capacity.
  std::array<VectorSizes, handCount> most_{};
  HapticStates room_;
  std::uint64_t generation_ = 0, grown_ = 0;
};

}  // namespace calot::recorder
