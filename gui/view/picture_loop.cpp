// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/view/picture_loop.h"

#include <exception>
#include <utility>

#include "gui/view/thread_rank.h"

namespace calot::gui {

PictureLoop::PictureLoop(MakeDraw make, Receiver receiver)
    : make_(std::move(make)), receiver_(std::move(receiver)), thread_([this] { run(); }) {}

PictureLoop::~PictureLoop() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void PictureLoop::show(std::shared_ptr<const SceneView> view) {
  {
    const std::lock_guard lock(mutex_);
    newest_ = std::move(view);
    stale_ = true;
  }
  wake_.notify_one();
}

void PictureLoop::resize(int width, int height) {
  {
    const std::lock_guard lock(mutex_);
    if (width == width_ && height == height_) return;
    width_ = width;
    height_ = height;
    stale_ = newest_ != nullptr;
  }
  wake_.notify_one();
}

void PictureLoop::clear() {
  const std::lock_guard lock(mutex_);
  newest_.reset();
  stale_ = false;
}

void PictureLoop::run() {
  // Before what draws starts threads of its own.
  stepBack(behindEverything);
  Draw draw;
  for (;;) {
    ScenePicture picture;
    int width = 0, height = 0;
    {
      std::unique_lock lock(mutex_);
      wake_.wait(lock, [this] { return stop_ || (stale_ && width_ > 0 && height_ > 0); });
      if (stop_) return;
      picture.view = newest_;
      width = width_;
      height = height_;
      stale_ = false;
    }
    try {
      if (!draw) draw = make_();
      picture.image = draw(*picture.view, width, height);
    } catch (const std::exception& error) {
      receiver_.failed(error.what());
      continue;
    }
    receiver_.picture(std::move(picture));
  }
}

}  // namespace calot::gui
