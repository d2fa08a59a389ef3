// SPDX-License-Identifier: GPL-3.0-or-later
// Re-simulates a recording and compares every digest, force, observable, event and keyframe.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "recorder/errors.h"
#include "recorder/observer.h"
#include "recorder/prepared_scene.h"
#include "recorder/recording/reader.h"
#include "recorder/session.h"
#include "recorder/step_misses.h"

namespace calot::recorder {

/// Where a replay first differs from its recording.
struct Divergence {
  std::uint64_t step = 0;
  std::optional<std::uint64_t> tick;  ///< of the attempt, where it is a tick's value
  std::string component;              ///< "hand.left", "organ.liver", "force", "observables", "events", "keyframe"
  std::string field;                  ///< "realPosition"; what of the component
  std::string detail;                 ///< index and both values where the recording holds them; or empty
  bool operator==(const Divergence&) const = default;
};

enum class ReplayVerdict : std::uint8_t {
  exact,
  diverged,
  damaged,
  undecided,
  consistent,  ///< a part was asked for, and it follows from the keyframe before it; the rest was not looked at
};

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
  StepMisses misses;  ///< of the steps that were computed again
  bool chainIntact = false;
  std::string chainFault;  ///< where the chain breaks, or empty
  std::optional<Divergence> divergence;
  std::optional<bool> reproducible;  ///< a second run differed at the same place in the same way
  std::string message;               ///< one line for people; does not name the recording
  std::vector<Remedy> remedies;      ///< of what stands in the way

  /// What kind of error a verdict other than exact is.
  [[nodiscard]] std::optional<ErrorKind> fault() const;
};

struct ReplaySettings {
  /// How many segments between keyframes are verified at a time; 0: one a processor. Where there is but one, threads of
  /// the simulation.
  unsigned threads = 1;
  /// Numbers of the first and last segment to be verified; none: all.
  std::optional<std::pair<std::size_t, std::size_t>> part;
  bool anyway = false;  ///< re-simulate a recording of another simulation version too
  /// Makes observers of the re-simulation once header and model are known. On one thread they see every step as it is
  /// computed. On several they see, in order, the recorded steps after all were proven equal to the computed ones, and
  /// none where they were not, with the forces as they were computed; there is no `keyframe`, no `view` and no digest
  /// of components then.
  std::function<std::vector<Observer*>(const AttemptHeader&, const Model&)> observers;
  std::function<void(std::uint64_t step, std::uint64_t of)> progress;
};

/// An error as the message of this recording's report, which names the recording itself. Another file that the error
/// lies in stays named.
std::string messageWithout(const std::filesystem::path& recording, const Error& error);

/// Judges one recording. Does not throw for the recording's faults: they are in the report.
ReplayReport replayRecording(const std::filesystem::path& path, const ReplaySettings& settings);

/// Does the session's next step as it was recorded: its samples, each with the contact sets that its tick names.
/// @throws std::out_of_range where a tick names a contact set that is not there.
void rerun(Session& session, const RecordedStep& recorded);

/// Re-simulates steps until the session has done `end` of them, or nothing more can be learned, and compares each with
/// the recording. @returns the first difference. @pre the session is at one of the recording's own States
std::optional<Divergence> follow(Recording& recording, Session& session, std::uint64_t end,
                                 const std::function<void(std::uint64_t step, std::uint64_t of)>& progress = {});

/// "diverged at step 13: hand.right realPosition (...)".
std::string describe(const Divergence& divergence);

/// Goes anywhere in a recording: the nearest keyframe at or before, then re-simulation. The State is the one that
/// running there gives, bit for bit.
class Seeker {
 public:
  /// @param recording, executor outlive the seeker.
  Seeker(Recording& recording, Executor& executor);

  /// Makes step n the last one done. @pre n < recording.stepCount() @throws Error (damaged) where a keyframe is no
  /// State of the scene's model, or a tick names a contact set that is not there.
  void seek(std::uint64_t step);

  [[nodiscard]] const Session& session() const { return *session_; }
  [[nodiscard]] const Model& model() const { return scene_->model(); }

 private:
  void advance();
  Recording& recording_;
  std::shared_ptr<PreparedScene> scene_;
  Executor& executor_;
  std::unique_ptr<Session> session_;
};

/// JUnit XML: one case a recording; diverged is a failure, damaged an error, undecided skipped, the divergence in the
/// body. @throws Error (failure) where the file cannot be written.
void writeJunit(const std::filesystem::path& file, const std::vector<ReplayReport>& reports);

}  // namespace calot::recorder
