// SPDX-License-Identifier: GPL-3.0-or-later
// Re-simulates a recording and compares every digest, force, observable, event and keyframe.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "recorder/base/errors.h"
#include "recorder/engine/engine.h"
#include "recorder/engine/fallen_clips.h"
#include "recorder/engine/observer.h"
#include "recorder/prepared_scene.h"
#include "recorder/recording/reader.h"
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

/// The simulation ran away (miss::runaway): an attempt ends there.
struct Runaway {
  std::uint64_t step = 0;
  std::string structure;
  double speed = 0.0;  ///< m/s
};

/// Watches a run: counts the steps that missed a tolerance, and notices the one after which nothing that is simulated
/// means anything.
class StepWatch final : public Observer {
 public:
  void onStep(const StepRecord& record) override;
  void onEnd(Outcome /*outcome*/) override {}

  [[nodiscard]] const StepMisses& misses() const { return misses_; }
  [[nodiscard]] bool ranAway() const { return ranAway_; }
  /// The structure that ran away first, if one did.
  [[nodiscard]] std::optional<Runaway> runaway(const Model& model) const;

 private:
  StepMisses misses_;
  bool ranAway_ = false;
  std::optional<Event> event_;
};

/// First difference between a replay and its recording.
struct Divergence {
  std::uint64_t step = 0;
  std::optional<std::uint64_t> tick;  ///< of the attempt, where it is a tick's value
  std::string component;  ///< "hand.left.input", "organ.liver", "force", "observables", "events", "keyframe"
  std::string field;      ///< "position"; what of the component
  std::string detail;     ///< index and both values where the recording holds them; or empty
  bool operator==(const Divergence&) const = default;
};

enum class ReplayVerdict : std::uint8_t {
  exact,
  diverged,
  damaged,
  undecided,
  consistent,  ///< a part was asked for, and it follows from the keyframe before it; the rest was not looked at
};

inline constexpr const char* wordFor(ReplayVerdict verdict) {
  constexpr std::array<const char*, 5> words{"bit-exact", "diverged", "damaged", "undecided", "consistent"};
  return words[static_cast<std::size_t>(verdict)];
}

/// How far a replay came.
enum class ReplayFinding : std::uint8_t {
  unread,       ///< `error` says why nothing was compared
  otherLayout,  ///< the recorded digests have other components than this build's State
  otherNames,   ///< `error` names the first structure, component or field that its scene calls otherwise
  compared,     ///< divergence and chain say the rest
};

/// A part of a recording that was verified: numbers of the first and last segment, and of their steps.
struct ReplayedPart {
  std::array<std::size_t, 2> segments{};
  std::array<std::uint64_t, 2> steps{};
};

/// Result of a replay, in fields; analytics/checkpoints/replay_words.h makes sentences of them.
struct ReplayReport {
  std::filesystem::path path;
  ReplayVerdict verdict = ReplayVerdict::damaged;
  std::string attempt;  ///< uuid, as far as it could be read
  bool complete = false;
  Outcome outcome = Outcome::running;
  std::uint64_t steps = 0;              ///< recorded
  double seconds = 0.0;                 ///< of simulated time
  double wallSeconds = 0.0;             ///< of the whole check
  std::uint32_t simulationVersion = 0;  ///< of the recording
  std::array<std::byte, 32> chainHead{};
  StepMisses misses;                           ///< of the steps that were computed again
  std::optional<ChainVerdict> chain;           ///< none: it was not read
  std::optional<RecordedSignature> signature;  ///< as recorded; it fits where the chain is intact
  std::optional<Divergence> divergence;
  std::optional<bool> reproducible;  ///< a second run differed at the same place in the same way
  std::optional<ReplayedPart> part;  ///< where it was asked for
  ReplayFinding finding = ReplayFinding::unread;
  std::string error;             ///< does not name the recording
  std::vector<Remedy> remedies;  ///< of what stands in the way

  [[nodiscard]] bool chainIntact() const { return chain && chain->intact(); }
  /// Kind of error of a verdict other than exact.
  [[nodiscard]] std::optional<ErrorKind> fault() const;
};

struct ReplaySettings {
  /// How many segments between keyframes are verified at a time; 0: one a processor. Where there is but one, threads of
  /// the simulation.
  unsigned threads = 1;
  /// Numbers of the first and last segment to be verified; none: all.
  std::optional<std::pair<std::size_t, std::size_t>> part;
  EngineRequest engine;
  /// Makes observers of the re-simulation once the header is known and an engine is there; not asked where the engine's
  /// results are of an earlier version of StepResult (the recorded ones serve as well, once they are proven). On one
  /// thread they see every step as it is computed. On several they see, in order, the recorded steps after all were
  /// proven equal to the computed ones, and none where they were not, with the forces as they were computed; there is
  /// no `keyframe`, no `view` and no digest of components then.
  std::function<std::vector<Observer*>(const AttemptHeader&, const SceneDescription&)> observers;
  StepProgress progress;
};

/// An error as the message of this recording's report, which names the recording itself. Another file that the error
/// lies in stays named.
std::string messageWithout(const std::filesystem::path& recording, const Error& error);

/// Judges one recording. Does not throw for the recording's faults: they are in the report.
ReplayReport replayRecording(const std::filesystem::path& path, const ReplaySettings& settings);

/// Re-simulates steps until the engine has done `end` of them, or nothing more can be learned, and compares each with
/// the recording. @param observers of each step, before it is compared @returns the first difference
/// @pre the engine is at one of the recording's own States
std::optional<Divergence> follow(Recording& recording, Engine& engine, std::uint64_t end,
                                 const std::vector<Observer*>& observers, const StepProgress& progress = {});

/// Goes anywhere in a recording: the nearest keyframe at or before, then re-simulation. The State is the one that
/// running there gives, bit for bit.
class Seeker {
 public:
  /// @param recording outlives the seeker. @param choice whose engine re-simulates
  Seeker(Recording& recording, const EngineChoice& choice);
  /// With the engine of the recording's version, inside where it is this program's own. @throws as EngineChoice
  explicit Seeker(Recording& recording) : Seeker(recording, EngineChoice(recording, {})) {}

  /// Makes step n the last one done. @pre n < recording.stepCount() @throws Error (damaged) where a keyframe is no
  /// State of the scene's model, or a tick names a contact set that is not there.
  void seek(std::uint64_t step);

  /// Steps done. @pre seek()
  [[nodiscard]] std::uint64_t steps() const { return engine_->steps(); }
  /// Scene view after that step, with the clips that fell; and the State as bytes.
  [[nodiscard]] SceneView view();
  [[nodiscard]] Keyframe keyframe() { return engine_->keyframe(); }
  /// First step since the keyframe that it began at whose State has another digest than the recorded one: from there on
  /// another attempt is shown. Keyframes themselves are the content chain's concern.
  [[nodiscard]] const std::optional<std::uint64_t>& differsFrom() const { return differs_; }

 private:
  void advance();
  [[nodiscard]] bool isAsRecorded(const RecordedStep& recorded, const EngineStep& step);
  Recording& recording_;
  EngineChoice choice_;  ///< its scene lives as long as the engine
  SerialExecutor executor_;
  std::unique_ptr<Engine> engine_;
  bool begun_ = false;
  BriefDigest brief_;
  std::optional<std::uint64_t> differs_;
  std::optional<FallenClips> fallen_;  ///< none: not read yet
};

}  // namespace calot::recorder
