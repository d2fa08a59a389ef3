// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

#include "recorder/base/identity.h"
#include "recorder/engine/observer.h"
#include "recorder/recording/device_sample.h"
#include "recorder/recording/station_key.h"

namespace calot::recorder {

struct Layout;

struct WriterOptions {
  bool force = false;                  ///< replace a file that is already there
  std::optional<StationKey> key = {};  ///< signs the last head of the chain
};

/// Statistics of the writer; readable from any thread while it records.
struct WriterStatistics {
  std::uint64_t flushes = 0;      ///< rows of /status after the first
  std::uint64_t steps = 0;        ///< steps on disk and covered by /status
  std::uint64_t blocksGrown = 0;  ///< blocks allocated beyond the first ones: the disk was slower than the loop
  double writerSeconds = 0.0;     ///< CPU time of the writing thread (s)
  double maxFlushSeconds = 0.0;   ///< longest wall time of one flush (s)
};

/// Writes one attempt to one HDF5 file as schemas/recording.md says, on a thread of its own.
///
/// The loop's thread copies a step into a block of 250 ticks and hands full blocks over through a lock-free queue; it
/// never waits for the disk; if the disk falls behind, the queue grows (counted). Every full block is one flush in SWMR
/// mode: killed at any moment, a run paced at real time loses at most two blocks.
///
/// The file has the name TARGET.part until all its data sets exist and SWMR writing has started; then it is renamed.
/// If writing fails later (disk full), the writer keeps what was flushed, stops writing and lets the loop go on;
/// finish() reports the error.
class RecordingWriter final : public Observer {
 public:
  /// Creates the file, with header, scene and every data set.
  /// @pre header.ticksPerStep in [1, 1000]; at most maxStructures structures and 1,000 assets, the scene file first.
  /// @throws Error invalid: the target exists and force is not set. failure: it cannot be created.
  RecordingWriter(const std::filesystem::path& target, const AttemptHeader& header, WriterOptions options = {});

  /// Without a preceding onEnd, the file stays incomplete: all steps so far, outcome `running`.
  ~RecordingWriter() override;
  RecordingWriter(const RecordingWriter&) = delete;
  RecordingWriter& operator=(const RecordingWriter&) = delete;

  /// From the next step on, keeps what a device measured. Taken at each step, on the loop's thread; what came up to a
  /// step's last tick is flushed with that step. @param feed outlives the last step. @param firstTick of the attempt,
  /// at which the feed's tick 0 lies (a branch). @pre the header says deviceSamples
  void takeRawSamples(RawSampleFeed& feed, std::uint64_t firstTick = 0);

  /// Appends a step. Disk errors do not throw here. @pre record.step counts 0, 1, 2, ...
  void onStep(const StepRecord& record) override;

  /// Hands over the last block with the outcome; no onStep after it.
  void onEnd(Outcome outcome) override;

  /// Waits until all is written and the file is closed; one that was stopped before its first step is removed. @throws
  /// Error failure: naming the file and what went wrong; what had been flushed before can be read. @pre onEnd was
  /// called.
  void finish();

  /// Has writing stopped (disk full)? finish() reports the reason. Thread-safe.
  [[nodiscard]] bool failed() const;

  [[nodiscard]] WriterStatistics statistics() const;

  /// As FileAppender::locked(). @pre finish() was not called
  [[nodiscard]] bool locked() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// When keyframes are taken: so that simulating from one of them to any step takes no longer where steps are hard than
/// where they are easy. Goes by what a step reports of its own work, never by clocks: the same attempt has the same
/// keyframes everywhere. The writer's own.
class KeyframeSchedule {
 public:
  explicit KeyframeSchedule(const Layout& layout, double tickSeconds);

  /// Takes the next step. @return whether a keyframe is due after it: only at the end of a block.
  bool dueAfter(const StepResult& result);

  /// A keyframe was taken. @param stateBytes of its State; the first one's is the measure of the scene's size.
  void taken(std::size_t stateBytes);

 private:
  std::uint64_t stepsPerBlock_;
  std::uint64_t longest_;  ///< steps: about a second, whole blocks
  std::uint64_t steps_ = 0;
  std::uint64_t since_ = 0;  ///< steps since the last keyframe
  double work_ = 0.0;        ///< since the last keyframe (ms)
  double blockWork_ = 0.0;   ///< of the block so far (ms)
  double size_ = 0.0;        ///< of the scene, as a multiple of the one that the work was measured in; 0: not yet known
};

}  // namespace calot::recorder
