// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/source.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "recorder/base/errors.h"
#include "recorder/sources/pointing.h"
#include "sim/instruments/instruments.h"
#include "sim/math/floating_point.h"
#include "sim/scene/description.h"

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

namespace {

constexpr std::size_t maxControllerName = 64;

void checkCommand(const HandCommand& command, const char* hand) {
  const auto refuse = [hand](const char* what) {
    throw Error(ErrorKind::invalid, fmt::format("the {} hand's command: {}", hand, what));
  };
  if (!command.tip.allFinite()) refuse("its position is not finite; give metres in the scene's frame W");
  if (!std::isfinite(command.roll)) refuse("its roll is not finite; give radians about the shaft");
  if (!std::isfinite(command.jaw)) refuse("its jaw angle is not finite; give radians, 0 closed");
  if (!isInstrumentNumber(static_cast<unsigned>(command.instrument))) refuse("its instrument is unknown");
}

void checkText(const std::string& text, const char* what) {
  const bool printable = std::all_of(text.begin(), text.end(), [](char c) { return c >= ' ' && c <= '~'; });
  if (text.empty() || text.size() > maxControllerName || !printable)
    throw Error(ErrorKind::invalid, fmt::format("the controller's {}: 1 to {} printable ASCII characters are expected",
                                                what, maxControllerName));
}

}  // namespace

ControllerSamples::ControllerSamples(const SceneDescription& scene) : camera_(scene.camera) {
  for (std::size_t h = 0; h < handCount; ++h) {
    port_[h] = scene.hands[h].port;
    hand_[h].tip = scene.hands[h].home;
    hand_[h].instrument = scene.hands[h].instrument;
  }
}

void ControllerSamples::next(const HandCommands& wanted, std::span<TickSamples> out) {
  for (std::size_t h = 0; h < handCount; ++h) checkCommand(wanted[h], handNames[h]);
  for (std::size_t i = 0; i < out.size(); ++i) {
    TickSamples tick;
    tick.camera = camera_;
    const double share = static_cast<double>(i + 1) / static_cast<double>(out.size());
    for (std::size_t h = 0; h < handCount; ++h) {
      const HandCommand& from = hand_[h];
      const HandCommand& to = wanted[h];
      InstrumentSample& sample = tick.hand[h];
      sample.position = from.tip + share * (to.tip - from.tip);
      sample.orientation = pointing(port_[h], sample.position, from.roll + share * (to.roll - from.roll));
      sample.jaw = from.jaw + share * (to.jaw - from.jaw);
      sample.instrument = to.instrument;
      sample.buttons = to.buttons;
    }
    out[i] = roundedToGrid(tick);
  }
  hand_ = wanted;
}

Provenance controllerProvenance(const std::string& name, const std::string& version) {
  checkText(name, "name");
  checkText(version, "version");
  return {OperatorKind::performer, "controller:" + name, version};
}

}  // namespace calot::recorder
