// SPDX-License-Identifier: GPL-3.0-or-later
// Verification in parallel over time. A keyframe holds all that later steps depend on, so the stretches between
// keyframes can be re-simulated at the same time: each from the keyframe before it, and to the one at its end, which
// has to come out byte for byte. That the recording is what a run from its start gives follows by induction
// (docs/explanation/determinism.md, "In segments").
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "recorder/engine/observer.h"
#include "recorder/prepared_scene.h"
#include "recorder/recorded_results.h"
#include "recorder/recording/reader.h"
#include "recorder/replay.h"

namespace calot::recorder {

/// Steps [first, end). The first segment starts from scene and seed, each other one from the keyframe of step first -
/// 1; all but the last end with a keyframe.
struct Segment {
  std::uint64_t first = 0, end = 0;
  std::optional<std::size_t> keyframe;  ///< that it starts from
  bool operator==(const Segment&) const = default;
};

/// All steps of a recording, in order, without gap or overlap.
std::vector<Segment> segmentsOf(const Recording& recording);

/// Result of re-simulating and comparing a recording's segments.
struct SegmentsVerdict {
  std::optional<Divergence> divergence;  ///< the first, as a run from the start would find it
  std::optional<bool> reproducible;      ///< its segment, run once more, differed in the same way
  StepMisses misses;                     ///< of the steps up to there
};

/// Verifies each of the segments, up to `threads` at a time, each on one thread with a reader and an engine of its own.
/// @param progress steps done, of all; called on this thread
/// @param forces takes those of every step that was done, by the number of the tick; as many as the recording's ticks,
/// or null
/// @throws what reading the recording throws, where no segment before differs; std::invalid_argument on no segments
SegmentsVerdict verifySegments(const std::filesystem::path& recording, const EngineChoice& choice,
                               const std::vector<Segment>& segments, unsigned threads,
                               const std::function<void(std::uint64_t step, std::uint64_t of)>& progress = {},
                               std::vector<TickForces>* forces = nullptr);

}  // namespace calot::recorder
