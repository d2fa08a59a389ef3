// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>

namespace calot::gui {

/// How large pictures are drawn so that they keep a rate: a share of width and height that falls where drawing is too
/// slow and rises where time is left, in few steps, after a mean over several pictures each. What drawing costs
/// beside its pixels is not known; a larger size is tried only where even all of the cost times the pixels would do, so
/// that it does not swing. Keeps no clock. One thread at a time.
class PictureScale {
 public:
  static constexpr std::array<double, 5> sides{1.0, 0.875, 0.75, 0.625, 0.5};

  /// @param rate pictures a second that are wanted; 0: every picture is drawn whole
  /// @param drawers how many pictures are drawn at a time. @pre at least 1
  PictureScale(double rate, std::size_t drawers) : rate_(rate), drawers_(static_cast<double>(drawers)) {}

  /// Share of width and height of the next picture, one of `sides`.
  [[nodiscard]] double side() const { return sides[level_]; }
  /// A picture of this share was drawn in so many seconds of wall time. One of another share than the present one was
  /// begun before it changed, and is not counted.
  void drew(double side, double seconds);

 private:
  static constexpr int enough = 12;  ///< pictures that a mean is taken of
  static constexpr double spare = 1.1;

  void take(std::size_t level);

  double rate_, drawers_;
  std::size_t level_ = 0;
  double sum_ = 0.0;
  int count_ = 0;
};

}  // namespace calot::gui
