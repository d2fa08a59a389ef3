// SPDX-License-Identifier: GPL-3.0-or-later
// The engine that decides a recording: the simulation of one version, on one attempt. Replay, assessment, seeking and
// drawing all go through this, whether the simulation is this program's own (LocalEngine) or another program's
// (recorder/kept/kept_engine.h, schemas/engine.md).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "recorder/engine/observer.h"
#include "sim/judgement/judge.h"
#include "sim/scene/model.h"
#include "sim/scene/scene_view.h"
#include "sim/scene/step_result.h"

namespace calot::recorder {

/// /observables/procedure of recordings in version 3 of StepResult, in which the simulation judged the procedure.
struct RecordedProcedure {
  Phase phase = Phase::none;
  std::uint8_t triangleCleared = 0, lowerThirdFreed = 0, twoStructures = 0;
  bool criticalViewFrozen = false;
  double lowerThirdAttached = 0.0;
  std::uint32_t errors = 0, criticalErrors = 0;
  bool operator==(const RecordedProcedure&) const = default;
};

/// Confinement of an engine program. Numbers are those of schemas/engine.md.
enum class Confinement : std::uint8_t {
  none = 0,
  own = 1,     ///< everything but reading, writing, computing and ending
  byHost = 2,  ///< what runs it gives it nothing else
};

struct EngineIdentity {
  std::uint32_t simulationVersion = 0;
  std::uint32_t stepResultVersion = 0;
  std::string software;  ///< program and version
  Confinement confinement = Confinement::none;
};

/// One step's inputs, as a recording has them.
struct StepInput {
  std::span<const TickSamples> samples;  ///< ticksPerStep of them
  std::span<const TickOutcome> logged;   ///< as many: which contact sets the ticks use, and how late they ran
  float lateness = 0.0F;
};

/// Result of a step. Valid until the engine's next call.
struct EngineStep {
  std::uint64_t step = 0;
  std::span<const TickOutcome> ticks;
  const StepResult& result;
  const StateDigest& digest;
  const RecordedProcedure* procedure = nullptr;  ///< of version 3 of StepResult alone, where the scene has one
};

/// Contact sets that both hands' last ticks named.
using NamedSets = std::array<std::int64_t, handCount>;

/// The first field in which two keyframes differ.
struct KeyframeDifference {
  std::string field;   ///< "organ.liver/position"; "state", "haptics" where no field can be named
  std::string detail;  ///< index and both values; or empty
};

class Engine {
 public:
  Engine() = default;
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;
  virtual ~Engine() = default;

  [[nodiscard]] virtual const DigestLayout& layout() const = 0;
  virtual void start(std::uint64_t seed) = 0;
  /// Goes on from a keyframe. @param named by the last ticks before it; none: not known
  /// @returns false, leaving all as it was, where it is no State of the scene
  [[nodiscard]] virtual bool restore(const Keyframe& keyframe, const std::optional<NamedSets>& named) = 0;
  /// Steps done; the next step's number.
  [[nodiscard]] virtual std::uint64_t steps() const = 0;
  /// Does the next step. @pre start() or restore()
  /// @throws std::out_of_range where a tick names a contact set that is not there
  virtual EngineStep step(const StepInput& input) = 0;
  /// How many steps it takes the inputs of ahead of time; 0: none.
  [[nodiscard]] virtual std::size_t takesAhead() const { return 0; }
  /// Inputs of a step to come, in order, which step() is given once more: an engine that is another program has them
  /// before it asks. Until these steps are done nothing but step() may be called, if not to drop them.
  /// @pre fewer than takesAhead() are ahead
  virtual void announce(const StepInput& /*input*/) {}
  /// Digest of the last step. @pre steps() > 0
  [[nodiscard]] virtual Keyframe keyframe() = 0;
  [[nodiscard]] virtual SceneView view() = 0;
  /// How a keyframe differs from the engine's own after the last step.
  [[nodiscard]] virtual std::optional<KeyframeDifference> explain(const Keyframe& recorded) = 0;
};

}  // namespace calot::recorder
