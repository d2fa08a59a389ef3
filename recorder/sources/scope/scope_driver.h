// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "recorder/sources/scope/endoscope.h"
#include "sim/scene/samples.h"

namespace calot::recorder {

/// Who holds the endoscope: keys, a device, or an assistant who follows the instruments.
class ScopeDriver {
 public:
  ScopeDriver() = default;
  ScopeDriver(const ScopeDriver&) = delete;
  ScopeDriver& operator=(const ScopeDriver&) = delete;
  virtual ~ScopeDriver() = default;

  /// The endoscope stands so: before the first tick.
  virtual void setOut(const ScopeJoints& joints) = 0;

  /// Where the endoscope is to go; it follows within its limits and speeds. Called once for each tick, in order.
  /// @param time of the attempt (s) @param present joints now @param hands both instruments in this tick
  [[nodiscard]] virtual ScopeJoints wish(double time, const ScopeJoints& present, const TickSamples& hands) = 0;

  /// Called while the run is paused: motion in the meantime moves nothing.
  virtual void rest() {}

  /// Does it live in real time, so that the run must keep its pace?
  [[nodiscard]] virtual bool realTime() const { return false; }
};

}  // namespace calot::recorder
