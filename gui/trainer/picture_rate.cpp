// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/picture_rate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace calot::gui {

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

}  // namespace calot::gui
