// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "recorder/identity.h"
#include "sim/scene/samples.h"

namespace calot::recorder {

/// Where instrument samples come from: a kinematics file, a performer, a recording, a device. Live, scripted and
/// replayed runs differ in nothing else.
///
/// Every source rounds what it hands out with roundedToGrid(), so that what is logged is exactly what was simulated.
class SampleSource {
 public:
  virtual ~SampleSource() = default;

  /// Who acts, and from what; copied into every recording that this source feeds.
  [[nodiscard]] virtual const Provenance& provenance() const = 0;

  /// Fills one tick (1 ms).
  /// @param tick 0, 1, 2, ...: called once for each tick, in order.
  /// @param out what the hands and the camera do during the tick, on the recording's grid; left alone at the end.
  /// @returns false when the source has ended; from then on always false.
  virtual bool next(std::uint64_t tick, TickSamples& out) = 0;
};

}  // namespace calot::recorder
