// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "recorder/engine/observer.h"
#include "sim/scene/model.h"

namespace calot::recorder {

/// How many steps of a run missed a tolerance, and which (StepResult::misses): never silent.
struct StepMisses {
  std::uint64_t steps = 0;     ///< all that were added
  std::uint64_t any = 0;       ///< of them, with a miss of whatever kind
  std::uint64_t solver = 0;    ///< the linear solve of some body above its tolerance
  std::uint64_t contact = 0;   ///< the contact problem above its tolerance
  std::uint64_t heldBack = 0;  ///< tissue that would have moved faster than it can was held back

  void add(std::uint32_t misses);
  void add(const StepMisses& other);
  bool operator==(const StepMisses&) const = default;
};

/// "17 of 2000 steps missed a tolerance (solver 3, contact 14, held back 0)"; empty where none did.
std::string describe(const StepMisses& misses);

/// Watches a run: counts the steps that missed a tolerance, and notices the one after which nothing that is simulated
/// means anything.
class StepWatch final : public Observer {
 public:
  void onStep(const StepRecord& record) override;
  void onEnd(Outcome /*outcome*/) override {}

  [[nodiscard]] const StepMisses& misses() const { return misses_; }
  [[nodiscard]] bool ranAway() const { return ranAway_; }
  /// One line for people: which structure ran away, and when; or empty.
  [[nodiscard]] std::string fault(const Model& model) const;

 private:
  StepMisses misses_;
  bool ranAway_ = false;
  std::optional<Event> event_;
};

}  // namespace calot::recorder
