// SPDX-License-Identifier: GPL-3.0-or-later
// Scene views to pictures on a thread of its own, the newest only. Knows no window.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "gui/render/image.h"
#include "sim/scene/scene_view.h"

namespace calot::gui {

/// What was drawn: the picture, and of which moment.
struct ScenePicture {
  std::shared_ptr<const SceneView> view;
  Image image;
};

/// A thread that draws whatever view is the newest. While one is being drawn the next ones replace each other: nothing
/// queues, nobody waits. The last view that was given is always drawn in the end, in the last size that was given.
class PictureLoop {
 public:
  using Draw = std::function<Image(const SceneView&, int width, int height)>;
  /// Makes what draws; called once, on the loop's own thread, before the first picture.
  using MakeDraw = std::function<Draw()>;
  struct Receiver {
    std::function<void(ScenePicture)> picture;       ///< called on the loop's thread
    std::function<void(const std::string&)> failed;  ///< a view could not be drawn: one line
  };

  PictureLoop(MakeDraw make, Receiver receiver);
  /// Waits for the picture that is being drawn; what is left is dropped.
  ~PictureLoop();
  PictureLoop(const PictureLoop&) = delete;
  PictureLoop& operator=(const PictureLoop&) = delete;

  /// Any thread; returns at once. @pre view is not null and is changed by nobody any more
  void show(std::shared_ptr<const SceneView> view);
  /// Any thread: the size of pictures from here on (pixels). The newest view is drawn again.
  void resize(int width, int height);
  /// Any thread: forgets the view that waits to be drawn.
  void clear();

 private:
  void run();

  MakeDraw make_;
  Receiver receiver_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::shared_ptr<const SceneView> newest_;
  int width_ = 0, height_ = 0;  ///< 0: none is wanted yet
  bool stale_ = false;          ///< the newest view was not drawn yet in this size
  bool stop_ = false;
  std::thread thread_;  // last: it uses what is above
};

}  // namespace calot::gui
