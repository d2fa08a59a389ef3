// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/renderer.h"

#include <condition_variable>
#include <deque>
#include <future>
#include <mutex>
#include <thread>

#include "gui/render/graphics_context.h"
#include "gui/render/scene_painter.h"
#include "gui/render/view_check.h"

namespace calot::gui {

/// A thread that owns context and painter and serves requests one at a time.
class Renderer::Worker {
 public:
  Worker() {
    std::promise<void> started;
    std::future<void> ready = started.get_future();
    thread_ = std::thread([this, &started] { run(started); });
    try {
      ready.get();
    } catch (...) {
      thread_.join();
      throw;
    }
  }
  ~Worker() {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      stopping_ = true;
    }
    wake_.notify_one();
    thread_.join();
  }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  Image render(const SceneView& view, int width, int height, const RenderSettings& settings,
               std::span<const Puff> smoke) {
    std::packaged_task<Image(ScenePainter&)> task([&](ScenePainter& painter) {
      const Sight sight = sightOf(width, height, view.verticalFieldOfView, settings.endoscopeMask);
      return painter.paint(drawLists_.make(view, sight, settings.cavity, smoke), sight, view.verticalFieldOfView, width,
                           height, settings);
    });
    std::future<Image> image = task.get_future();
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      tasks_.push_back(std::move(task));
    }
    wake_.notify_one();
    return image.get();
  }

 private:
  void run(std::promise<void>& started) {
    std::unique_ptr<GraphicsContext> context;
    std::unique_ptr<ScenePainter> painter;
    try {
      context = createSoftwareContext();
      context->makeCurrent();
      painter = std::make_unique<ScenePainter>(*context);
      started.set_value();
    } catch (...) {
      painter.reset();
      started.set_exception(std::current_exception());
      return;
    }
    while (true) {
      std::packaged_task<Image(ScenePainter&)> task;
      {
        std::unique_lock<std::mutex> lock(mutex_);
        wake_.wait(lock, [this] { return stopping_ || !tasks_.empty(); });
        if (tasks_.empty()) return;
        task = std::move(tasks_.front());
        tasks_.pop_front();
      }
      task(*painter);
    }
  }

  DrawListMaker drawLists_;  ///< on the thread
  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<std::packaged_task<Image(ScenePainter&)>> tasks_;
  bool stopping_ = false;
  std::thread thread_;
};

Renderer::Renderer() : worker_(std::make_unique<Worker>()) {}
Renderer::~Renderer() = default;

Image Renderer::render(const SceneView& view, int width, int height, const RenderSettings& settings,
                       std::span<const Puff> smoke) {
  checkPictureSize(width, height);
  checkView(view);
  checkSmoke(smoke);
  return worker_->render(view, width, height, settings, smoke);
}

}  // namespace calot::gui
