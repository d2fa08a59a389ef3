// SPDX-License-Identifier: GPL-3.0-or-later
// The table of checkpoints, by theme: each function returns the rows of its file, in any order. The registry sorts and
// completes them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/checkpoints/phases.h"

namespace calot::analytics {

std::vector<CheckpointEntry> attemptRows();     ///< durations, exactness of the simulation
std::vector<CheckpointEntry> motionRows();      ///< of each hand and of both
std::vector<CheckpointEntry> smoothnessRows();  ///< of each hand
std::vector<CheckpointEntry> cameraRows();      ///< the endoscope, and what was done out of its sight
std::vector<CheckpointEntry> forceRows();       ///< on hands and structures
std::vector<CheckpointEntry> contactRows();     ///< times that instruments touch structures or each other
std::vector<CheckpointEntry> dissectionRows();  ///< fat, bed and burns
std::vector<CheckpointEntry> safetyRows();      ///< clips, cautery in the air, injuries, critical view

/// Precondition on the scene for a figure.
inline constexpr Requirement hasProcedure{[](const AttemptContext& context) { return context.procedure; },
                                          "the scene has no procedure"};
inline constexpr Requirement hasVessels{[](const AttemptContext& context) { return !context.scene.vessel.empty(); },
                                        "the scene has no vessels"};
inline constexpr Requirement hasCystic{[](const AttemptContext& context) { return context.scene.hasCystic(); },
                                       "the scene has no duct or artery that enters a gallbladder"};
inline constexpr Requirement hasSpared{[](const AttemptContext& context) { return context.scene.hasSpared(); },
                                       "the scene's procedure names no vessel to be spared"};
inline constexpr Requirement hasFat{[](const AttemptContext& context) { return context.scene.fat > 0; },
                                    "the scene has no fat"};
inline constexpr Requirement hasTriangle{[](const AttemptContext& context) { return context.scene.triangle; },
                                         "the scene marks no region to be cleared"};

/// Names of the scene's organs, without vessels and fat.
inline std::vector<std::string> organNames(const AttemptContext& context) {
  std::vector<std::string> names;
  for (const SceneFacts::Organ& organ : context.scene.organ) names.push_back(organ.name);
  return names;
}

/// An accumulator A of each phase, which takes the steps of its phase alone, in windowPhases' order; A by hands, if so.
template <class A>
struct PerPhase {
  std::vector<A> window;
  Phase phase = Phase::none;

  template <class... Arguments>
  explicit PerPhase(const AttemptContext& context, Arguments... arguments)
      : window(windowPhases.size(), A{context, arguments...}) {}

  void add(const recorder::StepRecord& record, const Judgement& judgement) {
    if constexpr (requires(A & a) { a.leavePhase(); }) {
      if (judgement.phase != phase) {
        for (A& a : window) a.leavePhase();
      }
    }
    phase = judgement.phase;
    const std::size_t w = windowOf(phase);
    if (w < window.size()) window[w].add(record.result);
  }
  [[nodiscard]] Measured figure(const AttemptEnd& end, std::size_t subject) const {
    if constexpr (requires { window[0].figure(end, subject); }) {
      return window[subject / handCount].figure(end, subject % handCount);
    } else {
      return window[subject].figure(end);
    }
  }
};

/// The row of a figure in each phase of the procedure: declared as phaseDefinition() of the whole attempt's says, and
/// with its requirements. @param rank among the figures of phases @param version without the judgement's
CheckpointEntry phaseRow(const CheckpointEntry& whole, int rank, const char* pieces, AccumulatorMaker accumulate,
                         std::uint32_t version = 1);

}  // namespace calot::analytics
