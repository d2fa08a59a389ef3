// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/operation_view.h"

#include <cstddef>
#include <QKeyEvent>
#include <QMouseEvent>
#include <QWheelEvent>
#include <utility>

namespace calot::gui {

using recorder::MouseControl;

namespace {
constexpr double notch = 120.0;           // of QWheelEvent::angleDelta
constexpr std::size_t drawersAtOnce = 2;  // the picture follows the hand: it is to come as often as the machine can
constexpr double wantedRate = 30.0;       // pictures a second, as many as are handed out (ViewTap)
}  // namespace

OperationView::OperationView(std::shared_ptr<recorder::MouseInput> mouse, std::shared_ptr<recorder::ScopeInput> scope,
                             QWidget* parent)
    : ScenePictureWidget(parent, drawersAtOnce, wantedRate), mouse_(std::move(mouse)), scope_(std::move(scope)) {
  setObjectName("operation");
  setAccessibleName("Picture of the operation");
  setAccessibleDescription("Mouse and keyboard drive an instrument here; Escape holds the run, Tab leaves.");
  setFocusPolicy(Qt::StrongFocus);
  setMouseTracking(true);
}

void OperationView::setActive(bool active) {
  if (active == active_) return;
  active_ = active;
  last_.reset();
  setCursor(active && mouse_ ? Qt::CrossCursor : Qt::ArrowCursor);
  releaseAll();
}

void OperationView::releaseAll() {
  if (mouse_) mouse_->release();
  if (scope_) scope_->release();
}

void OperationView::press(const KeyAction& action) {
  switch (action.kind) {
    case KeyAction::Kind::control:
      if (mouse_) mouse_->hold(action.control, true);
      break;
    case KeyAction::Kind::switchHand:
      if (!mouse_) break;
      mouse_->switchHand();
      emit handSwitched();
      break;
    case KeyAction::Kind::toggleLock:
      if (mouse_) mouse_->toggleLock();
      break;
    case KeyAction::Kind::mount:
      emit mountRequested(action.instrument, action.otherHand);
      break;
    case KeyAction::Kind::scope:
      if (scope_) scope_->hold(action.scope, true);
      break;
    case KeyAction::Kind::scopePedal:
      if (scope_) scope_->pressPedal(true);
      break;
    case KeyAction::Kind::pause:
      break;  // at any time
  }
}

void OperationView::release(const KeyAction& action) {
  if (mouse_ && action.kind == KeyAction::Kind::control) mouse_->hold(action.control, false);
  if (scope_ && action.kind == KeyAction::Kind::scope) scope_->hold(action.scope, false);
  if (scope_ && action.kind == KeyAction::Kind::scopePedal) scope_->pressPedal(false);
}

void OperationView::keyPressEvent(QKeyEvent* event) {
  const std::optional<KeyAction> action = actionOf(event->key());
  if (!action || (event->modifiers() & (Qt::ControlModifier | Qt::AltModifier)) != 0) {
    ScenePictureWidget::keyPressEvent(event);
    return;
  }
  if (event->isAutoRepeat()) return;
  if (action->kind == KeyAction::Kind::pause)
    emit pauseRequested();
  else if (active_)
    press(*action);
}

void OperationView::keyReleaseEvent(QKeyEvent* event) {
  const std::optional<KeyAction> action = actionOf(event->key());
  if (event->isAutoRepeat()) return;
  if (action)
    release(*action);
  else
    ScenePictureWidget::keyReleaseEvent(event);
}

void OperationView::holdButton(Qt::MouseButton button, bool held) {
  if (!mouse_) return;
  if (button == Qt::LeftButton) mouse_->hold(MouseControl::closeJaw, held);
  if (button == Qt::RightButton) mouse_->hold(MouseControl::openJaw, held);
}

void OperationView::mousePressEvent(QMouseEvent* event) {
  if (active_) holdButton(event->button(), true);
}

void OperationView::mouseReleaseEvent(QMouseEvent* event) { holdButton(event->button(), false); }

void OperationView::mouseMoveEvent(QMouseEvent* event) {
  const QPointF now = event->position();
  // A button keeps the pointer's events here beyond the border; the hand stays where the picture ends.
  if (!active_ || !(mouse_ || scope_) || !rect().contains(now.toPoint()) ||
      (event->modifiers() & Qt::ControlModifier) != 0) {
    last_.reset();
    return;
  }
  if (last_) {
    const QPointF moved = now - *last_;
    if (scope_ && scope_->pedal())
      scope_->move(moved.x(), moved.y());
    else if (mouse_)
      mouse_->move(moved.x(), moved.y());
  }
  last_ = now;
}

void OperationView::wheelEvent(QWheelEvent* event) {
  const double notches = static_cast<double>(event->angleDelta().y()) / notch;
  if (active_ && scope_ && scope_->pedal())
    scope_->turnWheel(notches);
  else if (active_ && mouse_)
    mouse_->turnWheel(notches);
  event->accept();
}

void OperationView::leaveEvent(QEvent* event) {
  last_.reset();
  ScenePictureWidget::leaveEvent(event);
}

void OperationView::focusOutEvent(QFocusEvent* event) {
  releaseAll();
  ScenePictureWidget::focusOutEvent(event);
}

}  // namespace calot::gui
