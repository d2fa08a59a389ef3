// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

namespace calot::gui {

/// How smoothly an operation was seen: pictures a second, and the longest time that one stood, while it was running.
/// Pauses and what comes after the end do not count. One thread.
class PictureRate {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// Whether the operation moves from now on.
  void setRunning(bool running);
  /// A picture came on the screen.
  void shown(Time now);

  [[nodiscard]] std::uint64_t pictures() const { return pictures_; }  ///< that followed another one
  [[nodiscard]] double seconds() const { return seconds_; }           ///< from the first one to the last
  [[nodiscard]] double longest() const { return longest_; }           ///< between two (s)
  /// Mean pictures a second; 0 before there were two.
  [[nodiscard]] double mean() const { return seconds_ > 0.0 ? static_cast<double>(pictures_) / seconds_ : 0.0; }

 private:
  bool running_ = false;
  std::optional<Time> last_;
  std::uint64_t pictures_ = 0;
  double seconds_ = 0.0, longest_ = 0.0;
};

}  // namespace calot::gui
