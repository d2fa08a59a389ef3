// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <optional>

#include "recorder/base/ring.h"
#include "recorder/recording/device_sample.h"

namespace calot::recorder {

/// Raw samples in transit from the thread that requests ticks from a device source to the one that records. Neither
/// side waits or allocates. Samples that exceed the capacity are dropped and counted.
class RawSampleQueue final : public RawSampleFeed {
 public:
  /// @param capacity samples that may wait. The default is two seconds of two hands at 1 kHz, twenty times the lag that
  /// a live run allows itself.
  explicit RawSampleQueue(std::size_t capacity = 4096) : ring_(capacity) {}

  /// Producer.
  void put(const RawSample& sample) {
    if (!ring_.push(sample)) {
      dropped_[static_cast<std::size_t>(sample.sample.hand)].fetch_add(1, std::memory_order_relaxed);
    }
  }

  bool take(std::uint64_t endTick, RawSample& out) override {
    if (!next_) {
      RawSample sample;
      if (!ring_.pop(sample)) return false;
      next_ = sample;
    }
    if (next_->tick >= endTick) return false;
    out = *next_;
    next_.reset();
    return true;
  }

  [[nodiscard]] std::array<std::uint64_t, handCount> dropped() const override {
    return {dropped_[0].load(std::memory_order_relaxed), dropped_[1].load(std::memory_order_relaxed)};
  }

 private:
  Ring<RawSample> ring_;
  std::optional<RawSample> next_;  // the consumer's: taken from the ring, of a tick that is not recorded yet
  std::array<std::atomic<std::uint64_t>, handCount> dropped_{};
};

}  // namespace calot::recorder
