// SPDX-License-Identifier: GPL-3.0-or-later
// Values of all checkpoints: of a run or replay, of recorded observables, or of motion alone; and the samples of a
// hand's motion and its forces that they are computed of.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/checkpoints/motion.h"
#include "analytics/checkpoints/phases.h"
#include "recorder/engine/observer.h"
#include "recorder/recording/layout.h"
#include "recorder/recording/reader.h"
#include "recorder/sources/tracked_motion.h"
#include "sim/judgement/judge.h"
#include "sim/scene/samples.h"

namespace calot::analytics {

/// Below this a force counts as none (N): an operator can't feel it, and no device sends it.
inline constexpr double leastForce = 0.01;

/// Magnitudes of the forces that the haptic ticks sent to one hand, tick by tick.
struct HandForces {
  bool mounted = false;       ///< there was an instrument at any tick
  double largest = 0.0;       ///< of all (N), felt or not
  double sum = 0.0;           ///< of all (N)
  std::vector<double> felt;   ///< those of at least leastForce (N), in the order of ticks
  std::vector<double> rates;  ///< |f(t+1) - f(t-1)| / (2 ticks) of each tick with a force of at least leastForce and an
                              ///< instrument at all three (N/s), in the order of ticks
};

class ForceTrack {
 public:
  /// @param tickSeconds length of a tick (s).
  explicit ForceTrack(double tickSeconds) : tickSeconds_(tickSeconds) {}

  void add(const recorder::StepRecord& record);
  /// Marks a discontinuity: no rate of change is taken across.
  void interrupt();
  [[nodiscard]] const HandForces& of(std::size_t hand) const { return hand_[hand]; }
  [[nodiscard]] double tickSeconds() const { return tickSeconds_; }

 private:
  /// Forces of the two newest ticks in a row with an instrument, the newer one last.
  struct Newest {
    std::array<Vec3, 2> force{Vec3::Zero(), Vec3::Zero()};
    int ticks = 0;
  };
  double tickSeconds_;
  std::array<Newest, handCount> newest_{};
  std::array<HandForces, handCount> hand_{};
};

/// The same of each phase of a procedure by itself.
class PhaseForceTrack {
 public:
  /// @param tickSeconds length of a tick (s).
  explicit PhaseForceTrack(double tickSeconds) : track_(windowPhases.size(), ForceTrack(tickSeconds)) {}

  /// @param phase of the step
  void add(const recorder::StepRecord& record, Phase phase);
  /// @param window which of windowPhases.
  [[nodiscard]] const ForceTrack& of(std::size_t window) const { return track_[window]; }

 private:
  std::vector<ForceTrack> track_;
  Phase phase_ = Phase::none;
};

/// Collects one hand's ticks and finds the tracker's own samples among them. A source holds its newest sample until
/// there is another one, so:
///
/// - a valid tick whose pose (position or orientation, to the last bit) differs from the one before is a sample;
/// - a pose that stands for at most 0.1 s was held, and the motion runs straight to the next sample;
/// - a valid pose that stands for longer is rest, because sources mark what they hold longer as not measured: it lasts
///   until one sampling interval (the newest known) before the next sample, and is a point again there;
/// - ticks that the source marked as not measured are no samples; an exchange of the instrument splits the motion.
///
/// Where the source itself interpolated (kinematics files, docs/explanation/sources.md), only the first tick of each
/// interval of the file's rows can be a sample. Deterministic contract.
class MotionTrack {
 public:
  /// @param tickSeconds length of a tick (s). @pre > 0.
  /// @param sourceRate of a source that interpolates between its samples (Hz); 0: it doesn't.
  explicit MotionTrack(double tickSeconds, double sourceRate = 0.0);

  void add(const InstrumentSample& sample);

  /// The motion so far, filtered. Cost: one pass over the points.
  [[nodiscard]] Motion motion(double cutoff = motionCutoff) const;

 private:
  /// Ticks without measurement: from the newest one that was, to the next one or the instrument's end.
  struct Pause {
    std::int64_t from = 0, to = 0;
    bool atStart = false;  ///< none was before it
  };

  void unmount();
  void begin(const InstrumentSample& sample, bool continues);
  void sampled(const InstrumentSample& sample);
  void closeRest(SampleGrid& grid) const;
  [[nodiscard]] Pause pauseUntil(std::int64_t tick) const;
  [[nodiscard]] bool rested() const;
  [[nodiscard]] bool isDue() const;
  [[nodiscard]] double seconds(std::int64_t ticks) const { return static_cast<double>(ticks) * tickSeconds_; }
  [[nodiscard]] MotionCoverage coverage(double interval) const;

  double tickSeconds_;
  double rowsPerTick_;
  SampleGrid grid_;
  SampleRate rate_;
  std::int64_t tick_ = -1;
  std::int64_t sample_ = -1;     ///< tick of the newest sample
  std::int64_t vouched_ = -1;    ///< newest valid tick with its pose
  std::int64_t interval_ = 1;    ///< ticks between the two newest samples that weren't rest apart
  std::int64_t mountedAt_ = -1;  ///< first tick of the instrument that is there now; -1: none is
  Vec3 position_ = Vec3::Zero();
  Quat orientation_ = Quat::Identity();               ///< as recorded
  InstrumentKind instrument_ = InstrumentKind::none;  ///< of the newest sample, if it is there still
  TimeSpans mounted_;                                 ///< earlier instruments (s)
  std::vector<Pause> pauses_;                         ///< closed ones
};

/// The observer that feeds every checkpoint of the registry. Attach it to a live run, to a replay, or to a reader of
/// observables; the same steps give the same values, bit for bit.
class CheckpointCollector final : public recorder::Observer {
 public:
  /// @param scene the attempt's own: the Model's, or recorder::sceneFromAssets() of the recording's assets.
  /// @param origin what the StepRecords are: `resimulated` (live or replay) or `observables` (read from the file).
  /// @param cutoff of the motion filter (Hz), one of motionCutoffs. Values that are stored are of the default.
  CheckpointCollector(const recorder::AttemptHeader& header, const SceneDescription& scene,
                      Origin origin = Origin::resimulated, double cutoff = 6.0);

  void onStep(const recorder::StepRecord& record) override;
  /// The same with what somebody else judged of the step: of a run, take either this or onStep().
  void take(const recorder::StepRecord& record, const Judgement& judgement);
  void onEnd(recorder::Outcome outcome) override;

  /// Every figure in the registry's order, subjects in the order of hands or organs. After onEnd() they are final;
  /// before, those whose definition says `final` are provisional.
  [[nodiscard]] std::vector<CheckpointValue> values() const;

 private:
  Origin origin_;
  double cutoff_;
  double tickSeconds_;
  std::uint64_t ticksPerStep_;
  std::array<MotionTrack, handCount> track_;
  PhaseTrack phases_;
  Judge judge_;
  ForceTrack force_;
  PhaseForceTrack phaseForce_;
  std::vector<std::unique_ptr<Checkpoint>> checkpoint_;
  std::uint64_t steps_ = 0;
  double stretched_ = 0.0;
  recorder::Outcome outcome_ = recorder::Outcome::running;
  bool ended_ = false;
};

/// Every figure of a recording from what its steps recorded of themselves, without simulating: for recordings of other
/// simulation versions, whose results any later software can read. Origins are `observables` and `samples`.
/// @param cutoff of the motion filter (Hz); values that are stored are of the default.
/// @param also sees the same steps, and the end; or null.
/// @pre the recording's content chain was found intact.
/// @throws Error (damaged) where the file cannot be read, or its results do not fit its scene.
std::vector<CheckpointValue> valuesFromObservables(recorder::Recording& recording, double cutoff = 6.0,
                                                   recorder::Observer* also = nullptr);

/// Facts about a motion file that the file does not hold.
struct SamplesContext {
  recorder::Outcome outcome = recorder::Outcome::stopped;
  std::string handedness = "unknown";
  double cutoff = motionCutoff;  ///< Hz; values that are stored are of the default
};

/// The motion of one hand: every row is a sample.
Motion motionOf(const recorder::TrackedMotion& tracked, std::size_t hand, double cutoff = motionCutoff);

/// The figures that motion alone can give (those whose definition allows the origin `samples`), in the registry's
/// order. The attempt lasts from the first row to the last.
std::vector<CheckpointValue> valuesFromSamples(const recorder::TrackedMotion& tracked, const SamplesContext& context);

/// A track for either hand of an attempt that was recorded so.
MotionTrack trackFor(const recorder::AttemptHeader& header);

/// Left and right, as every motion checkpoint of this attempt sees them. @param cutoff of the filter (Hz), one of
/// motionCutoffs. @throws Error (damaged) where a step cannot be read
std::array<Motion, handCount> motionOf(recorder::Recording& recording, double cutoff = motionCutoff);

}  // namespace calot::analytics
