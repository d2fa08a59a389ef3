// SPDX-License-Identifier: GPL-3.0-or-later
// What one flush writes: rows of every column, as bytes. Internal to this folder.
// The content chain (schemas/recording.md, "Content chain") has one link a flush: BLAKE2b-256 over decoded values.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "recorder/recording/layout.h"
#include "recorder/recording/reader.h"
#include "recorder/recording/rows.h"

namespace calot::recorder {

struct Block {
  std::vector<std::vector<std::byte>> column;     ///< as Layout::columns
  std::array<std::uint64_t, streamCount> rows{};  ///< of each stream in this block
  bool last = false;                              ///< nothing comes after it
  bool completed = false;                         ///< the attempt ended with it
  Outcome outcome = Outcome::running;
  std::array<std::uint64_t, handCount> rawDropped{};  ///< raw samples of this block that could not be kept
  std::vector<Keyframe> keyframes;                    ///< of its steps, while they are not yet coded
  BriefDigest brief;                                  ///< of its last step

  /// Reserves capacity for a whole block, so that filling it does not allocate (except for events and keyframes).
  explicit Block(const Layout& layout);
  void clear();
};

/// Rows of each stream that a row of /status covers.
std::array<std::uint64_t, streamCount> countsOf(const StatusRow& row);

/// Appends a step to a block, but for its keyframe. @pre the layout is of the newest format version
void appendStep(const Layout& layout, const StepRecord& record, Block& block);

/// Appends the coded words of a keyframe (keyframe_code.h) and its row of the index. `offset` counts the words of
/// /keyframes/bytes before it and moves on.
void appendKeyframe(const Layout& layout, const Keyframe& keyframe, std::span<const std::uint64_t> words,
                    std::uint64_t& offset, Block& block);

/// Reads step `at` (of this block) back, but for its events. @return an empty string, or which value is out of range.
std::string extractStep(const Layout& layout, const Block& block, std::uint64_t at, RecordedStep& out);

using ChainHead = std::array<std::uint8_t, 32>;

/// Link 0: root attributes, scene, names.
ChainHead chainStart(const AttemptHeader& header);

/// The next link: the rows of a block and the counts of its row of /status. @param before the row before it.
ChainHead chainNext(const Layout& layout, const StatusRow& before, const Block& block, const StatusRow& after);

}  // namespace calot::recorder
