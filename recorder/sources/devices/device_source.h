// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "recorder/base/queues.h"
#include "recorder/recording/device_sample.h"
#include "recorder/sources/devices/calibration.h"
#include "recorder/sources/devices/device.h"
#include "recorder/sources/devices/device_mapping.h"
#include "recorder/sources/source.h"
#include "sim/scene/description.h"

namespace calot::recorder {

/// Polls a device in real time on a thread of its own, so that samples carry the time of their arrival and the loop
/// never waits for a device. Lock-free between the two threads; its queues allocate only where they grow. A device on
/// the tick clock is polled by drain() itself. Closes the device at its end.
class DevicePump {
 public:
  DevicePump(Device& device, bool realTime);
  ~DevicePump();
  DevicePump(const DevicePump&) = delete;
  DevicePump& operator=(const DevicePump&) = delete;

  /// Replaces `out` by what came in since the last call. One thread.
  void drain(DeviceInput& out);
  /// For the device's motors, and for what it holds. The same thread.
  void setWrench(Hand hand, const Wrench& wrench) { command({hand, wrench}); }
  void setOut(Hand hand, const HandStart& start) { command({hand, start}); }
  [[nodiscard]] bool ended() const { return ended_.load(std::memory_order_acquire); }

 private:
  struct Command {
    Hand hand = Hand::right;
    std::variant<Wrench, HandStart> what;
  };
  void run();
  void command(const Command& command);
  void obey(const Command& command);

  Device& device_;
  SpscQueue<DeviceSample> samples_;
  SpscQueue<DeviceEvent> events_;
  SpscQueue<Command> commands_;
  std::atomic<bool> stop_{false}, ended_{false};
  std::thread thread_;
};

/// Raw samples in transit from the thread that requests ticks from a device source to the one that records. Neither
/// side waits or allocates. Samples that exceed the capacity are dropped and counted.
class RawSampleQueue final : public RawSampleFeed {
 public:
  /// @param capacity samples that may wait. The default is two seconds of two hands at 1 kHz, twenty times the lag that
  /// a live run allows itself.
  explicit RawSampleQueue(std::size_t capacity = 4096) : ring_(capacity) {}

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

struct DeviceSourceSettings {
  std::optional<Calibration> calibration;
  Mode mode = Mode::practice;
  double staleAfter = 0.1;  ///< s; a hand whose newest valid sample is older is not measured
  /// Set: the device is polled by next() itself, on this clock. Not set: on a thread of its own, on the host's clock.
  std::shared_ptr<TickClock> tickClock;
};

/// Jaw, lock and pedals of a hand whose attempt goes on from an earlier moment, after a pause or after a loss, so that
/// nothing acts before the hand takes over: the jaw stays until the device's stands so or passes there; the lock, until
/// the device's is the same; a pedal or trigger that is down counts only after it was let go.
class TakeOver {
 public:
  TakeOver() = default;
  explicit TakeOver(const HandStart& start);
  /// @param sample of the device in; of the hand out
  void apply(InstrumentSample& sample);

 private:
  HandStart kept_;
  bool keepsJaw_ = false, keepsLock_ = false;
  std::optional<double> jawBefore_;  ///< the device's
  std::uint8_t down_ = 0;            ///< buttons that have not been let go
};

struct DeviceCounts {
  std::uint64_t samples = 0;
  std::uint64_t invalid = 0;
  std::uint64_t losses = 0;       ///< number of disconnections
  std::vector<std::string> told;  ///< its events, one line each, the first 100
};

/// An attempt by a device. Each tick takes the newest valid sample of each hand, mapped into the scene (DeviceMapping)
/// and held until a newer one comes; the tick says that the hand is not measured where that sample is older than
/// `staleAfter`, or the device is gone. Each hand is anchored when the attempt begins, so that its instrument starts at
/// the scene's home; when a clutch is released; and after a disconnection, so that nothing jumps.
///
/// A press of the clip applier's trigger counts for one step, however short or long it is: one press, one clip.
///
/// A hand that the device has not driven yet has no instrument: checkpoints of it, and of both
/// hands, are not applicable.
///
/// When the device disconnects, practice pauses until it is back and an assessment fails (SourceStatus).
class DeviceSource final : public SampleSource {
 public:
  /// The calibration must be one that checkCalibration accepts.
  DeviceSource(std::unique_ptr<Device> device, const SceneDescription& scene, DeviceSourceSettings settings);

  /// Waits until every hand that the device drives at once was seen, or half a second has passed since the first was.
  /// @param stop ends the waiting. @throws Error (failure) where no hand was seen after `seconds`, naming the device
  /// and why.
  void waitForFirst(double seconds, const std::atomic<bool>* stop = nullptr);

  /// Before the first tick: has a hand moved, worked its jaw or pressed something since this was asked first? Discards
  /// what the device sends until then, so that an attempt begins with its operator's first motion. True once the device
  /// sends nothing more.
  bool moved();

  /// Before the first tick: the hands set out from here instead of the scene's home (a branch), with jaw and lock as
  /// they were until each takes over (TakeOver). A hand that has no instrument there begins at home.
  void setOutFrom(const TickSamples& start);

  [[nodiscard]] const Provenance& provenance() const override { return provenance_; }
  bool next(std::uint64_t tick, TickSamples& out) override;
  SourceStatus status() override;
  /// Discards the device's samples meanwhile; each hand is anchored again, and takes over, when the run goes on.
  void rest() override;
  [[nodiscard]] std::string statusText() const override { return lost_; }
  [[nodiscard]] DeviceSource* device() override { return this; }
  /// Sets forces on the hands, for devices with motors.
  void feedback(const std::array<Wrench, handCount>& inWorld);

  /// Samples of the device since the attempt began, in the order of arrival, for the recording: also those
  /// that no tick used. It begins with what the first tick found. Another thread than the one that asks for
  /// ticks may take them.
  [[nodiscard]] RawSampleFeed& rawSamples() { return raw_; }

  [[nodiscard]] const DeviceCounts& counts() const { return counts_; }
  [[nodiscard]] const DeviceInfo& deviceInfo() const { return device_->info(); }
  [[nodiscard]] std::array<ForceStatistics, handCount> forceStatistics() const { return device_->forceStatistics(); }

 private:
  struct HandState {
    DeviceMapping mapping;
    std::optional<DeviceSample> newest = {};  ///< valid
    std::optional<DeviceSample> still = {};   ///< moved(): where it was
    InstrumentSample held = {};
    bool anchorAgain = false;
    bool clutched = false;
    bool placed = false;  ///< setOutFrom(): held says where it begins
    TakeOver takeOver = {};
    bool used = false;            ///< the tick's pose was made from the newest
    bool trigger = false;         ///< of the clip applier: down
    std::uint32_t triggered = 0;  ///< ticks for which its last press still counts
  };
  void gather();
  void beginAttempt();
  void keepRaw(std::uint64_t tick);
  [[nodiscard]] std::int64_t now() const;
  void keepHeld(std::size_t hand);
  void fill(std::size_t hand, InstrumentSample& out);
  void pullTrigger(HandState& hand, InstrumentSample& out) const;

  DeviceSourceSettings settings_;
  Provenance provenance_;
  CameraSample camera_;
  std::uint32_t ticksPerStep_;
  std::vector<HandState> hand_;
  std::unique_ptr<Device> device_;
  DevicePump pump_;                  ///< after the device: it ends first
  std::vector<DeviceSample> fresh_;  ///< gathered since the last tick
  RawSampleQueue raw_;
  DeviceCounts counts_;
  DeviceInput input_;
  std::string lost_;     ///< why the device is gone; empty: it is there
  bool failed_ = false;  ///< an assessment lost its device
  bool begun_ = false, ended_ = false;
};

}  // namespace calot::recorder
