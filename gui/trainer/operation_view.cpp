// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/operation_view.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <QCursor>
#include <QKeyEvent>
#include <QMouseEvent>
#include <Qt>
#include <QWheelEvent>
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

double squared(QPointF p) { return QPointF::dotProduct(p, p); }

constexpr double notch = 120.0;           // of QWheelEvent::angleDelta
constexpr std::size_t drawersAtOnce = 2;  // the picture follows the hand: it is to come as often as the machine can
constexpr double wantedRate = 100.0 / 3;  // pictures a second, as many as are handed out (ViewTap)

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

QPointF PointerTrack::moved(QPointF now) {
  const QPointF last = last_.value_or(now);
  last_ = now;
  if (put_ && squared(now - *put_) <= squared(now - last)) return now - *std::exchange(put_, std::nullopt);
  return now - last;
}

using recorder::MouseControl;

OperationView::OperationView(std::shared_ptr<recorder::MouseInput> mouse, std::shared_ptr<recorder::ScopeInput> scope)
    : ScenePictureWidget(drawersAtOnce, wantedRate),
      mouse_(std::move(mouse)),
      scope_(std::move(scope)),
      over_(new PictureOverlay(this)) {
  setObjectName("operation");
  setAccessibleName("Picture of the operation");
  setAccessibleDescription("Mouse and keyboard drive an instrument here; Escape frees the mouse, Tab leaves.");
  setFocusPolicy(Qt::StrongFocus);
  setMouseTracking(true);
}

OperationView::~OperationView() {
  if (holds_) releaseMouse();
}

void OperationView::setActive(bool active) {
  if (active == active_) return;
  active_ = active;
  pointer_.begin();
  releaseAll();
  holdPointer(active && hasFocus());
}

void OperationView::holdPointer(bool hold) {
  hold = hold && mouse_ != nullptr;
  if (hold == holds_) return;
  holds_ = hold;
  pointer_.begin();
  if (hold) {
    setCursor(Qt::BlankCursor);
    grabMouse();
    putPointerBack();
  } else {
    releaseMouse();
    setCursor(Qt::ArrowCursor);
  }
  emit pointerHeld(hold);
}

void OperationView::putPointerBack() {
  const QPoint middle = rect().center();
  const QPoint there = mapToGlobal(middle);
  QCursor::setPos(there);
  // Some window systems let no program move the pointer; there it stops at the screen's edge.
  bounded_ = QCursor::pos() != there;
  if (!bounded_) pointer_.put(middle);
}

void OperationView::releaseAll() {
  if (mouse_) mouse_->release();
  if (scope_) scope_->release();
}

void OperationView::act(const KeyAction& action, bool held) {
  switch (action.kind) {
    case KeyAction::Kind::control:
      if (mouse_) mouse_->hold(action.control, held);
      break;
    case KeyAction::Kind::scope:
      if (scope_) scope_->hold(action.scope, held);
      break;
    case KeyAction::Kind::scopePedal:
      if (scope_) scope_->pressPedal(held);
      break;
    case KeyAction::Kind::switchHand:
      if (!mouse_ || !held) break;
      mouse_->switchHand();
      emit handSwitched();
      break;
    case KeyAction::Kind::toggleLock:
      if (mouse_ && held) mouse_->toggleLock();
      break;
    case KeyAction::Kind::mount:
      if (held) emit mountRequested(action.instrument, action.otherHand);
      break;
    case KeyAction::Kind::retraction:
      if (held) emit retractionRequested(action.more);
      break;
    case KeyAction::Kind::pause:
      break;  // at any time
  }
}

void OperationView::keyPressEvent(QKeyEvent* event) {
  const std::optional<KeyAction> action = actionOf(event->key());
  if (!action || (event->modifiers() & (Qt::ControlModifier | Qt::AltModifier)) != 0) {
    ScenePictureWidget::keyPressEvent(event);
    return;
  }
  if (event->isAutoRepeat()) return;
  if (action->kind != KeyAction::Kind::pause) {
    if (active_) act(*action, true);
    return;
  }
  emit pauseRequested();
  if (!active_ || !mouse_) return;  // where there is no pause, the key is the pointer's alone
  releaseAll();
  holdPointer(!holds_);
}

void OperationView::keyReleaseEvent(QKeyEvent* event) {
  const std::optional<KeyAction> action = actionOf(event->key());
  if (event->isAutoRepeat()) return;
  if (action)
    act(*action, false);
  else
    ScenePictureWidget::keyReleaseEvent(event);
}

void OperationView::holdButton(Qt::MouseButton button, bool held) {
  if (!mouse_) return;
  if (button == Qt::LeftButton) mouse_->hold(MouseControl::closeJaw, held);
  if (button == Qt::RightButton) mouse_->hold(MouseControl::openJaw, held);
}

void OperationView::mousePressEvent(QMouseEvent* event) {
  if (!active_) return;
  if (mouse_ && !holds_) {
    holdPointer(true);  // the click does that alone
    return;
  }
  holdButton(event->button(), true);
}

void OperationView::mouseReleaseEvent(QMouseEvent* event) { holdButton(event->button(), false); }

void OperationView::mouseMoveEvent(QMouseEvent* event) {
  const QPointF now = event->position();
  if (!active_ || (mouse_ ? !holds_ : !scope_ || !rect().contains(now.toPoint()))) {
    pointer_.begin();
    return;
  }
  const QPointF moved = pointer_.moved(now);
  const QPointF fromMiddle = now - rect().center();
  if (holds_ && !pointer_.isPutBack() &&
      (4.0 * std::abs(fromMiddle.x()) > width() || 4.0 * std::abs(fromMiddle.y()) > height()))
    putPointerBack();
  if ((event->modifiers() & Qt::ControlModifier) != 0) return;
  if (scope_ && scope_->pedal())
    scope_->move(moved.x(), moved.y());
  else if (mouse_)
    mouse_->move(moved.x(), moved.y());
}

void OperationView::wheelEvent(QWheelEvent* event) {
  const double notches = static_cast<double>(event->angleDelta().y()) / notch;
  if (active_ && scope_ && scope_->pedal())
    scope_->turnWheel(notches);
  else if (active_ && mouse_ && holds_)
    mouse_->turnWheel(notches);
  event->accept();
}

void OperationView::leaveEvent(QEvent* event) {
  if (!holds_) pointer_.begin();
  ScenePictureWidget::leaveEvent(event);
}

void OperationView::focusInEvent(QFocusEvent* event) {
  // A window that comes back does not take the mouse by itself: a click or Escape does.
  if (active_ && event->reason() != Qt::ActiveWindowFocusReason && event->reason() != Qt::MouseFocusReason)
    holdPointer(true);
  ScenePictureWidget::focusInEvent(event);
}

void OperationView::focusOutEvent(QFocusEvent* event) {
  releaseAll();
  holdPointer(false);
  ScenePictureWidget::focusOutEvent(event);
}

void OperationView::resizeEvent(QResizeEvent* event) {
  ScenePictureWidget::resizeEvent(event);
  over_->setGeometry(rect());
}

}  // namespace calot::gui
