// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/scope/scope_source.h"

#include <utility>

#include "sim/math/floating_point.h"

namespace calot::recorder {

ScopeSource::ScopeSource(std::unique_ptr<SampleSource> source, const Endoscope& endoscope,
                         std::unique_ptr<ScopeDriver> driver)
    : source_(std::move(source)), endoscope_(endoscope), driver_(std::move(driver)) {
  motion_.setOut(endoscope_.start());
  driver_->setOut(endoscope_.start());
}

void ScopeSource::setOutFrom(const CameraSample& camera) {
  const FloatingPointScope environment;
  const ScopeJoints joints = endoscope_.jointsOf(camera);
  motion_.setOut(joints);
  driver_->setOut(joints);
}

bool ScopeSource::next(std::uint64_t tick, TickSamples& out) {
  TickSamples samples;
  if (!source_->next(tick, samples)) return false;
  const FloatingPointScope environment;
  motion_.advance(driver_->wish(static_cast<double>(tick) * tickLength, motion_.joints(), samples));
  samples.camera = endoscope_.pose(motion_.joints());
  out = roundedToGrid(samples);
  return true;
}

void ScopeSource::rest() {
  source_->rest();
  driver_->rest();
}

}  // namespace calot::recorder
