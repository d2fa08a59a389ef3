// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "recorder/sources/source.h"

namespace calot::gui {

/// When the last motion of each of the latest steps was asked for: with it a window says how long after a motion of the
/// hands the picture of it was there. What lies between device and source is not in it (a calibration measures that).
class MotionClock {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// One thread, the one that asks for ticks.
  void asked(std::uint64_t step, Time now);
  /// Any thread: none where the step is not among the latest.
  [[nodiscard]] std::optional<Time> of(std::uint64_t step) const;

 private:
  struct Entry {
    std::atomic<std::uint64_t> step{~std::uint64_t{0}};
    std::atomic<Time::rep> ticks{0};
  };
  static constexpr std::size_t kept = 256;  ///< steps: 2.56 s
  std::array<Entry, kept> entries_;
};

/// A source whose ticks are noted in a MotionClock; else what it wraps.
class ClockedSource final : public recorder::SampleSource {
 public:
  /// @param source, clock outlive this. @param firstStep of the attempt, in which the source's tick 0 lies
  ClockedSource(recorder::SampleSource& source, MotionClock& clock, std::uint64_t firstStep, std::uint32_t ticksPerStep)
      : source_(source), clock_(clock), firstStep_(firstStep), ticksPerStep_(ticksPerStep) {}

  [[nodiscard]] const recorder::Provenance& provenance() const override { return source_.provenance(); }
  bool next(std::uint64_t tick, TickSamples& out) override;
  recorder::SourceStatus status() override { return source_.status(); }
  void rest() override { source_.rest(); }
  [[nodiscard]] recorder::Observer* watcher() override { return source_.watcher(); }
  [[nodiscard]] recorder::DeviceSource* device() override { return source_.device(); }
  [[nodiscard]] recorder::ScopeSource* scope() override { return source_.scope(); }
  [[nodiscard]] recorder::Outcome ending() const override { return source_.ending(); }
  [[nodiscard]] std::string statusText() const override { return source_.statusText(); }

 private:
  recorder::SampleSource& source_;
  MotionClock& clock_;
  std::uint64_t firstStep_;
  std::uint32_t ticksPerStep_;
};

}  // namespace calot::gui
