// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/view/free_view.h"

#include <algorithm>
#include <cmath>
#include <QKeyEvent>
#include <QMouseEvent>
#include <QWheelEvent>

namespace calot::gui {
namespace {

constexpr double steepest = 1.5;  // rad: at the pole itself there is no right and left

Box extentOf(const SceneView& view) {
  Box box;
  for (const SurfaceView& surface : view.surface) {
    for (const Vec3& p : surface.position) box.include(p);
  }
  return box;
}

}  // namespace

OrbitCamera::OrbitCamera(const SceneView& view) : up_(-view.down), ahead_(Vec3::UnitX()), centre_(Vec3::Zero()) {
  const Box box = extentOf(view);
  const bool any = (box.lower.array() <= box.upper.array()).all();
  if (any) centre_ = 0.5 * (box.lower + box.upper);
  const double radius = std::max(0.01, any ? 0.5 * (box.upper - box.lower).norm() : 0.0);
  const Vec3 from = view.camera.position - centre_;
  const Vec3 level = from - from.dot(up_) * up_;
  ahead_ = level.norm() > 1e-9 ? Vec3(level.normalized()) : Vec3(up_.unitOrthogonal());
  pitch_ = std::clamp(std::atan2(from.dot(up_), level.norm()) + 0.15, 0.25, 1.2);
  angle_ = 0.6;
  distance_ = 3.0 * radius;
  least_ = 0.3 * radius;
  most_ = 12.0 * radius;
}

Vec3 OrbitCamera::back() const {
  const Vec3 aside = up_.cross(ahead_);
  return std::cos(pitch_) * (std::cos(angle_) * ahead_ + std::sin(angle_) * aside) + std::sin(pitch_) * up_;
}

void OrbitCamera::turn(double right, double up) {
  angle_ -= right;
  pitch_ = std::clamp(pitch_ + up, -steepest, steepest);
}

void OrbitCamera::zoom(double factor) { distance_ = std::clamp(distance_ * factor, least_, most_); }

void OrbitCamera::shift(double right, double down) {
  const double height = 2.0 * distance_ * std::tan(0.5 * field);
  const Mat3 axes = sample().orientation.toRotationMatrix();
  centre_ -= height * (right * axes.col(0) + down * axes.col(1));
}

CameraSample OrbitCamera::sample() const {
  const Vec3 away = back();
  Mat3 axes;  // right, down, forward
  axes.col(2) = -away;
  axes.col(0) = axes.col(2).cross(up_).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return {centre_ + distance_ * away, Quat(axes)};
}

FreeView::FreeView() : ScenePictureWidget(1) {
  setObjectName("free-view");
  setAccessibleName("Picture of the scene from anywhere");
  setFocusPolicy(Qt::StrongFocus);
  setToolTip("Drag to turn, with the right button to move, wheel to come nearer; Home goes back");
}

std::shared_ptr<const SceneView> FreeView::seen() const {
  auto view = std::make_shared<SceneView>(*newest_);
  view->camera = camera_->sample();
  view->verticalFieldOfView = OrbitCamera::field;
  return view;
}

void FreeView::follow(std::shared_ptr<const SceneView> view) {
  std::shared_ptr<const SceneView> shown;
  {
    const std::lock_guard lock(guard_);
    newest_ = std::move(view);
    if (!camera_) camera_.emplace(*newest_);
    if (!draws_) return;
    shown = seen();
  }
  showView(std::move(shown));
}

void FreeView::move(const std::function<void(OrbitCamera&)>& change) {
  std::shared_ptr<const SceneView> shown;
  {
    const std::lock_guard lock(guard_);
    if (!newest_) return;
    change(*camera_);
    shown = seen();
  }
  showView(std::move(shown));
}

void FreeView::home() {
  move([this](OrbitCamera& camera) { camera = OrbitCamera(*newest_); });
}

void FreeView::forget(const QString& text) {
  {
    const std::lock_guard lock(guard_);
    newest_.reset();
    camera_.reset();
  }
  showText(text);
}

std::optional<CameraSample> FreeView::camera() const {
  const std::lock_guard lock(guard_);
  return camera_ ? std::optional(camera_->sample()) : std::nullopt;
}

void FreeView::showEvent(QShowEvent* event) {
  ScenePictureWidget::showEvent(event);
  {
    const std::lock_guard lock(guard_);
    draws_ = true;
  }
  move([](OrbitCamera&) {});
}

void FreeView::hideEvent(QHideEvent* event) {
  ScenePictureWidget::hideEvent(event);
  const std::lock_guard lock(guard_);
  draws_ = false;
}

void FreeView::mousePressEvent(QMouseEvent* event) { last_ = event->pos(); }

void FreeView::mouseMoveEvent(QMouseEvent* event) {
  const QPointF way = QPointF(event->pos() - last_) / std::max(1, height());
  last_ = event->pos();
  const bool shifts = event->buttons().testFlag(Qt::RightButton);
  move([&](OrbitCamera& camera) {
    constexpr double half = 3.0;  // rad for a way as long as the picture is high
    shifts ? camera.shift(way.x(), way.y()) : camera.turn(half * way.x(), half * way.y());
  });
}

void FreeView::mouseDoubleClickEvent(QMouseEvent*) { home(); }

void FreeView::wheelEvent(QWheelEvent* event) {
  move([&](OrbitCamera& camera) { camera.zoom(std::pow(0.9, event->angleDelta().y() / 120.0)); });
}

void FreeView::keyPressEvent(QKeyEvent* event) {
  constexpr double turn = 0.1, shift = 0.05, nearer = 0.9;
  const bool shifts = event->modifiers().testFlag(Qt::ShiftModifier);
  const auto go = [&](double right, double up) {
    move([&](OrbitCamera& camera) {
      shifts ? camera.shift(-shift * right, shift * up) : camera.turn(turn * right, turn * up);
    });
  };
  switch (event->key()) {
    case Qt::Key_Left:
      return go(-1.0, 0.0);
    case Qt::Key_Right:
      return go(1.0, 0.0);
    case Qt::Key_Up:
      return go(0.0, 1.0);
    case Qt::Key_Down:
      return go(0.0, -1.0);
    case Qt::Key_Plus:
    case Qt::Key_Equal:
      return move([&](OrbitCamera& camera) { camera.zoom(nearer); });
    case Qt::Key_Minus:
      return move([&](OrbitCamera& camera) { camera.zoom(1.0 / nearer); });
    case Qt::Key_Home:
      return home();
    default:
      ScenePictureWidget::keyPressEvent(event);
  }
}

}  // namespace calot::gui
