// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace calot::gui {

/// How smoothly an operation was seen while it was running: pictures a second, the longest time that one stood, how
/// large they were drawn, and how long after a motion of the hands it was on the screen. Pauses and what comes after
/// the end do not count. One thread.
class PictureRate {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// Whether the operation moves from now on.
  void setRunning(bool running);
  /// A picture came on the screen. @param side its share of the size that it is shown in. @param delay since the last
  /// motion that is in it (s); none where that is not known
  void shown(Time now, double side = 1.0, std::optional<double> delay = {});

  [[nodiscard]] std::uint64_t pictures() const { return pictures_; }  ///< that followed another one
  [[nodiscard]] double seconds() const { return seconds_; }           ///< from the first one to the last
  [[nodiscard]] double longest() const { return longest_; }           ///< between two (s)
  /// Mean pictures a second; 0 before there were two.
  [[nodiscard]] double mean() const { return seconds_ > 0.0 ? static_cast<double>(pictures_) / seconds_ : 0.0; }

  /// Mean share of the size that they are shown in; 1 before there were two.
  [[nodiscard]] double side() const { return pictures_ > 0 ? sides_ / static_cast<double>(pictures_) : 1.0; }
  /// Of that share of the pictures the delay was at most this (s); none where it was never known.
  [[nodiscard]] std::optional<double> delay(double share) const;

  /// "25.3 pictures a second of 1280x720 in 25.0 s, ...": one line for a terminal.
  [[nodiscard]] std::string report(int width, int height, const std::string& drawnBy) const;

 private:
  bool running_ = false;
  std::optional<Time> last_;
  std::uint64_t pictures_ = 0;
  double seconds_ = 0.0, longest_ = 0.0, sides_ = 0.0;
  std::vector<float> delays_;
};

}  // namespace calot::gui
