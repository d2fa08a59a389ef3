// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <ctime>

namespace calot::bench {

/// CPU time of the calling thread (s): what else runs on the machine does not count, except through the caches.
inline double threadSeconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Median of what two readings in a row differ by (s): to be taken off where single short calls are timed.
double clockOverhead();

}  // namespace calot::bench
