// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/renderer.h"

#include <fmt/format.h>

#include <condition_variable>
#include <deque>
#include <future>
#include <mutex>
#include <stop_token>
#include <thread>

#include "gui/render/scene_painter.h"
#include "gui/render/scene_resources.h"
#include "gui/render/view_check.h"
#include "recorder/base/errors.h"

namespace calot::gui {

/// A thread that owns context and painter and serves requests one at a time.
class Renderer::Worker {
 public:
  explicit Worker(Graphics graphics) : thread_([this](const std::stop_token& stop) { serve(stop); }) {
    perform([&] {
      begin(graphics);
      name_ = fmt::format("{}, {}", context_->way(), painter_->implementation());
    });
  }
  ~Worker() {
    perform([this] {
      const std::lock_guard<std::mutex> alone(compiling());
      painter_.reset();
      context_.reset();
    });
  }

  [[nodiscard]] const std::string& name() const { return name_; }

  Image render(const SceneView& view, int width, int height, const RenderSettings& settings,
               std::span<const Puff> smoke) {
    Image image;
    perform([&] {
      const Sight sight = sightOf(width, height, view.verticalFieldOfView, settings.endoscopeMask);
      const DrawList& list = drawLists_.make(view, sight, settings.cavity, smoke);
      const auto alone =
          noteLooks(looks_, list, settings) ? std::unique_lock(compiling()) : std::unique_lock<std::mutex>();
      image = painter_->paint(list, sight, view.verticalFieldOfView, width, height, settings);
    });
    return image;
  }

 private:
  /// Held while Mesa compiles, which is what its contexts share most. (Two crashes were seen in hundreds of runs in
  /// which two contexts drew; nobody could bring one about.)
  static std::mutex& compiling() {
    static std::mutex lock;
    return lock;
  }

  void begin(Graphics graphics) {
    if (graphics == Graphics::automatic) {
      try {
        return begin(Graphics::card);
      } catch (const Error&) {  // no card, or one that lacks something
        return begin(Graphics::software);
      }
    }
    const std::lock_guard<std::mutex> alone(compiling());
    std::unique_ptr<GraphicsContext> context = createContext(graphics);
    context->makeCurrent();
    painter_ = std::make_unique<ScenePainter>(*context);
    context_ = std::move(context);
  }

  /// Waits until the thread has done it. @throws what it throws
  template <class Work>
  void perform(Work work) {
    std::packaged_task<void()> task(std::move(work));
    std::future<void> done = task.get_future();
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      tasks_.push_back(std::move(task));
    }
    wake_.notify_one();
    done.get();
  }

  void serve(const std::stop_token& stop) {
    std::unique_lock<std::mutex> lock(mutex_);
    while (wake_.wait(lock, stop, [this] { return !tasks_.empty(); })) {
      std::packaged_task<void()> task = std::move(tasks_.front());
      tasks_.pop_front();
      lock.unlock();
      task();
      lock.lock();
    }
  }

  // On the thread:
  std::unique_ptr<GraphicsContext> context_;
  std::unique_ptr<ScenePainter> painter_;  ///< needs the context until its end
  DrawListMaker drawLists_;
  LooksDrawn looks_;

  std::string name_;  ///< fixed once the constructor is through
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::deque<std::packaged_task<void()>> tasks_;
  std::jthread thread_;  // last: it uses what is above
};

Renderer::Renderer(Graphics graphics) : worker_(std::make_unique<Worker>(graphics)) {}
Renderer::~Renderer() = default;

const std::string& Renderer::graphics() const { return worker_->name(); }

Image Renderer::render(const SceneView& view, int width, int height, const RenderSettings& settings,
                       std::span<const Puff> smoke) {
  checkPictureSize(width, height);
  checkView(view);
  checkSmoke(smoke);
  return worker_->render(view, width, height, settings, smoke);
}

}  // namespace calot::gui
