// SPDX-License-Identifier: GPL-3.0-or-later
// Comparison of re-simulated steps with recorded ones, bit for bit, and in parallel over time. A keyframe holds all
// that later steps depend on, so the stretches between keyframes can be re-simulated at the same time: each from the
// keyframe before it, and to the one at its end, which has to come out byte for byte. That the recording is what a run
// from its start gives follows by induction (docs/explanation/determinism.md, "In segments").
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "recorder/engine/engine.h"
#include "recorder/engine/observer.h"
#include "recorder/prepared_scene.h"
#include "recorder/recorded_results.h"
#include "recorder/recording/layout.h"
#include "recorder/recording/reader.h"
#include "recorder/replay.h"

namespace calot::recorder {

/// Compares the observables and events of one step after the other, in the recording's version of them. Names of fields
/// are those of schemas/observables.md: "left/tip_real[2]"; the index is that of the column, of an event's field that
/// of the event comes first.
class ResultComparison {
 public:
  explicit ResultComparison(const AttemptHeader& header);

  /// The first difference, bit for bit. Makes no strings and, after the first steps, no memory, where there is none.
  std::optional<Divergence> operator()(const StepResult& recorded, const StepResult& here);

 private:
  using Rows = std::vector<std::vector<std::byte>>;
  void keep(const StepResult& result, Rows& rows) const;

  Layout layout_;
  Rows recorded_, here_;  ///< one row of the layout's columns
};

/// The first difference of the judgement that version 3 of StepResult held.
std::optional<Divergence> compareProcedure(std::uint64_t step, const RecordedProcedure& recorded,
                                           const RecordedProcedure& here);

/// Compares every step of an engine that re-simulates a recording: forces, digests, observables and events; where there
/// is a keyframe, State, haptic states and contact sets byte for byte.
class StepComparison {
 public:
  /// @param recording, engine outlive it.
  StepComparison(Recording& recording, Engine& engine);

  /// @pre it is the engine's newest
  void compare(const EngineStep& step);

  [[nodiscard]] const std::optional<Divergence>& first() const { return first_; }
  /// Nothing more can be learned by going on.
  [[nodiscard]] bool done() const { return first_ && resolved_; }
  /// The recording itself cannot be followed any further.
  void fail(Divergence divergence);

 private:
  std::optional<std::size_t> keyframeAt(std::uint64_t step);
  std::optional<Divergence> compareDigests(const RecordedStep& recorded, const EngineStep& step);
  std::optional<Divergence> compareKeyframe(std::size_t index);
  void resolveAtKeyframe(const EngineStep& step);

  Recording& recording_;
  Engine& engine_;
  ResultComparison compareResult_;
  bool minimal_;      ///< no forces, no keyframes
  bool exactForces_;  ///< format version 1: forces as they were, digests of components
  BriefDigest brief_;
  std::optional<Divergence> first_;
  bool resolved_ = false;
};

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
                               const StepProgress& progress = {}, std::vector<TickForces>* forces = nullptr);

}  // namespace calot::recorder
