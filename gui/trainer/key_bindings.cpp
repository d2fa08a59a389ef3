// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/key_bindings.h"

#include <algorithm>
#include <array>
#include <Qt>
#include <utility>

#include "sim/instruments/instruments.h"

namespace calot::gui {

using recorder::MouseControl;
using recorder::ScopeControl;

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

constexpr std::array<std::pair<int, ScopeControl>, 10> scopeControls{{{Qt::Key_L, ScopeControl::right},
                                                                      {Qt::Key_J, ScopeControl::left},
                                                                      {Qt::Key_I, ScopeControl::up},
                                                                      {Qt::Key_K, ScopeControl::down},
                                                                      {Qt::Key_O, ScopeControl::in},
                                                                      {Qt::Key_U, ScopeControl::out},
                                                                      {Qt::Key_G, ScopeControl::cableRight},
                                                                      {Qt::Key_T, ScopeControl::cableLeft},
                                                                      {Qt::Key_N, ScopeControl::headRight},
                                                                      {Qt::Key_B, ScopeControl::headLeft}}};

/// Keys of the instruments, in the order of their list: for the hand that is driven, and for the other one. A new
/// instrument takes the next pair, so that no key ever changes its meaning.
constexpr std::array<std::pair<int, int>, 5> instrumentKeys{{{Qt::Key_1, Qt::Key_5},
                                                             {Qt::Key_2, Qt::Key_6},
                                                             {Qt::Key_3, Qt::Key_7},
                                                             {Qt::Key_4, Qt::Key_8},
                                                             {Qt::Key_9, Qt::Key_0}}};

/// Instrument that a key mounts, if any.
std::optional<KeyAction> mountOf(int key) {
  for (std::size_t i = 0; i < std::min(instruments().size(), instrumentKeys.size()); ++i) {
    const auto& [driven, other] = instrumentKeys[i];
    if (key != driven && key != other) continue;
    KeyAction action;
    action.kind = KeyAction::Kind::mount;
    action.instrument = instruments()[i]->kind;
    action.otherHand = key == other;
    return action;
  }
  return std::nullopt;
}

/// "1 2 3 4 9", "5 6 7 8 0" and "grasper, hook, clip applier, scissors, probe". Keys are digits, whose codes are their
/// letters.
struct InstrumentHelp {
  std::string driven, other, names;
};
InstrumentHelp instrumentHelp() {
  InstrumentHelp out;
  const auto append = [](std::string& list, const char* between, const std::string& item) {
    list += (list.empty() ? std::string() : between) + item;
  };
  for (std::size_t i = 0; i < std::min(instruments().size(), instrumentKeys.size()); ++i) {
    append(out.driven, " ", std::string(1, static_cast<char>(instrumentKeys[i].first)));
    append(out.other, " ", std::string(1, static_cast<char>(instrumentKeys[i].second)));
    append(out.names, ", ", instruments()[i]->word);
  }
  return out;
}

}  // namespace

std::optional<KeyAction> actionOf(int key) {
  KeyAction action;
  const auto* const control =
      std::find_if(controls.begin(), controls.end(), [key](const auto& entry) { return entry.first == key; });
  if (control != controls.end()) {
    action.control = control->second;
    return action;
  }
  const auto* const scope =
      std::find_if(scopeControls.begin(), scopeControls.end(), [key](const auto& entry) { return entry.first == key; });
  if (scope != scopeControls.end()) {
    action.kind = KeyAction::Kind::scope;
    action.scope = scope->second;
    return action;
  }
  if (const std::optional<KeyAction> mount = mountOf(key)) return mount;
  switch (key) {
    case Qt::Key_V:
      action.kind = KeyAction::Kind::scopePedal;
      return action;
    case Qt::Key_X:
    case Qt::Key_C:
      action.kind = KeyAction::Kind::retraction;
      action.more = key == Qt::Key_X;
      return action;
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

std::vector<KeyHelp> keyHelp(bool mouse, bool scope, bool pauses) {
  const InstrumentHelp instruments = instrumentHelp();
  std::vector<KeyHelp> out;
  if (mouse) {
    out = {{"Mouse, arrows", "move the tip"},
           {"Wheel", "deeper into the picture, nearer"},
           {"Page Up, Down", "insert, draw back"},
           {"Left button, A", "close the jaws"},
           {"Right button, S", "open the jaws"},
           {"Q, W", "turn the shaft"},
           {"D, F", "pedals: cut, coagulate"},
           {"E", "set a clip"},
           {"R", "lock the jaws, let go"},
           {"Space", "the other hand"},
           {"Shift", "slowly"},
           {"Ctrl", "move the mouse alone"},
           {instruments.driven, instruments.names},
           {instruments.other, "the same for the other hand"}};
  } else {
    out = {{instruments.driven, "right hand: " + instruments.names}, {instruments.other, "the same for the left hand"}};
  }
  out.push_back({"X, C", "assistant: retract more, less", true});
  if (scope) {
    const std::vector<KeyHelp> keys{{"J, L, I, K", "endoscope: look left, right, up, down"},
                                    {"O, U", "endoscope: in, out"},
                                    {"T, G", "turn the light cable"},
                                    {"B, N", "turn the camera head"},
                                    {"V with the mouse", "move the endoscope"}};
    out.insert(out.end(), keys.begin(), keys.end());
  }
  if (pauses)
    out.push_back({"Escape", mouse ? "pause and free the mouse, go on" : "pause, go on"});
  else if (mouse)
    out.push_back({"Escape", "free the mouse, hold it again"});
  return out;
}

}  // namespace calot::gui
