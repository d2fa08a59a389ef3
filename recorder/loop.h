// SPDX-License-Identifier: GPL-3.0-or-later
// The drivers of Session: an attempt from a source, at full speed or at the pace of the tick clock; an attempt that its
// caller advances; recorded motion in a scene that differs; and a branch, which is the parent's samples up to the fork,
// then another source: a whole recording of its own, from step 0.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "recorder/base/identity.h"
#include "recorder/engine/session.h"
#include "recorder/live/haptic_thread.h"
#include "recorder/prepared_scene.h"
#include "recorder/recording/reader.h"
#include "recorder/recording/writer.h"
#include "recorder/replay.h"
#include "recorder/sources/source.h"
#include "sim/math/executor.h"
#include "sim/scene/model.h"

namespace calot::recorder {

/// Random uuid (RFC 4122, version 4), lower case with hyphens.
std::string newUuid();

/// Header of a new attempt: a fresh uuid, the present time, this build.
AttemptHeader makeHeader(const Model& model, std::vector<Asset> assets, const Provenance& provenance,
                         const AttemptSettings& settings);

/// "calot 0.1.0".
std::string softwareName();
/// Compiler, build type and revision.
std::string buildName();

struct RunSettings {
  double seconds = 0.0;                     ///< of attempt time after which it is stopped; 0: until the source ends
  bool paced = false;                       ///< tick n runs no earlier than n ms after the start
  bool live = false;                        ///< paced, the haptic ticks on a thread of their own
  const std::atomic<bool>* stop = nullptr;  ///< asked between steps
  std::function<void(std::uint64_t step)> progress = {};  ///< called after every step
  /// Called with every tick's forces at once, by the thread that made them (live: the haptic thread): for devices with
  /// motors. Must neither wait nor throw.
  std::function<void(const TickOutcome&)> feedback = {};
};

/// Counts of ticks are those of this run's steps, as in the recording.
struct RunReport : HapticReport {
  std::uint64_t steps = 0;  ///< of the session
  double wallSeconds = 0.0;
  StepMisses misses;               ///< of this run's steps
  std::optional<Runaway> runaway;  ///< why the attempt had to end
  std::uint64_t arenasGrown = 0;   ///< live: contact sets that were larger than any before them
  std::uint64_t disagreements =
      0;  ///< live: ticks whose forces were not those that the simulation's side computed again: 0
};

/// Runs the session from the source until it ends or fails, the scene's time limit, `seconds`, or `stop`, or until a
/// step says that the simulation ran away (Outcome::technicalFailure, and `runaway` says where); then ends the
/// session. A step begins only when the source gave all its ticks; what is left of a last, unfinished step is dropped.
/// Where the session has steps already (a branch), the source begins with its tick 0 all the same.
///
/// Live, a haptic thread takes the source's samples and makes the forces at 1 kHz with the newest contact sets, and
/// this thread takes the ticks of one step after the other, computes their forces again as a replay will (which checks
/// that they are reproducible, and keeps the haptic states of the step for keyframes), and steps.
RunReport runAttempt(Session& session, SampleSource& source, const RunSettings& settings);

/// An attempt that its caller advances, one step a call: what runAttempt() is for sources, this is for controllers.
class StepwiseAttempt {
 public:
  /// @param assets the scene's, for the recording's header
  StepwiseAttempt(std::shared_ptr<PreparedScene> scene, std::vector<Asset> assets, std::uint64_t seed);
  /// An attempt that was not ended is left incomplete in its recording.
  ~StepwiseAttempt() = default;
  StepwiseAttempt(const StepwiseAttempt&) = delete;
  StepwiseAttempt& operator=(const StepwiseAttempt&) = delete;

  /// Observers see every step from the first one on. @param observer outlives the attempt @pre steps() == 0
  void join(Observer& observer) { session_.join(observer); }

  /// Records the attempt. @throws Error as controllerProvenance() and RecordingWriter; (invalid) after the first step,
  /// or where it is recorded already
  void record(const std::filesystem::path& target, const AttemptSettings& settings, const Provenance& provenance,
              WriterOptions options);

  /// Does the next step. @returns how it stands after it: running, timeLimit (the scene's), or technicalFailure where
  /// the simulation ran away
  /// @throws Error (invalid) as ControllerSamples::next(), or where the attempt is over; nothing is done then
  Outcome step(const HandCommands& wanted);

  /// Ends the attempt, and closes its recording. Once. @throws Error (failure) where the recording could not be written
  void end(Outcome outcome);

  [[nodiscard]] const Model& model() const { return session_.model(); }
  [[nodiscard]] std::uint64_t steps() const { return session_.steps(); }
  [[nodiscard]] Outcome outcome() const { return outcome_; }
  [[nodiscard]] bool ended() const { return ended_; }
  [[nodiscard]] bool recorded() const { return writer_ != nullptr; }
  [[nodiscard]] const HandCommands& hands() const { return hands_.hands(); }
  /// From the next step on the endoscope is here.
  void look(const CameraSample& camera) { hands_.look(camera); }
  [[nodiscard]] SceneView view() const { return session_.view(); }

 private:
  std::shared_ptr<PreparedScene> scene_;
  std::vector<Asset> assets_;
  std::uint64_t seed_;
  SerialExecutor executor_;
  mutable Session session_;  ///< its view() keeps what it drew with
  ControllerSamples hands_;
  StepWatch watch_;
  std::unique_ptr<RecordingWriter> writer_;
  std::vector<TickSamples> samples_;
  Outcome outcome_ = Outcome::running;
  bool ended_ = false;
};

class Recording;

/// An attempt's inputs, tick by tick.
struct AttemptInputs {
  std::vector<TickSamples> samples;
  std::vector<float> lateness;  ///< of each tick (s): a figure of time says by how much the clock was stretched
  Outcome outcome = Outcome::running;
  std::uint64_t seed = 0;
};

/// All of a recording's. @throws Error as Recording::step() does.
AttemptInputs inputsOf(Recording& recording);

/// Runs what a recording's hands did through a scene that differs from the one in which they did it: the motion stays,
/// the tissue is simulated again (open loop). Whole steps of the model's length; ticks that fill none at the
/// end are dropped. Each tick has the newest contact set: a live run, whose simulation may lag behind its haptic
/// thread, can have other forces on the hand. Then ends the observers with the recorded outcome.
void runOpenLoop(const Model& model, const AttemptInputs& inputs, std::span<Observer* const> observers,
                 Executor& executor);

/// Is this a recording that can be branched here? @throws Error: refused for one made in assessment mode; undecided (5)
/// for another simulation version. @pre its content chain is intact
void refuseParent(const Recording& parent);

/// The last step that a branch shares with its parent: the one that is over at `time`.
/// @param time of the parent's attempt (s) @throws Error (invalid) where that is not a number, before the end of the
/// first step, or beyond the recording's end.
std::uint64_t forkStepAt(const Recording& parent, double time);

/// Header of a branch: the parent's scene, seed and participant, the new source's provenance, practice.
AttemptHeader branchHeader(const Recording& parent, const Model& model, std::uint64_t forkStep,
                           const Provenance& provenance);

/// Re-simulates the parent's steps up to and with the fork step, with the contact sets and lateness that were logged,
/// so that forces and events are the same. Observers of the session receive each.
/// @returns the first difference from the parent's digests, forces, observables, events or keyframes, where it stops
/// @pre the session is new, with the parent's model and seed
[[nodiscard]] std::optional<Divergence> takeParent(Recording& parent, Session& session, std::uint64_t forkStep,
                                                   const StepProgress& progress = {});

}  // namespace calot::recorder
