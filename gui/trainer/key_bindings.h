// SPDX-License-Identifier: GPL-3.0-or-later
// Key bindings in the picture of the operation.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "recorder/sources/devices/window_input.h"
#include "sim/scene/samples.h"

namespace calot::gui {

struct KeyAction {
  enum class Kind : std::uint8_t {
    control,     ///< does it while it is held
    switchHand,  ///< passes mouse and keyboard to the other hand
    toggleLock,
    mount,       ///< exchanges an instrument
    retraction,  ///< asks the assistant for more or less
    scope,       ///< moves the endoscope while it is held
    scopePedal,  ///< while it is held, the mouse moves the endoscope
    pause,       ///< or goes on
  };
  Kind kind = Kind::control;
  recorder::MouseControl control = recorder::MouseControl::right;
  recorder::ScopeControl scope = recorder::ScopeControl::right;
  InstrumentKind instrument = InstrumentKind::none;
  bool otherHand = false;  ///< mount: not the hand that is driven
  bool more = false;       ///< retraction
};

/// @param key of Qt::Key
[[nodiscard]] std::optional<KeyAction> actionOf(int key);

/// For the page of keys: "Space" and "the other hand".
struct KeyHelp {
  std::string keys;
  std::string what;
  bool assistant = false;  ///< only where the scene has one
};
/// @param mouse both hands are driven by mouse and keyboard; else only instruments are exchanged and runs held
/// @param scope keys move the endoscope @param pauses the mode has a pause
[[nodiscard]] std::vector<KeyHelp> keyHelp(bool mouse, bool scope, bool pauses);

}  // namespace calot::gui
