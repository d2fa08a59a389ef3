// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/checkpoints/motion.h"
#include "sim/judgement/judge.h"

namespace calot::analytics {

/// The phases of a procedure that are windows of checkpoints, in its order.
inline constexpr std::array<Phase, 4> windowPhases{Phase::identification, Phase::clipping, Phase::cutting,
                                                   Phase::dissection};
const char* nameOf(Phase phase);  ///< "identification", ...
/// Index in windowPhases; windowPhases.size() if none.
std::size_t windowOf(Phase phase);
/// The declaration of a figure of the whole attempt in each of its phases: "phase-NAME", of hands or the attempt as it
/// was. Where a phase begins and ends is the simulation's to say, so its origin is that of the steps.
/// @param pieces what the figure counts: "points", "ticks", "steps". @param version its own, without the judgement's
/// @pre whole.window begins with "whole attempt"
CheckpointDefinition phaseDefinition(const CheckpointDefinition& whole, const char* pieces, std::uint32_t version = 1);
/// "left clipping"
std::string handAndPhase(std::size_t hand, Phase phase);
/// Reason why a phase without steps has no figure.
inline constexpr const char* noSuchPhase = "the attempt has no such phase";

/// One phase of an attempt, as often as it recurred.
struct PhaseMotion {
  Phase phase = Phase::none;
  double seconds = 0.0;                  ///< how long it lasted
  std::array<Motion, handCount> motion;  ///< of each hand within it: filtered before it was cut out
};

/// When the procedure was in which phase.
class PhaseTrack {
 public:
  /// @param ticks of the step.
  void add(Phase phase, std::uint64_t ticks);
  /// Cuts both hands' motion into phases: a point belongs to the phase of the step that its time lies in. Pieces of a
  /// recurring phase are segments of their own; what is counted between two points is not counted across their ends.
  [[nodiscard]] std::vector<PhaseMotion> cut(const std::array<Motion, handCount>& motion, double tickSeconds) const;

 private:
  struct Span {
    Phase phase = Phase::none;
    std::uint64_t begin = 0, end = 0;  ///< ticks [begin, end)
  };
  std::vector<Span> spans_;
};

}  // namespace calot::analytics
