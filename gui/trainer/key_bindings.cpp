// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/key_bindings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <array>
#include <Qt>
#include <string_view>
#include <utility>

#include "sim/instruments/instruments.h"

namespace calot::gui {

using recorder::MouseControl;
using recorder::ScopeControl;

namespace {

using Kind = KeyAction::Kind;

// Letters that lie at one place on all keyboards of Latin letters but the French.
constexpr std::array<std::pair<int, KeyAction>, 31> bindings{{
    {Qt::Key_Right, {.control = MouseControl::right}},
    {Qt::Key_Left, {.control = MouseControl::left}},
    {Qt::Key_Down, {.control = MouseControl::down}},
    {Qt::Key_Up, {.control = MouseControl::up}},
    {Qt::Key_PageUp, {.control = MouseControl::in}},
    {Qt::Key_PageDown, {.control = MouseControl::out}},
    {Qt::Key_W, {.control = MouseControl::rollRight}},
    {Qt::Key_Q, {.control = MouseControl::rollLeft}},
    {Qt::Key_S, {.control = MouseControl::openJaw}},
    {Qt::Key_A, {.control = MouseControl::closeJaw}},
    {Qt::Key_D, {.control = MouseControl::cut}},
    {Qt::Key_F, {.control = MouseControl::coagulate}},
    {Qt::Key_E, {.control = MouseControl::fire}},
    {Qt::Key_Shift, {.control = MouseControl::fine}},
    {Qt::Key_L, {.kind = Kind::scope, .scope = ScopeControl::right}},
    {Qt::Key_J, {.kind = Kind::scope, .scope = ScopeControl::left}},
    {Qt::Key_I, {.kind = Kind::scope, .scope = ScopeControl::up}},
    {Qt::Key_K, {.kind = Kind::scope, .scope = ScopeControl::down}},
    {Qt::Key_O, {.kind = Kind::scope, .scope = ScopeControl::in}},
    {Qt::Key_U, {.kind = Kind::scope, .scope = ScopeControl::out}},
    {Qt::Key_G, {.kind = Kind::scope, .scope = ScopeControl::cableRight}},
    {Qt::Key_T, {.kind = Kind::scope, .scope = ScopeControl::cableLeft}},
    {Qt::Key_N, {.kind = Kind::scope, .scope = ScopeControl::headRight}},
    {Qt::Key_B, {.kind = Kind::scope, .scope = ScopeControl::headLeft}},
    {Qt::Key_V, {.kind = Kind::scopePedal}},
    {Qt::Key_X, {.kind = Kind::retraction, .more = true}},
    {Qt::Key_C, {.kind = Kind::retraction}},
    {Qt::Key_Space, {.kind = Kind::switchHand}},
    {Qt::Key_R, {.kind = Kind::toggleLock}},
    {Qt::Key_P, {.kind = Kind::pause}},
    {Qt::Key_Escape, {.kind = Kind::pause}},
}};

/// Keys of the instruments, in the order of their list, for the hand that is driven and for the other one: digits,
/// whose codes are their letters. A new instrument takes the next pair, so that no key ever changes its meaning.
constexpr std::string_view drivenKeys = "12349", otherKeys = "56780";

std::size_t keyedInstruments() { return std::min(instruments().size(), drivenKeys.size()); }

}  // namespace

std::optional<KeyAction> actionOf(int key) {
  const auto* const bound =
      std::find_if(bindings.begin(), bindings.end(), [key](const auto& entry) { return entry.first == key; });
  if (bound != bindings.end()) return bound->second;
  for (std::size_t i = 0; i < keyedInstruments(); ++i)
    if (key == drivenKeys[i] || key == otherKeys[i])
      return KeyAction{.kind = Kind::mount, .instrument = instruments()[i]->kind, .otherHand = key == otherKeys[i]};
  return std::nullopt;
}

std::vector<KeyHelp> keyHelp(bool mouse, bool scope, bool pauses) {
  const std::size_t keyed = keyedInstruments();
  const std::string driven = fmt::format("{}", fmt::join(drivenKeys.substr(0, keyed), " "));
  const std::string other = fmt::format("{}", fmt::join(otherKeys.substr(0, keyed), " "));
  std::string names;
  for (std::size_t i = 0; i < keyed; ++i) names += std::string(i == 0 ? "" : ", ") + instruments()[i]->word;
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
           {driven, names},
           {other, "the same for the other hand"}};
  } else {
    out = {{driven, "right hand: " + names}, {other, "the same for the left hand"}};
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
