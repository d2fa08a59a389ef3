// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/view/picture_loop.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <string>
#include <utility>

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

}  // namespace

PictureLoop::PictureLoop(MakeDraw make, Receiver receiver, std::size_t drawers, double rate)
    : make_(std::move(make)), receiver_(std::move(receiver)), scale_(rate, drawers) {
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
  stale_ = reduced_ = false;
}

bool PictureLoop::take(bool warm, Work& work) {
  std::unique_lock lock(mutex_);
  const auto due = [&] { return stop_ || (newest_ != nullptr && width_ > 0 && height_ > 0 && (stale_ || !warm)); };
  bool rests = false;  // no view came for a moment after one that was drawn smaller
  while (!due() && !rests) {
    if (!reduced_)
      wake_.wait(lock);
    else
      rests = wake_.wait_for(lock, moment) == std::cv_status::timeout && reduced_;
  }
  if (stop_) return false;
  work.view = newest_;
  work.side = rests && !stale_ ? 1.0 : scale_.side();
  if (work.side * std::min(width_, height_) < minSide) work.side = 1.0;
  work.width = static_cast<int>(std::lround(work.side * width_));
  work.height = static_cast<int>(std::lround(work.side * height_));
  const bool wanted = std::exchange(stale_, false) || rests;
  work.number = wanted ? ++taken_ : 0;
  if (wanted) reduced_ = work.side < 1.0;
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
      picture.image = draw(*picture.view, work.width, work.height);
    } catch (const std::exception& error) {
      fault = error.what();
    }
    if (warm) {
      const std::lock_guard lock(mutex_);
      scale_.drew(work.side, std::chrono::duration<double>(Clock::now() - begin).count());
    }
    warm = true;
    const std::lock_guard lock(delivering_);
    if (work.number == 0 || work.number < delivered_) continue;
    delivered_ = work.number;
    if (fault.empty())
      receiver_.picture(std::move(picture));
    else
      receiver_.failed(fault);
  }
}

}  // namespace calot::gui
