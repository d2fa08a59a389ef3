// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "recorder/recording/reader.h"

namespace calot::recorder {

/// Statistics of a hand's device from its raw samples.
struct RawStatistics {
  std::uint64_t samples = 0;  ///< in the recording
  std::uint64_t valid = 0;    ///< of these
  std::uint64_t used = 0;     ///< of these: a tick's pose was made from them
  std::uint64_t dropped = 0;  ///< came and could not be kept
  std::uint64_t missing = 0;  ///< numbers left out between the first sample and the last
  double rate = 0.0;          ///< effective: valid samples a second of host time, first to last (1/s); 0: unknown
  double maxInterval = 0.0;   ///< of host time between two valid samples (s)
};

/// Reads all of a hand's raw samples. @throws Error damaged.
RawStatistics rawStatistics(Recording& recording, Hand hand);

}  // namespace calot::recorder
