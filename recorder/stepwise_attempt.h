// SPDX-License-Identifier: GPL-3.0-or-later
// An attempt that its caller advances, one step a call: what runAttempt() is for sources, this is for controllers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "recorder/attempt.h"
#include "recorder/engine/session.h"
#include "recorder/prepared_scene.h"
#include "recorder/recording/writer.h"
#include "recorder/sources/controller.h"
#include "sim/math/executor.h"

namespace calot::recorder {

class StepwiseAttempt {
 public:
  /// @param assets the scene's, for the recording's header
  StepwiseAttempt(std::shared_ptr<PreparedScene> scene, std::vector<Asset> assets, std::uint64_t seed);
  /// An attempt that was not ended is left incomplete in its recording.
  ~StepwiseAttempt();
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
  class RunawayWatch;
  std::shared_ptr<PreparedScene> scene_;
  std::vector<Asset> assets_;
  std::uint64_t seed_;
  SerialExecutor executor_;
  Session session_;
  ControllerSamples hands_;
  std::unique_ptr<RunawayWatch> watch_;
  std::unique_ptr<RecordingWriter> writer_;
  std::vector<TickSamples> samples_;
  std::vector<TickOutcome> ticks_;
  Outcome outcome_ = Outcome::running;
  bool ended_ = false;
};

}  // namespace calot::recorder
