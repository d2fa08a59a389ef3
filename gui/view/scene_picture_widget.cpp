// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/view/scene_picture_widget.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <QMetaObject>
#include <QPainter>
#include <utility>

#include "gui/render/every_look.h"
#include "gui/render/renderer.h"
#include "gui/view/thread_rank.h"

namespace calot::gui {

void PictureScale::take(std::size_t level) {
  level_ = level;
  sum_ = 0.0;
  count_ = 0;
}

void PictureScale::drew(double side, double seconds) {
  if (rate_ <= 0.0 || side != sides[level_]) return;
  sum_ += seconds;
  if (++count_ < enough) return;
  const double possible = drawers_ * count_ / sum_;
  if (possible < rate_ && level_ + 1 < sides.size()) {
    // At least as far as would do if all of the cost went with the pixels.
    const double most = sides[level_] * std::sqrt(possible / rate_);
    std::size_t level = level_ + 1;
    while (level + 1 < sides.size() && sides[level] > most) ++level;
    return take(level);
  }
  if (level_ > 0) {
    const double growth = sides[level_ - 1] / sides[level_];
    if (possible > spare * rate_ * growth * growth) return take(level_ - 1);
  }
  take(level_);
}

namespace {

/// After which a picture stands still.
constexpr std::chrono::milliseconds moment(250);

Graphics chosen = Graphics::automatic;  // of the GUI thread

PictureLoop::Draw drawWith(const std::shared_ptr<Renderer>& renderer, bool ready) {
  return [renderer, ready](const SceneView& view, int width, int height, bool still) {
    RenderSettings settings;
    settings.quality = still ? Quality::film : Quality::interactive;
    settings.ready = ready;
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

PictureLoop::PictureLoop(MakeDraw make, Receiver receiver, std::size_t drawers, double rate, bool refine)
    : make_(std::move(make)), receiver_(std::move(receiver)), refine_(refine), scale_(rate, drawers) {
  for (std::size_t d = 0; d < drawers; ++d) threads_.emplace_back([this] { run(); });
}

PictureLoop::~PictureLoop() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void PictureLoop::show(std::shared_ptr<const SceneView> view) {
  {
    const std::lock_guard lock(mutex_);
    newest_ = std::move(view);
    stale_ = true;
  }
  wake_.notify_all();
}

void PictureLoop::resize(int width, int height) {
  {
    const std::lock_guard lock(mutex_);
    if (width == width_ && height == height_) return;
    width_ = width;
    height_ = height;
    stale_ = newest_ != nullptr;
  }
  wake_.notify_all();
}

void PictureLoop::clear() {
  const std::lock_guard lock(mutex_);
  newest_.reset();
  stale_ = rough_ = false;
}

void PictureLoop::prepare(std::shared_ptr<const SceneView> view) {
  {
    const std::lock_guard lock(mutex_);
    if (!drawn_ && newest_ == nullptr) prepared_ = std::move(view);
  }
  wake_.notify_all();
}

bool PictureLoop::take(bool warm, Work& work) {
  std::unique_lock lock(mutex_);
  const auto due = [&] {
    if (stop_ || prepared_ != nullptr) return true;
    return newest_ != nullptr && width_ > 0 && height_ > 0 && (stale_ || (!warm && drawn_));
  };
  bool rests = false;  // no view came for a moment after one that was drawn roughly
  while (!due() && !rests) {
    if (!rough_)
      wake_.wait(lock);
    else
      rests = wake_.wait_for(lock, moment) == std::cv_status::timeout && rough_;
  }
  if (stop_) return false;
  if (prepared_ != nullptr) {
    work = {std::exchange(prepared_, nullptr), minSide, minSide};
    return true;
  }
  work.view = newest_;
  work.still = rests && !stale_;
  work.side = work.still ? 1.0 : scale_.side();
  if (work.side * std::min(width_, height_) < minSide) work.side = 1.0;
  work.width = static_cast<int>(std::lround(work.side * width_));
  work.height = static_cast<int>(std::lround(work.side * height_));
  const bool wanted = std::exchange(stale_, false) || rests;
  work.number = wanted ? ++taken_ : 0;
  if (wanted) rough_ = !work.still && (refine_ || work.side < 1.0);
  return true;
}

void PictureLoop::run() {
  using Clock = std::chrono::steady_clock;
  // Before what draws starts threads of its own.
  stepBack(behindEverything);
  Draw draw;
  bool warm = false;  // has drawn: the first picture takes seconds, in which programs are compiled
  Work work;
  while (take(warm, work)) {
    ScenePicture picture{work.view, {}};
    std::string fault;
    const Clock::time_point begin = Clock::now();
    try {
      if (!draw) draw = make_();
      picture.image = draw(*picture.view, work.width, work.height, work.still);
    } catch (const std::exception& error) {
      fault = error.what();
    }
    if (warm && !work.still) {
      const std::lock_guard lock(mutex_);
      scale_.drew(work.side, std::chrono::duration<double>(Clock::now() - begin).count());
    }
    warm = true;
    {
      const std::lock_guard lock(mutex_);
      if (work.number > 0 && !std::exchange(drawn_, true)) wake_.notify_all();
    }
    const std::lock_guard lock(delivering_);
    if (work.number == 0 || work.number < delivered_) continue;
    delivered_ = work.number;
    if (fault.empty())
      receiver_.picture(std::move(picture));
    else
      receiver_.failed(fault);
  }
}

ScenePictureWidget::ScenePictureWidget(std::size_t drawers, double rate) {
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
      drawers, rate, true);
}

ScenePictureWidget::~ScenePictureWidget() { loop_.reset(); }

void ScenePictureWidget::prepare() { loop_->prepare(std::make_shared<const SceneView>(everyLook())); }

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
  time_ = taken.view->time;
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
