// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <span>

#include "recorder/recording/reader.h"
#include "recorder/replay.h"

namespace calot::recorder {

/// The first difference of a re-simulated tick's forces, bit for bit.
std::optional<Divergence> compareTick(std::uint64_t step, std::uint64_t tick, const TickOutcome& recorded,
                                      const TickOutcome& here);

/// The first differing component of the State digests and its first differing field.
std::optional<Divergence> compareDigest(std::uint64_t step, const DigestLayout& layout, const StateDigest& recorded,
                                        const StateDigest& here);

/// The same of short digests.
std::optional<Divergence> compareDigest(std::uint64_t step, const DigestLayout& layout, const BriefDigest& recorded,
                                        const BriefDigest& here);

/// Compares the observables and events of one step after the other, in the recording's version of them. Names of fields
/// are those of schemas/observables.md: "left/tip_real[2]"; the index is that of the column, of an event's field that
/// of the event comes first.
class ResultComparison {
 public:
  explicit ResultComparison(const AttemptHeader& header);
  ~ResultComparison();
  ResultComparison(const ResultComparison&) = delete;
  ResultComparison& operator=(const ResultComparison&) = delete;

  /// The first difference, bit for bit. Makes no strings and, after the first steps, no memory, where there is none.
  std::optional<Divergence> operator()(const StepResult& recorded, const StepResult& here);

 private:
  struct Buffers;
  std::unique_ptr<Buffers> buffers_;
};

/// The first difference of the judgement that version 3 of StepResult held.
std::optional<Divergence> compareProcedure(std::uint64_t step, const RecordedProcedure& recorded,
                                           const RecordedProcedure& here);

}  // namespace calot::recorder
