// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/renderer.h"

#include <fmt/format.h>

#include <condition_variable>
#include <deque>
#include <future>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "gui/render/graphics.h"
#include "gui/render/scene_painter.h"
#include "gui/render/scene_resources.h"
#include "gui/render/view_check.h"
#include "recorder/base/errors.h"

namespace calot::gui {

/// A thread that owns context and painter and serves requests one at a time.
class Renderer::Worker {
 public:
  explicit Worker(Graphics graphics) : wanted_(graphics) {
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

  [[nodiscard]] const std::string& name() const { return name_; }

  Image render(const SceneView& view, int width, int height, const RenderSettings& settings,
               std::span<const Puff> smoke) {
    std::packaged_task<Image(ScenePainter&)> task([&](ScenePainter& painter) {
      const Sight sight = sightOf(width, height, view.verticalFieldOfView, settings.endoscopeMask);
      const DrawList& list = drawLists_.make(view, sight, settings.cavity, smoke);
      const auto alone = looks_.note(list, settings) ? std::unique_lock(compiling()) : std::unique_lock<std::mutex>();
      return painter.paint(list, sight, view.verticalFieldOfView, width, height, settings);
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
  struct Drawing {
    std::unique_ptr<GraphicsContext> context;
    std::unique_ptr<ScenePainter> painter;  ///< last: it needs the context until its end
  };

  /// Held while Mesa compiles, which is what its contexts share most. (Two crashes were seen in hundreds of runs in
  /// which two contexts drew; nobody could bring one about.)
  static std::mutex& compiling() {
    static std::mutex lock;
    return lock;
  }

  static Drawing drawingBy(Graphics graphics) {
    const std::lock_guard<std::mutex> alone(compiling());
    Drawing made{createContext(graphics), nullptr};
    made.context->makeCurrent();
    made.painter = std::make_unique<ScenePainter>(*made.context);
    return made;
  }
  [[nodiscard]] Drawing makeDrawing() const {
    if (wanted_ != Graphics::automatic) return drawingBy(wanted_);
    try {
      return drawingBy(Graphics::card);
    } catch (const Error&) {  // no card, or one that lacks something
      return drawingBy(Graphics::software);
    }
  }

  void run(std::promise<void>& started) {
    std::optional<Drawing> drawing;
    try {
      drawing.emplace(makeDrawing());
      name_ = fmt::format("{}, {}", drawing->context->way(), drawing->painter->implementation());
    } catch (...) {
      started.set_exception(std::current_exception());
      return;
    }
    started.set_value();
    while (true) {
      std::packaged_task<Image(ScenePainter&)> task;
      {
        std::unique_lock<std::mutex> lock(mutex_);
        wake_.wait(lock, [this] { return stopping_ || !tasks_.empty(); });
        if (tasks_.empty()) break;
        task = std::move(tasks_.front());
        tasks_.pop_front();
      }
      task(*drawing->painter);
    }
    const std::lock_guard<std::mutex> alone(compiling());
    drawing.reset();
  }

  const Graphics wanted_;
  std::string name_;         ///< fixed once the thread has started
  DrawListMaker drawLists_;  ///< on the thread
  LooksDrawn looks_;         ///< on the thread
  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<std::packaged_task<Image(ScenePainter&)>> tasks_;
  bool stopping_ = false;
  std::thread thread_;
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
