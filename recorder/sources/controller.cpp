// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/controller.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "recorder/base/errors.h"
#include "recorder/sources/pointing.h"
#include "sim/instruments/instruments.h"

namespace calot::recorder {

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
