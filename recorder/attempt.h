// SPDX-License-Identifier: GPL-3.0-or-later
// An attempt from a source: the loop around Session, at full speed or at the pace of the tick clock.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>

#include "recorder/identity.h"
#include "recorder/observer.h"
#include "recorder/session.h"
#include "recorder/sources/source.h"

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
  const std::atomic<bool>* stop = nullptr;  ///< asked between steps
  std::function<void(std::uint64_t step)> progress;  ///< called after every step
};

struct RunReport {
  Outcome outcome = Outcome::completed;
  std::uint64_t steps = 0;
  std::uint64_t lateTicks = 0;   ///< paced: ticks that began more than one tick length after their deadline
  double largestLateness = 0.0;  ///< s
  double stretched = 0.0;        ///< by how much the tick clock was stretched: lag beyond 100 ms (s)
  double wallSeconds = 0.0;
};

/// Runs the session from the source until it ends, the scene's time limit, `seconds`, or `stop`; then ends the session.
/// A step begins only when the source gave all its ticks; what is left of a last, unfinished step is dropped.
RunReport runAttempt(Session& session, SampleSource& source, const RunSettings& settings);

}  // namespace calot::recorder
