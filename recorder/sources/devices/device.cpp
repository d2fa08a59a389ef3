// SPDX-License-Identifier: GPL-3.0-or-later

#include "recorder/sources/devices/device.h"

namespace calot::recorder {

std::int64_t monotonicNanoseconds() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace calot::recorder
