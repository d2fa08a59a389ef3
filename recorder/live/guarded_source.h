// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <mutex>
#include <string>

#include "recorder/sources/source.h"

namespace calot::recorder {

/// A source with a watcher in a live run: one thread requests ticks, another reports steps. Sources are not
/// thread-safe; this serialises the two.
class GuardedSource final : public SampleSource, private Observer {
 public:
  /// @param source outlives this; it has a watcher
  explicit GuardedSource(SampleSource& source) : source_(source), watcher_(*source.watcher()) {}

  [[nodiscard]] const Provenance& provenance() const override { return source_.provenance(); }
  bool next(std::uint64_t tick, TickSamples& out) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    return source_.next(tick, out);
  }
  SourceStatus status() override { return source_.status(); }
  void rest() override {
    const std::lock_guard<std::mutex> lock(mutex_);
    source_.rest();
  }
  [[nodiscard]] Observer* watcher() override { return this; }
  [[nodiscard]] DeviceSource* device() override { return source_.device(); }
  [[nodiscard]] Outcome ending() const override { return source_.ending(); }
  [[nodiscard]] std::string statusText() const override { return source_.statusText(); }

 private:
  void onStep(const StepRecord& record) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    watcher_.onStep(record);
  }
  void onEnd(Outcome outcome) override { watcher_.onEnd(outcome); }

  SampleSource& source_;
  Observer& watcher_;
  std::mutex mutex_;
};

}  // namespace calot::recorder
