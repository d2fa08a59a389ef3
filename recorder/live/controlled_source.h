// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string>

#include "recorder/sources/source.h"

namespace calot::recorder {

/// Wraps a source so that a trainer's window may pause the run, exchange instruments and end the
/// attempt, with any device.
///
/// Changes are made in the samples and are thus recorded: an exchanged instrument appears in the ticks,
/// a pause produces none.
class ControlledSource final : public SampleSource {
 public:
  /// @param source outlives this
  explicit ControlledSource(SampleSource& source) : source_(source) {}

  // Any thread:
  /// Pauses the run before its next step (SourceStatus::paused) or resumes it. A failed source is not paused.
  void hold(bool held) { held_ = held; }
  [[nodiscard]] bool held() const { return held_; }
  /// From the next tick on this hand has that instrument, whatever the source says; a hand without any stays so.
  void mount(Hand hand, InstrumentKind instrument) {
    mounted_[static_cast<std::size_t>(hand)] = static_cast<std::int16_t>(instrument);
  }
  /// The source ends with the next tick. @pre outcome is not running
  void finish(Outcome outcome) { finished_ = outcome; }

  [[nodiscard]] const Provenance& provenance() const override { return source_.provenance(); }
  bool next(std::uint64_t tick, TickSamples& out) override;
  SourceStatus status() override;
  void rest() override { source_.rest(); }
  [[nodiscard]] Observer* watcher() override { return source_.watcher(); }
  [[nodiscard]] DeviceSource* device() override { return source_.device(); }
  [[nodiscard]] Outcome ending() const override;
  [[nodiscard]] std::string statusText() const override { return source_.statusText(); }

 private:
  static constexpr std::int16_t asGiven = -1;

  SampleSource& source_;
  std::atomic<bool> held_{false};
  std::array<std::atomic<std::int16_t>, handCount> mounted_{asGiven, asGiven};
  std::atomic<Outcome> finished_{Outcome::running};
};

}  // namespace calot::recorder
