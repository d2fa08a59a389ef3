// SPDX-License-Identifier: GPL-3.0-or-later
// An attempt from a source: the loop around Session, at full speed or at the pace of the tick clock.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>

#include "recorder/base/identity.h"
#include "recorder/engine/observer.h"
#include "recorder/engine/session.h"
#include "recorder/sources/source.h"
#include "recorder/step_misses.h"

namespace calot::recorder {

/// What the caller knows of an attempt that the source and the scene do not.
struct AttemptSettings {
  std::string participant;
  std::string station;
  std::string purpose = "training";
  std::string handedness = "unknown";
  Mode mode = Mode::practice;
  std::uint64_t seed = 0;
};

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
  std::function<void(std::uint64_t step)> progress;  ///< called after every step
  /// Called with every tick's forces at once, by the thread that made them (live: the haptic thread): for devices with
  /// motors. Must neither wait nor throw.
  std::function<void(const TickOutcome&)> feedback;
};

struct RunReport {
  Outcome outcome = Outcome::completed;
  std::uint64_t steps = 0;  ///< of the session
  std::uint64_t ticks = 0;  ///< of this run's steps; what follows counts these, as the recording does
  std::uint64_t missedDeadlines =
      0;                     ///< paced: ticks whose force was ready later than tickDeadline after they were due
  double maxLateness = 0.0;  ///< of a tick (s)
  double stretched = 0.0;    ///< by how much the tick clock was stretched: lag beyond maxLag (s)
  std::uint64_t pauses = 0;  ///< of the source
  double paused = 0.0;       ///< s
  double wallSeconds = 0.0;
  StepMisses misses;  ///< of this run's steps
  std::string fault;  ///< why the attempt had to end, in one line: the simulation ran away (miss::runaway); or empty
  // Live:
  bool realTime = false;            ///< the haptic thread ran before all ordinary threads
  double tickMean = 0.0;            ///< thread CPU time of a tick (both hands; s)
  double tickP999 = 0.0;            ///< what 99.9 % of the ticks did not exceed (s)
  double tickLargest = 0.0;         ///< s
  std::uint64_t arenasGrown = 0;    ///< contact sets that were larger than any before them
  std::uint64_t disagreements = 0;  ///< ticks whose forces were not those that the simulation's side computed again: 0
};

/// Runs the session from the source until it ends or fails, the scene's time limit, `seconds`, or `stop`, or until a
/// step says that the simulation ran away (Outcome::technicalFailure, and `fault` says where); then ends the
/// session. A step begins only when the source gave all its ticks; what is left of a last, unfinished step is dropped.
/// Where the session has steps already (a branch), the source begins with its tick 0 all the same.
///
/// Live, a haptic thread takes the source's samples and makes the forces at 1 kHz with the newest contact sets, and
/// this thread takes the ticks of one step after the other, computes their forces again as a replay will (which is the
/// check that they can be had again, and keeps the haptic states of the step for keyframes), and steps.
RunReport runAttempt(Session& session, SampleSource& source, const RunSettings& settings);

}  // namespace calot::recorder
