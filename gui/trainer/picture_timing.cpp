// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/picture_timing.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <cstddef>

namespace calot::gui {

void MotionClock::asked(std::uint64_t step, Time now) {
  Entry& entry = entries_[step % kept];
  // A concurrent reader finds no step here.
  entry.step.store(~std::uint64_t{0}, std::memory_order_seq_cst);
  entry.ticks.store(now.time_since_epoch().count(), std::memory_order_seq_cst);
  entry.step.store(step, std::memory_order_seq_cst);
}

std::optional<MotionClock::Time> MotionClock::of(std::uint64_t step) const {
  const Entry& entry = entries_[step % kept];
  if (entry.step.load(std::memory_order_seq_cst) != step) return std::nullopt;
  const Time time{Time::duration(entry.ticks.load(std::memory_order_seq_cst))};
  if (entry.step.load(std::memory_order_seq_cst) != step) return std::nullopt;
  return time;
}

bool ClockedSource::next(std::uint64_t tick, TickSamples& out) {
  if (!source_.next(tick, out)) return false;
  if ((tick + 1) % ticksPerStep_ == 0) clock_.asked(firstStep_ + tick / ticksPerStep_, MotionClock::Time::clock::now());
  return true;
}

void PictureRate::setRunning(bool running) {
  running_ = running;
  if (!running_) last_.reset();
}

void PictureRate::shown(Time now, double side, std::optional<double> delay) {
  if (!running_) return;
  if (last_) {
    const double wait = std::chrono::duration<double>(now - *last_).count();
    ++pictures_;
    sides_ += side;
    if (delay) delays_.push_back(static_cast<float>(*delay));
    seconds_ += wait;
    longest_ = std::max(longest_, wait);
  }
  last_ = now;
}

std::optional<double> PictureRate::delay(double share) const {
  if (delays_.empty()) return std::nullopt;
  std::vector<float> sorted = delays_;
  const auto rank = static_cast<std::ptrdiff_t>(std::ceil(share * static_cast<double>(sorted.size()))) - 1;
  const auto at = sorted.begin() + std::clamp<std::ptrdiff_t>(rank, 0, static_cast<std::ptrdiff_t>(sorted.size()) - 1);
  std::nth_element(sorted.begin(), at, sorted.end());
  return *at;
}

std::string PictureRate::report(int width, int height, const std::string& drawnBy) const {
  std::string line = fmt::format("{:.1f} pictures a second of {}x{} in {:.1f} s, one stood for {:.2f} s at most",
                                 mean(), width, height, seconds_, longest_);
  if (side() < 0.995) line += fmt::format("; drawn at {:.0f} % of the width in the mean", 100.0 * side());
  if (const auto typical = delay(0.5))
    line += fmt::format("; motion to picture {:.0f} ms, 95 % within {:.0f} ms", 1e3 * *typical, 1e3 * *delay(0.95));
  return line + "; drawn by " + drawnBy;
}

namespace {

constexpr int maxUnderway = 3;
constexpr std::chrono::milliseconds period(30);  // every third step: some are lost, thirty a second are to stay
/// A window that is hidden shows nothing; it is tried again so often.
constexpr std::chrono::milliseconds retryAfter(500);

}  // namespace

void ViewTap::begin(recorder::Session& session) {
  underway_ = 1;
  sink_(std::make_shared<const SceneView>(session.view()));
}

void ViewTap::onStep(const recorder::StepRecord& record) {
  const Clock::time_point now = Clock::now();
  if (now < next_) return;
  if (underway_ >= maxUnderway && now < last_ + retryAfter) return;
  // The mean is kept, not the distance.
  next_ = now - next_ > period ? now + period : next_ + period;
  last_ = now;
  ++underway_;
  ++taken_;
  sink_(std::make_shared<const SceneView>(record.view()));
}

}  // namespace calot::gui
