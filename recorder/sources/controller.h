// SPDX-License-Identifier: GPL-3.0-or-later
// A program that decides step by step what the hands do: its commands become samples.
#pragma once

#include <array>
#include <span>
#include <string>

#include "recorder/base/identity.h"
#include "sim/scene/description.h"
#include "sim/scene/samples.h"

namespace calot::recorder {

/// Pose that a controller requests for a hand at the end of the coming step. The shaft passes through the port.
struct HandCommand {
  Vec3 tip = Vec3::Zero();                           ///< p_WI (m)
  double roll = 0.0;                                 ///< about the shaft, as pointing() has it (rad)
  double jaw = 0.0;                                  ///< opening angle (rad), 0 closed
  std::uint8_t buttons = 0;                          ///< bits of `button`, from the step's first tick on
  InstrumentKind instrument = InstrumentKind::none;  ///< mounted from the step's first tick on
};
using HandCommands = std::array<HandCommand, handCount>;

/// Makes the ticks of each step from a controller's commands: tip, roll and jaw go evenly from where the last command
/// left them to where the new one wants them.
class ControllerSamples {
 public:
  explicit ControllerSamples(const SceneDescription& scene);

  /// Last commanded pose of the hands; at first at home, with the scene's instruments, jaws closed.
  [[nodiscard]] const HandCommands& hands() const { return hand_; }

  /// From the next step on the endoscope is here.
  void look(const CameraSample& camera) { camera_ = camera; }

  /// Fills the coming step's ticks, on the recording's grid.
  /// @throws Error (invalid) where a command has a number that is not finite, or names no instrument; nothing is
  /// changed then
  void next(const HandCommands& wanted, std::span<TickSamples> out);

 private:
  std::array<Vec3, handCount> port_;
  HandCommands hand_;
  CameraSample camera_;
};

/// A controller's attempts are a performer's (synthetic) with the profile "controller:NAME".
/// @throws Error (invalid) where name or version are empty, longer than 64 bytes, or not printable ASCII
Provenance controllerProvenance(const std::string& name, const std::string& version);

}  // namespace calot::recorder
