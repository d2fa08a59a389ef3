// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/checkpoints/force.h"

#include <algorithm>
#include <cmath>

namespace calot::analytics {

void ForceTrack::add(const recorder::StepRecord& record) {
  const std::size_t ticks = std::min(record.samples.size(), record.ticks.size());
  for (std::size_t t = 0; t < ticks; ++t) {
    for (std::size_t h = 0; h < static_cast<std::size_t>(handCount); ++h) {
      if (record.samples[t].hand[h].instrument == InstrumentKind::none) continue;
      mounted_[h] = true;
      const Vec3& f = record.ticks[t].hand[h].force;
      const double magnitude = std::sqrt(f.x() * f.x() + f.y() * f.y() + f.z() * f.z());
      largest_[h] = std::max(largest_[h], magnitude);
      if (magnitude >= leastForce) felt_[h].push_back(magnitude);
    }
  }
}

}  // namespace calot::analytics
