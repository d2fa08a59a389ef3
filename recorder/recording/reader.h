// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "recorder/base/identity.h"
#include "recorder/engine/engine.h"
#include "recorder/engine/observer.h"
#include "recorder/recording/device_sample.h"
#include "recorder/recording/station_key.h"

namespace calot::recorder {

struct Layout;

/// A State's digest in the short form that recordings from format version 2 on hold (schemas/recording.md, "Steps").
struct BriefDigest {
  std::uint64_t state = 0;           ///< XXH3-64 of the digests of components
  std::vector<std::uint16_t> field;  ///< low 16 bits of each field's
  bool operator==(const BriefDigest&) const = default;
};

/// One row of /status: the extent of the data after a flush.
struct StatusRow {
  std::uint64_t ticks = 0, steps = 0, events = 0, keyframes = 0;
  std::uint64_t keyframeWords = 0;  ///< 8-byte words of /keyframes/bytes
  bool completed = false;
  Outcome outcome = Outcome::running;
  std::int64_t wallNanoseconds = 0;  ///< since 1970-01-01 UTC, when the row was written; outside the chain
  std::array<std::uint8_t, 32> chain{};
  /// Count in its row of /device/counts; 0 where there is no /device.
  std::array<std::uint64_t, handCount> rawSamples{};
  std::array<std::uint64_t, handCount> rawDropped{};
};

struct RecordedStep {
  std::uint64_t step = 0;
  std::vector<TickSamples> samples;  ///< ticksPerStep of them
  std::vector<TickOutcome> ticks;    ///< as many; forces are rounded, but in format version 1; in golden ones 0
  StepResult result;                 ///< with its events
  StateDigest digest;                ///< of format version 1, and of golden recordings (no fields there); else empty
  BriefDigest brief;                 ///< of the others
  std::uint64_t forces = 0;          ///< digest of the ticks' forces before rounding; none in whole ones of version 1
  float lateness = 0.0F;
  RecordedProcedure procedure;  ///< version 3 of StepResult: the judgement of its time
};

/// The first part of a recording that does not agree with its content chain.
enum class ChainFault : std::uint8_t {
  none,
  start,      ///< root attributes, scene or names
  flush,      ///< the content of one flush
  signature,  ///< the signature of the chain's head
};

/// Does the content chain, recomputed from the file's content, agree with its /status?
/// analytics/checkpoints/replay_words.h makes a sentence of it.
struct ChainVerdict {
  ChainFault fault = ChainFault::none;
  std::uint64_t flush = 0;      ///< first row of /status that disagrees; 0: header or scene
  std::uint64_t firstStep = 0;  ///< steps [firstStep, endStep) belong to that flush
  std::uint64_t endStep = 0;
  double seconds = 0.0;  ///< of the attempt, at the beginning of that flush

  [[nodiscard]] bool intact() const { return fault == ChainFault::none; }
  bool operator==(const ChainVerdict&) const = default;

  static void fields(auto& self, auto& visit) {
    visit("fault", self.fault);
    visit("flush", self.flush);
    visit("first_step", self.firstStep);
    visit("end_step", self.endStep);
    visit("seconds", self.seconds);
  }
};

/// A station's signature of a recording's content (schemas/recording.md, "Signature").
struct RecordedSignature {
  PublicKey publicKey{};
  std::optional<Signature> value;  ///< none: its writer was killed before it could sign

  /// Is it the key's signature of this head?
  [[nodiscard]] bool fits(const std::array<std::uint8_t, 32>& head) const {
    return value && recorder::fits(*value, publicKey, head);
  }
};

enum class Access {
  settled,  ///< nobody writes the file any more: closed, or left behind by a killed writer
  live,     ///< a writer may be at work: metadata that is being written is tried again
};

/// A recording, opened for reading. Nothing in the file is trusted before it is checked; only rows covered by the last
/// row of /status are read. Everything throws Error: damaged (4) naming file and data set for what cannot be read, has
/// the wrong type or shape, a bad checksum, or a value that no source makes (NaN, no unit quaternion within 1e-3, an
/// unknown instrument).
///
/// An object is not thread-safe. Objects and writers of one process serialise internally (HDF5 has one lock).
class Recording {
 public:
  /// Reads and checks the header, scene (SHA-256 of each asset), shape of every data set and /status.
  explicit Recording(const std::filesystem::path& path, Access access = Access::settled);
  ~Recording();
  Recording(Recording&&) noexcept;
  Recording& operator=(Recording&&) noexcept;

  [[nodiscard]] const std::filesystem::path& path() const;
  [[nodiscard]] const AttemptHeader& header() const;
  [[nodiscard]] const std::vector<StatusRow>& status() const;  ///< at least one row

  /// True if the attempt ended and all of it is here.
  [[nodiscard]] bool complete() const;
  [[nodiscard]] Outcome outcome() const;  ///< running if not complete
  [[nodiscard]] std::uint64_t stepCount() const;
  [[nodiscard]] std::uint64_t tickCount() const;
  [[nodiscard]] std::uint64_t eventCount() const;
  [[nodiscard]] double seconds() const;  ///< of simulated time

  /// Step n. Sequential reading is cheap: rows are read and checked one flush at a time. The reference holds until the
  /// next call.
  /// @pre n < stepCount()
  const RecordedStep& step(std::uint64_t n);

  /// Events of all steps, in their order, read by themselves; none in a golden recording. Those of a runaway step may
  /// hold numbers that are not finite.
  [[nodiscard]] std::vector<Event> events() const;

  /// Its columns, and the bytes of all rows of one of them (Layout::columns) in the flush of the step that was read
  /// last.
  /// @pre the column is one of ticks, steps or events
  [[nodiscard]] const Layout& layout() const;
  [[nodiscard]] const std::vector<std::byte>& flushRows(std::size_t column) const;

  /// Steps after which there is a keyframe, rising.
  [[nodiscard]] const std::vector<std::uint64_t>& keyframeSteps() const;
  /// Index into keyframeSteps of the last keyframe at or before a step, if there is one.
  [[nodiscard]] std::optional<std::size_t> keyframeAtOrBefore(std::uint64_t step) const;
  [[nodiscard]] Keyframe keyframe(std::size_t index);

  /// Raw samples of a hand's device: how many there are, and how many came and could not be kept. 0 without a device,
  /// or in a file whose writer kept none.
  [[nodiscard]] std::uint64_t rawSampleCount(Hand hand) const;
  [[nodiscard]] std::uint64_t rawSamplesDropped(Hand hand) const;
  /// Some of them, in the order of arrival. @pre first + count <= rawSampleCount(hand)
  [[nodiscard]] std::vector<RawSample> rawSamples(Hand hand, std::uint64_t first, std::uint64_t count);

  /// The signature, if a key was available. Checked by verifyChain().
  [[nodiscard]] const std::optional<RecordedSignature>& signature() const;

  /// Recomputes the chain over the whole file and checks the signature, if there is one, against its last head. Throws
  /// where data cannot be read; a disagreement is a verdict.
  ChainVerdict verifyChain();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace calot::recorder
