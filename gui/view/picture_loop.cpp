// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/view/picture_loop.h"

#include <exception>
#include <string>
#include <utility>

#include "gui/view/thread_rank.h"

namespace calot::gui {

PictureLoop::PictureLoop(MakeDraw make, Receiver receiver, std::size_t drawers)
    : make_(std::move(make)), receiver_(std::move(receiver)) {
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
  stale_ = false;
}

void PictureLoop::run() {
  // Before what draws starts threads of its own.
  stepBack(behindEverything);
  Draw draw;
  bool warm = false;  // has drawn: the first picture takes seconds, in which programs are compiled
  for (;;) {
    ScenePicture picture;
    int width = 0, height = 0;
    bool wanted = false;
    std::uint64_t number = 0;
    {
      std::unique_lock lock(mutex_);
      wake_.wait(lock, [&] { return stop_ || (newest_ != nullptr && width_ > 0 && height_ > 0 && (stale_ || !warm)); });
      if (stop_) return;
      picture.view = newest_;
      width = width_;
      height = height_;
      wanted = std::exchange(stale_, false);
      if (wanted) number = ++taken_;
    }
    std::string fault;
    try {
      if (!draw) draw = make_();
      picture.image = draw(*picture.view, width, height);
    } catch (const std::exception& error) {
      fault = error.what();
    }
    warm = true;
    const std::lock_guard lock(delivering_);
    if (!wanted || number < delivered_) continue;
    delivered_ = number;
    if (fault.empty())
      receiver_.picture(std::move(picture));
    else
      receiver_.failed(fault);
  }
}

}  // namespace calot::gui
