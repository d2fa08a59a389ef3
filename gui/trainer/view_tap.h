// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <utility>

#include "recorder/engine/session.h"

namespace calot::gui {

/// Hands out views of a running attempt, as many as are looked at: at most one in 30 ms, and none while three are
/// still to be shown, since each costs the simulation's thread the surfaces of the scene.
class ViewTap final : public recorder::Observer {
 public:
  using Sink = std::function<void(std::shared_ptr<const SceneView>)>;

  /// @param sink called on the simulation's thread; must not wait
  explicit ViewTap(Sink sink) : sink_(std::move(sink)) {}

  void onStep(const recorder::StepRecord& record) override;
  void onEnd(recorder::Outcome /*outcome*/) override {}

  /// Hands out a view of a session that it is to be joined to.
  void begin(recorder::Session& session);
  /// Any thread: a view has been shown.
  void shown() { underway_ = 0; }
  /// Has the newest one that was handed out been shown, or one after it?
  [[nodiscard]] bool isShown() const { return underway_ == 0; }
  [[nodiscard]] std::uint64_t taken() const { return taken_; }  ///< views handed out

 private:
  using Clock = std::chrono::steady_clock;

  Sink sink_;
  Clock::time_point next_{};  ///< when the next one is due
  Clock::time_point last_{};
  std::atomic<int> underway_{0};  ///< handed out since the last one was shown
  std::atomic<std::uint64_t> taken_{0};
};

}  // namespace calot::gui
