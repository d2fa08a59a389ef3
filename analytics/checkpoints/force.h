// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "analytics/checkpoints/phases.h"
#include "recorder/engine/observer.h"
#include "sim/scene/samples.h"

namespace calot::analytics {

/// Below this a force counts as none (N): an operator can't feel it, and no device sends it.
inline constexpr double leastForce = 0.01;

/// Magnitudes of the forces that the haptic ticks sent to one hand, tick by tick.
struct HandForces {
  bool mounted = false;       ///< there was an instrument at any tick
  double largest = 0.0;       ///< of all (N), felt or not
  double sum = 0.0;           ///< of all (N)
  std::vector<double> felt;   ///< those of at least leastForce (N), in the order of ticks
  std::vector<double> rates;  ///< |f(t+1) - f(t-1)| / (2 ticks) of each tick with a force of at least leastForce and an
                              ///< instrument at all three (N/s), in the order of ticks
};

class ForceTrack {
 public:
  /// @param tickSeconds length of a tick (s).
  explicit ForceTrack(double tickSeconds) : tickSeconds_(tickSeconds) {}

  void add(const recorder::StepRecord& record);
  /// Marks a discontinuity: no rate of change is taken across.
  void interrupt();
  [[nodiscard]] const HandForces& of(std::size_t hand) const { return hand_[hand]; }
  [[nodiscard]] double tickSeconds() const { return tickSeconds_; }

 private:
  /// Forces of the two newest ticks in a row with an instrument, the newer one last.
  struct Newest {
    std::array<Vec3, 2> force{Vec3::Zero(), Vec3::Zero()};
    int ticks = 0;
  };
  double tickSeconds_;
  std::array<Newest, handCount> newest_{};
  std::array<HandForces, handCount> hand_{};
};

/// The same of each phase of a procedure by itself.
class PhaseForceTrack {
 public:
  /// @param tickSeconds length of a tick (s).
  explicit PhaseForceTrack(double tickSeconds) : track_(windowPhases.size(), ForceTrack(tickSeconds)) {}

  /// @param phase of the step
  void add(const recorder::StepRecord& record, Phase phase);
  /// @param window which of windowPhases.
  [[nodiscard]] const ForceTrack& of(std::size_t window) const { return track_[window]; }

 private:
  std::vector<ForceTrack> track_;
  Phase phase_ = Phase::none;
};

}  // namespace calot::analytics
