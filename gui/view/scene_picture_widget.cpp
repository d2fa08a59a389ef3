// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/view/scene_picture_widget.h"

#include <algorithm>
#include <cmath>
#include <QMetaObject>
#include <QPainter>
#include <utility>

#include "gui/render/renderer.h"

namespace calot::gui {
namespace {

Graphics chosen = Graphics::automatic;  // of the GUI thread

PictureLoop::Draw drawWith(const std::shared_ptr<Renderer>& renderer, bool ready) {
  RenderSettings settings;
  settings.quality = Quality::interactive;
  settings.ready = ready;
  return [renderer, settings](const SceneView& view, int width, int height) {
    return renderer->render(view, width, height, settings);
  };
}

/// The widget's size in pixels, within what a renderer takes.
QSize pictureSize(const QSize& size, double ratio) {
  double width = std::clamp(size.width() * ratio, double(minSide), double(maxSide));
  double height = std::clamp(size.height() * ratio, double(minSide), double(maxSide));
  const double shrink = std::min(1.0, std::sqrt(static_cast<double>(maxPixels) / (width * height)));
  width = std::max(double(minSide), std::floor(width * shrink));
  height = std::max(double(minSide), std::floor(height * shrink));
  return {static_cast<int>(width), static_cast<int>(height)};
}

}  // namespace

ScenePictureWidget::ScenePictureWidget(QWidget* parent, std::size_t drawers, double rate) : QWidget(parent) {
  setObjectName("scene");
  setAccessibleName("Picture of the scene");
  setAttribute(Qt::WA_OpaquePaintEvent);
  loop_ = std::make_unique<PictureLoop>(
      [this, graphics = chosen, ready = rate > 0.0] {
        const auto renderer = std::make_shared<Renderer>(graphics);
        const std::lock_guard lock(mutex_);
        drawnBy_ = renderer->graphics();
        return drawWith(renderer, ready);
      },
      PictureLoop::Receiver{[this](ScenePicture picture) {
                              const std::lock_guard lock(mutex_);
                              const bool waiting = newest_.view != nullptr;
                              newest_ = std::move(picture);
                              // One call is under way already: it takes this picture.
                              if (!waiting)
                                QMetaObject::invokeMethod(
                                    this, [this] { takePicture(); }, Qt::QueuedConnection);
                            },
                            [this](const std::string& fault) {
                              const QString text = QString::fromStdString(fault);
                              QMetaObject::invokeMethod(
                                  this, [this, text] { takeFailure(text); }, Qt::QueuedConnection);
                            }},
      drawers, rate);
}

ScenePictureWidget::~ScenePictureWidget() { loop_.reset(); }

void ScenePictureWidget::drawBy(Graphics graphics) { chosen = graphics; }

std::string ScenePictureWidget::drawnBy() const {
  const std::lock_guard lock(mutex_);
  return drawnBy_;
}

double ScenePictureWidget::side() const {
  if (picture_.isNull()) return 1.0;
  return std::min(1.0, static_cast<double>(picture_.width()) / pictureSize(size(), devicePixelRatioF()).width());
}

void ScenePictureWidget::showView(std::shared_ptr<const SceneView> view) {
  QMetaObject::invokeMethod(
      this, [this] { awaits_ = true; }, Qt::AutoConnection);
  loop_->show(std::move(view));
}

void ScenePictureWidget::showText(const QString& text) {
  loop_->clear();
  awaits_ = false;
  text_ = text;
  picture_ = {};
  update();
}

void ScenePictureWidget::takePicture() {
  ScenePicture taken;
  {
    const std::lock_guard lock(mutex_);
    taken = std::exchange(newest_, {});
  }
  if (!awaits_ || taken.view == nullptr) return;
  const Image& image = taken.image;
  picture_ = QImage(image.rgba.data(), image.width, image.height, 4 * image.width, QImage::Format_RGBA8888)
                 .convertToFormat(QImage::Format_RGB32);
  text_.clear();
  ++shown_;
  update();
  emit pictureShown(taken.view->step, taken.view->time);
}

void ScenePictureWidget::takeFailure(const QString& text) {
  text_ = text;
  picture_ = {};
  update();
}

void ScenePictureWidget::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  painter.fillRect(rect(), Qt::black);
  if (!picture_.isNull()) {
    // While the widget is being resized the picture has another shape for a moment.
    const QSize fitted = picture_.size().scaled(size(), Qt::KeepAspectRatio);
    const QRect target(QPoint((width() - fitted.width()) / 2, (height() - fitted.height()) / 2), fitted);
    if (fitted != picture_.size()) painter.setRenderHint(QPainter::SmoothPixmapTransform);
    painter.drawImage(target, picture_);
  }
  if (!text_.isEmpty()) {
    painter.setPen(QColor(0xf0, 0xf0, 0xf0));
    painter.drawText(rect().adjusted(16, 16, -16, -16), Qt::AlignCenter | Qt::TextWordWrap, text_);
  }
}

void ScenePictureWidget::resizeEvent(QResizeEvent*) {
  const QSize wanted = pictureSize(size(), devicePixelRatioF());
  loop_->resize(wanted.width(), wanted.height());
}

}  // namespace calot::gui
