// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/source.h"

#include "recorder/sources/pointing.h"
#include "sim/math/floating_point.h"
#include "sim/scene/measurement.h"

namespace calot::recorder {

bool ControlledSource::next(std::uint64_t tick, TickSamples& out) {
  if (finished_ != Outcome::running) return false;
  if (!source_.next(tick, out)) return false;
  for (std::size_t h = 0; h < handCount; ++h) {
    const std::uint64_t wish = exchange_[h].wish.exchange(0);
    InstrumentKind& instrument = out.hand[h].instrument;
    if (instrument == InstrumentKind::none) continue;
    if (const std::int16_t mounted = mounted_[h]; mounted != asGiven) instrument = static_cast<InstrumentKind>(mounted);
    std::uint32_t left = exchange_[h].left;
    const auto wanted = static_cast<InstrumentKind>(wish >> 32U);
    if (wish != 0 && (left > 0 || wanted != instrument)) {
      mounted_[h] = static_cast<std::int16_t>(wanted);
      instrument = wanted;
      left = static_cast<std::uint32_t>(wish);
    }
    if (left > 0) {
      instrument = InstrumentKind::none;
      --left;
    }
    exchange_[h].left = left;
  }
  press(out);
  return true;
}

/// One tick pressed, one tick let go.
void ControlledSource::press(TickSamples& out) {
  pressed_ = !pressed_ && (more_ > 0 || less_ > 0);
  if (!pressed_) return;
  InstrumentSample* const hand = isMeasurement(out.hand[1])   ? &out.hand[1]
                                 : isMeasurement(out.hand[0]) ? out.hand.data()
                                                              : nullptr;
  pressed_ = hand != nullptr;
  if (!pressed_) return;
  std::atomic<std::uint32_t>& asked = more_ > 0 ? more_ : less_;
  hand->buttons =
      static_cast<std::uint8_t>(hand->buttons | (&asked == &more_ ? button::retractMore : button::retractLess));
  --asked;
}

void ControlledSource::exchange(Hand hand, InstrumentKind instrument, std::uint32_t ticks) {
  exchange_[static_cast<std::size_t>(hand)].wish = static_cast<std::uint64_t>(instrument) << 32U | ticks;
}

std::optional<ControlledSource::Exchange> ControlledSource::exchanging(Hand hand) const {
  const auto h = static_cast<std::size_t>(hand);
  const std::uint32_t left = exchange_[h].left;
  if (left == 0) return std::nullopt;
  return Exchange{static_cast<InstrumentKind>(mounted_[h].load()), left};
}

SourceStatus ControlledSource::status() {
  // Ending takes precedence over pausing, even if the device is gone.
  if (finished_ != Outcome::running) return SourceStatus::ok;
  if (!held_) return source_.status();
  source_.rest();
  return source_.status() == SourceStatus::failed ? SourceStatus::failed : SourceStatus::paused;
}

Outcome ControlledSource::ending() const {
  const Outcome finished = finished_;
  return finished == Outcome::running ? source_.ending() : finished;
}

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
