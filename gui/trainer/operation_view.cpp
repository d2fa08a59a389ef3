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

OperationView::OperationView(std::shared_ptr<recorder::MouseInput> mouse, QWidget* parent)
    : ScenePictureWidget(parent, drawersAtOnce, wantedRate), mouse_(std::move(mouse)) {
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
  if (mouse_) mouse_->release();
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
  if (action->kind == KeyAction::Kind::pause)
    emit pauseRequested();
  else if (active_)
    press(*action);
}

void OperationView::keyReleaseEvent(QKeyEvent* event) {
  const std::optional<KeyAction> action = actionOf(event->key());
  if (event->isAutoRepeat()) return;
  if (!action) {
    ScenePictureWidget::keyReleaseEvent(event);
  } else if (mouse_ && action->kind == KeyAction::Kind::control) {
    mouse_->hold(action->control, false);
  }
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
  if (!active_ || !mouse_ || !rect().contains(now.toPoint()) || (event->modifiers() & Qt::ControlModifier) != 0) {
    last_.reset();
    return;
  }
  if (last_) mouse_->move(now.x() - last_->x(), now.y() - last_->y());
  last_ = now;
}

void OperationView::wheelEvent(QWheelEvent* event) {
  if (active_ && mouse_) mouse_->turnWheel(static_cast<double>(event->angleDelta().y()) / notch);
  event->accept();
}

void OperationView::leaveEvent(QEvent* event) {
  last_.reset();
  ScenePictureWidget::leaveEvent(event);
}

void OperationView::focusOutEvent(QFocusEvent* event) {
  if (mouse_) mouse_->release();
  ScenePictureWidget::focusOutEvent(event);
}

}  // namespace calot::gui
