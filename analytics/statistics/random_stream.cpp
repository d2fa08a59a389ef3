// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/random_stream.h"

#include <cassert>

#include "analytics/statistics/distributions.h"

namespace calot::analytics {

std::uint64_t RandomStream::below(std::uint64_t n) {
  assert(n > 0);
  const std::uint64_t excess = (std::uint64_t{0} - n) % n;
  std::uint64_t bits = engine_();
  while (bits < excess) bits = engine_();
  return bits % n;
}

double RandomStream::uniform() { return (static_cast<double>(engine_() >> 12U) + 0.5) * 0x1p-52; }

double RandomStream::normal() { return normalQuantile(uniform()); }

}  // namespace calot::analytics
