// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/key_bindings.h"

#include <algorithm>
#include <array>
#include <Qt>
#include <utility>

namespace calot::gui {

using recorder::MouseControl;

namespace {

// Letters that lie at one place on all keyboards of Latin letters but the French.
constexpr std::array<std::pair<int, MouseControl>, 14> controls{{{Qt::Key_Right, MouseControl::right},
                                                                 {Qt::Key_Left, MouseControl::left},
                                                                 {Qt::Key_Down, MouseControl::down},
                                                                 {Qt::Key_Up, MouseControl::up},
                                                                 {Qt::Key_PageUp, MouseControl::in},
                                                                 {Qt::Key_PageDown, MouseControl::out},
                                                                 {Qt::Key_W, MouseControl::rollRight},
                                                                 {Qt::Key_Q, MouseControl::rollLeft},
                                                                 {Qt::Key_S, MouseControl::openJaw},
                                                                 {Qt::Key_A, MouseControl::closeJaw},
                                                                 {Qt::Key_D, MouseControl::cut},
                                                                 {Qt::Key_F, MouseControl::coagulate},
                                                                 {Qt::Key_E, MouseControl::fire},
                                                                 {Qt::Key_Shift, MouseControl::fine}}};
constexpr std::array instruments{InstrumentKind::grasper, InstrumentKind::hook, InstrumentKind::clipApplier,
                                 InstrumentKind::scissors};

}  // namespace

std::optional<KeyAction> actionOf(int key) {
  KeyAction action;
  const auto* const control =
      std::find_if(controls.begin(), controls.end(), [key](const auto& entry) { return entry.first == key; });
  if (control != controls.end()) {
    action.control = control->second;
    return action;
  }
  if (key >= Qt::Key_1 && key <= Qt::Key_8) {
    const auto n = static_cast<std::size_t>(key - Qt::Key_1);
    action.kind = KeyAction::Kind::mount;
    action.instrument = instruments[n % instruments.size()];
    action.otherHand = n >= instruments.size();
    return action;
  }
  switch (key) {
    case Qt::Key_Space:
      action.kind = KeyAction::Kind::switchHand;
      return action;
    case Qt::Key_R:
      action.kind = KeyAction::Kind::toggleLock;
      return action;
    case Qt::Key_P:
    case Qt::Key_Escape:
      action.kind = KeyAction::Kind::pause;
      return action;
    default:
      return std::nullopt;
  }
}

std::vector<KeyHelp> keyHelp(bool mouse, bool pauses) {
  std::vector<KeyHelp> out;
  if (mouse) {
    out = {{"Mouse, arrows", "move the tip"},
           {"Wheel, Page Up/Down", "insert, draw back"},
           {"Left button, A", "close the jaws"},
           {"Right button, S", "open the jaws"},
           {"Q, W", "turn the shaft"},
           {"D, F", "pedals: cut, coagulate"},
           {"E", "set a clip"},
           {"R", "lock the jaws, let go"},
           {"Space", "the other hand"},
           {"Shift", "slowly"},
           {"Ctrl", "move the mouse alone"},
           {"1 2 3 4", "grasper, hook, clip applier, scissors"},
           {"5 6 7 8", "the same for the other hand"}};
  } else {
    out = {{"1 2 3 4", "right hand: grasper, hook, clip applier, scissors"}, {"5 6 7 8", "the same for the left hand"}};
  }
  if (pauses) out.push_back({"Escape", "pause, go on"});
  return out;
}

}  // namespace calot::gui
