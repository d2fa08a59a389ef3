// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/blended_source.h"

#include "recorder/sources/pointing.h"
#include "sim/math/floating_point.h"

namespace calot::recorder {

bool BlendedSource::next(std::uint64_t tick, TickSamples& out) {
  TickSamples samples;
  if (!source_.next(tick, samples)) return false;
  const FloatingPointScope environment;
  const double s = minimumJerk(static_cast<double>(tick) * tickLength / blendTime);
  if (s < 1.0) {
    for (std::size_t h = 0; h < handCount; ++h) {
      InstrumentSample& to = samples.hand[h];
      const InstrumentSample& from = start_.hand[h];
      to.position = from.position + s * (to.position - from.position);
      to.orientation = interpolated(from.orientation, to.orientation, s);
      to.jaw = from.jaw + s * (to.jaw - from.jaw);
    }
    samples.camera.position = start_.camera.position + s * (samples.camera.position - start_.camera.position);
    samples.camera.orientation = interpolated(start_.camera.orientation, samples.camera.orientation, s);
  }
  out = roundedToGrid(samples);
  return true;
}

}  // namespace calot::recorder
