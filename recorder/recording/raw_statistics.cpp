// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/raw_statistics.h"

#include <algorithm>
#include <optional>

namespace calot::recorder {

RawStatistics rawStatistics(Recording& recording, Hand hand) {
  constexpr std::uint64_t most = 4096;
  RawStatistics s;
  s.samples = recording.rawSampleCount(hand);
  s.dropped = recording.rawSamplesDropped(hand);
  std::optional<std::uint64_t> sequence;
  std::optional<double> first, last;  // s; doubles, since untrusted numbers may have any value
  for (std::uint64_t at = 0; at < s.samples; at += most) {
    for (const RawSample& raw : recording.rawSamples(hand, at, std::min(most, s.samples - at))) {
      if (sequence && raw.sample.sequence > *sequence) s.missing += raw.sample.sequence - *sequence - 1;
      sequence = raw.sample.sequence;
      if (raw.used) ++s.used;
      if (!raw.sample.valid) continue;
      ++s.valid;
      const double time = 1e-9 * static_cast<double>(raw.sample.hostTime);
      if (!first) first = time;
      if (last) s.maxInterval = std::max(s.maxInterval, time - *last);
      last = time;
    }
  }
  if (s.valid > 1 && *last > *first) s.rate = static_cast<double>(s.valid - 1) / (*last - *first);
  return s;
}

}  // namespace calot::recorder
