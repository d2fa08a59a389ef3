// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

#include "recorder/base/identity.h"
#include "recorder/engine/observer.h"
#include "sim/scene/samples.h"

namespace calot::recorder {

class DeviceSource;
class ScopeSource;

/// Readiness of a source. Only a source with a device behind it is ever other than ok.
enum class SourceStatus : std::uint8_t {
  ok,
  paused,  ///< the device is gone and may come back
  failed,  ///< the device is gone and the attempt ends with it
};

/// Source of instrument samples: a kinematics file, a performer, a recording, a device. Live, scripted and
/// replayed runs differ in nothing else.
///
/// Every source rounds its output with roundedToGrid(), so that the log contains exactly what was simulated.
class SampleSource {
 public:
  virtual ~SampleSource() = default;

  /// Operator and input; copied into every recording that this source feeds.
  [[nodiscard]] virtual const Provenance& provenance() const = 0;

  /// Fills one tick (1 ms).
  /// @param tick 0, 1, 2, ...: called once for each tick, in order.
  /// @param out what the hands and the camera do during the tick, on the recording's grid; left alone at the end.
  /// @returns false when the source has ended; from then on always false.
  virtual bool next(std::uint64_t tick, TickSamples& out) = 0;

  /// Queried before the first tick of every step, by the thread that calls next(). The loop must react as follows:
  /// - ok: go on.
  /// - paused: ask for no tick and advance nothing; ask again every few milliseconds, and ask `stop` as well, until it
  /// is
  ///   something else. Then go on with the next tick's number; a paced clock is moved by the time that was waited,
  ///   which counts neither as lateness nor as stretching. Pauses and their length are counted in the report.
  /// - failed: end the attempt with Outcome::technicalFailure; the steps so far are whole and stay.
  /// A device that disconnects in mid-step does not stop it: next() then hands out invalid samples (the last pose held)
  /// until the step has its ticks.
  virtual SourceStatus status() { return SourceStatus::ok; }

  /// Called instead of next() while the run is paused externally (ControlledSource), by the thread that calls next(),
  /// every few milliseconds: motion in the meantime belongs to no tick. When the run resumes, a device's hands continue
  /// from their last poses.
  virtual void rest() {}

  /// Observer of this source that must receive every step, for operators in closed loop; nullptr: none. The loop calls
  /// it before it requests the next step's first tick; in live runs, from the simulation thread.
  [[nodiscard]] virtual Observer* watcher() { return nullptr; }

  /// The device behind this source, for who records its raw samples, drives its motors or reports what came from it.
  /// nullptr: there is none.
  [[nodiscard]] virtual DeviceSource* device() { return nullptr; }

  /// The endoscope that moves with this source: a branch sets it out from where it stood. nullptr: the camera is fixed.
  [[nodiscard]] virtual ScopeSource* scope() { return nullptr; }

  /// How the attempt ended, once next() has returned false.
  [[nodiscard]] virtual Outcome ending() const { return Outcome::completed; }

  /// One line of reason if the status is not ok, else empty.
  [[nodiscard]] virtual std::string statusText() const { return {}; }
};

}  // namespace calot::recorder
