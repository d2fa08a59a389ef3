// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "sim/scene/samples.h"

namespace calot::recorder {

/// Keys of a keyboard, or a foot switch, as pedals and jaws of both hands, from a Linux input device (evdev), which
/// reports presses and releases whichever window has the focus.
///
/// Left hand: Q opens the jaw, A closes it, left Alt locks, Z cuts, X coagulates, 1 fires. Right hand: P opens, L
/// closes, right Alt locks, comma cuts, dot coagulates, 0 fires. F1 and F2, as foot switches send them, cut and
/// coagulate with the right hand.
class PedalKeys {
 public:
  /// @param file /dev/input/eventN or a link to one
  /// @throws Error (failure) where it cannot be opened
  explicit PedalKeys(const std::string& file);
  ~PedalKeys();
  PedalKeys(const PedalKeys&) = delete;
  PedalKeys& operator=(const PedalKeys&) = delete;

  struct Hold {
    std::uint8_t buttons = 0;
    double jawRate = 0.0;  ///< opening (rad/s), negative: closing
  };
  /// Reads what came; never waits. @returns false where the keyboard is gone: nothing is held from then on
  bool read();
  [[nodiscard]] Hold hold(Hand hand) const;

 private:
  int file_ = -1;
  std::array<bool, 256> down_{};
};

}  // namespace calot::recorder
