// SPDX-License-Identifier: GPL-3.0-or-later
// Renders the newest scene view to pictures on separate threads. Independent of windows.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "gui/render/image.h"
#include "gui/view/picture_scale.h"
#include "sim/scene/scene_view.h"

namespace calot::gui {

/// A picture and its time.
struct ScenePicture {
  std::shared_ptr<const SceneView> view;
  Image image;
};

/// Renders the newest view. While one is being rendered, later ones replace each other: nothing queues and nobody
/// waits. The last view given is always rendered eventually, in the last size given.
///
/// Where a rate is wanted, pictures are drawn smaller while the machine cannot keep it (PictureScale): whoever shows
/// them scales them up. What no view follows for a moment is drawn once more, whole.
///
/// Two drawers render two views at a time, since much of a picture is single-threaded work. Pictures are delivered in
/// the order of their views; one overtaken by a newer one is dropped.
class PictureLoop {
 public:
  using Draw = std::function<Image(const SceneView&, int width, int height)>;
  /// Makes what draws; called once a drawer, on its own thread, before its first picture.
  using MakeDraw = std::function<Draw()>;
  struct Receiver {
    std::function<void(ScenePicture)> picture;       ///< called on a drawer's thread, by one at a time
    std::function<void(const std::string&)> failed;  ///< a view could not be drawn: one line
  };

  /// @param rate pictures a second that are worth a smaller size; 0: all are drawn in the size given
  PictureLoop(MakeDraw make, Receiver receiver, std::size_t drawers = 1, double rate = 0.0);
  /// Waits for pictures in progress and drops waiting views.
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
  struct Work {
    std::shared_ptr<const SceneView> view;
    int width = 0, height = 0;
    double side = 1.0;         ///< share of the size given
    std::uint64_t number = 0;  ///< 0: nobody waits for it; what draws is made ready
  };

  void run();
  /// Waits for a view to draw. @return false at the end
  bool take(bool warm, Work& work);

  MakeDraw make_;
  Receiver receiver_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::shared_ptr<const SceneView> newest_;
  int width_ = 0, height_ = 0;  ///< 0: none is wanted yet
  bool stale_ = false;          ///< the newest view was not taken yet in this size
  bool reduced_ = false;        ///< it was taken, to be drawn smaller than the size given
  PictureScale scale_;
  bool stop_ = false;
  std::uint64_t taken_ = 0;      ///< pictures begun
  std::uint64_t delivered_ = 0;  ///< the newest of them that the receiver has
  std::mutex delivering_;
  std::vector<std::thread> threads_;  // last: they use what is above
};

}  // namespace calot::gui
