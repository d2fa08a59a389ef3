// SPDX-License-Identifier: GPL-3.0-or-later
// Sources of samples, sources around other sources, and samples from the commands of a controller: a program that
// decides step by step what the hands do.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "recorder/base/identity.h"
#include "recorder/engine/observer.h"
#include "sim/scene/description.h"
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
  ///   is something else. Then go on with the next tick's number; a paced clock is moved by the time that was waited,
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

/// A source around another: what a derived class does not change is the other's.
class WrappedSource : public SampleSource {
 public:
  /// @param source outlives this
  explicit WrappedSource(SampleSource& source) : source_(source) {}

  [[nodiscard]] const Provenance& provenance() const override { return source_.provenance(); }
  bool next(std::uint64_t tick, TickSamples& out) override { return source_.next(tick, out); }
  SourceStatus status() override { return source_.status(); }
  void rest() override { source_.rest(); }
  [[nodiscard]] Observer* watcher() override { return source_.watcher(); }
  [[nodiscard]] DeviceSource* device() override { return source_.device(); }
  [[nodiscard]] Outcome ending() const override { return source_.ending(); }
  [[nodiscard]] std::string statusText() const override { return source_.statusText(); }

 protected:
  SampleSource& source_;
};

/// Wraps a source so that a trainer's window may pause the run, exchange instruments and end the
/// attempt, with any device.
///
/// Changes are made in the samples and are thus recorded: an exchanged instrument appears in the ticks,
/// a pause produces none. So they replay as they were, whatever the simulation makes of them.
class ControlledSource final : public WrappedSource {
 public:
  /// @param source outlives this
  explicit ControlledSource(SampleSource& source) : WrappedSource(source) {}

  // Any thread:
  /// Pauses the run before its next step (SourceStatus::paused) or resumes it. A failed source is not paused.
  void hold(bool held) { held_ = held; }
  [[nodiscard]] bool held() const { return held_; }
  /// From the next tick on this hand has that instrument, whatever the source says; a hand without any stays so.
  void mount(Hand hand, InstrumentKind instrument) {
    mounted_[static_cast<std::size_t>(hand)] = static_cast<std::int16_t>(instrument);
  }
  /// The same as a person does it: the old instrument is drawn out through the port and the new one put in, and for so
  /// long the hand has none. Nothing happens to a hand without any, or that has this one already; a newer wish on the
  /// way begins again. @param ticks how long it takes (ms)
  void exchange(Hand hand, InstrumentKind instrument, std::uint32_t ticks);
  /// An exchange that is under way.
  struct Exchange {
    InstrumentKind coming = InstrumentKind::none;
    std::uint32_t ticks = 0;  ///< still to go
  };
  [[nodiscard]] std::optional<Exchange> exchanging(Hand hand) const;
  /// Asks the assistant for more or less retraction: a press of one tick, by the right hand where it is measured, else
  /// by the left one.
  void ask(bool more) { ++(more ? more_ : less_); }
  /// The source ends with the next tick. @pre outcome is not running
  void finish(Outcome outcome) { finished_ = outcome; }

  bool next(std::uint64_t tick, TickSamples& out) override;
  SourceStatus status() override;
  [[nodiscard]] Outcome ending() const override;

 private:
  static constexpr std::int16_t asGiven = -1;
  void press(TickSamples& out);

  std::atomic<bool> held_{false};
  struct Exchanging {
    std::atomic<std::uint64_t> wish{0};  ///< kind in the upper half, ticks in the lower; 0: none
    std::atomic<std::uint32_t> left{0};  ///< ticks
  };
  std::array<std::atomic<std::int16_t>, handCount> mounted_{asGiven, asGiven};
  std::array<Exchanging, handCount> exchange_;
  std::atomic<Outcome> finished_{Outcome::running};
  std::atomic<std::uint32_t> more_{0}, less_{0};  ///< requests that are still to be pressed
  bool pressed_ = false;                          ///< in the last tick; a new press follows a release
};

/// Another source from its tick 0 on, whose hands and camera set out from where a recording left them: for `blendTime`
/// the pose goes from the last measured one to the source's own by minimum jerk,
///   p = p_0 + s (p_source(t) - p_0),  s = 10 u^3 - 15 u^4 + 6 u^5,  u = t / blendTime
/// (orientation on the shorter arc, jaw angle likewise), so that neither place nor speed jumps at the fork. Instrument,
/// buttons and validity are the source's own from the first tick. Samples are rounded as every source's are.
class BlendedSource final : public WrappedSource {
 public:
  static constexpr double blendTime = 1.0;  ///< s

  /// @param source outlives this. @param start the last measured pose of hands and camera.
  BlendedSource(SampleSource& source, const TickSamples& start) : WrappedSource(source), start_(start) {}

  bool next(std::uint64_t tick, TickSamples& out) override;

 private:
  TickSamples start_;
};

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
