// SPDX-License-Identifier: GPL-3.0-or-later
// Renders the newest scene view to pictures on separate threads.
#pragma once

#include <array>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <QImage>
#include <QWidget>
#include <string>
#include <thread>
#include <vector>

#include "gui/render/graphics.h"
#include "gui/render/image.h"
#include "sim/scene/scene_view.h"

namespace calot::gui {

/// How large pictures are drawn so that they keep a rate: a share of width and height that falls where drawing is too
/// slow and rises where time is left, in few steps, after a mean over several pictures each. What drawing costs
/// beside its pixels is not known; a larger size is tried only where even all of the cost times the pixels would do, so
/// that it does not swing. Keeps no clock. One thread at a time.
class PictureScale {
 public:
  static constexpr std::array<double, 5> sides{1.0, 0.875, 0.75, 0.625, 0.5};

  /// @param rate pictures a second that are wanted; 0: every picture is drawn whole
  /// @param drawers how many pictures are drawn at a time. @pre at least 1
  PictureScale(double rate, std::size_t drawers) : rate_(rate), drawers_(static_cast<double>(drawers)) {}

  /// Share of width and height of the next picture, one of `sides`.
  [[nodiscard]] double side() const { return sides[level_]; }
  /// A picture of this share was drawn in `seconds` of wall time. One of another share than the present one was
  /// begun before it changed, and is not counted.
  void drew(double side, double seconds);

 private:
  static constexpr int enough = 12;  ///< pictures that a mean is taken of
  static constexpr double spare = 1.1;

  void take(std::size_t level);

  double rate_, drawers_;
  std::size_t level_ = 0;
  double sum_ = 0.0;
  int count_ = 0;
};

/// A picture and its time.
struct ScenePicture {
  std::shared_ptr<const SceneView> view;
  Image image;
};

/// Renders the newest view. While one is being rendered, later ones replace each other: nothing queues and nobody
/// waits. The last view given is always rendered eventually, in the last size given.
///
/// Where a rate is wanted, pictures are drawn smaller while the machine cannot keep it (PictureScale): whoever shows
/// them scales them up. What no view follows for a moment is drawn once more, whole, and as what stands still.
///
/// Two drawers render two views at a time, since much of a picture is single-threaded work. Pictures are delivered in
/// the order of their views; one overtaken by a newer one is dropped.
class PictureLoop {
 public:
  /// @param still nothing follows it for a moment: time does not press
  using Draw = std::function<Image(const SceneView&, int width, int height, bool still)>;
  /// Makes what draws; called once a drawer, on its own thread, before its first picture.
  using MakeDraw = std::function<Draw()>;
  struct Receiver {
    std::function<void(ScenePicture)> picture;       ///< called on a drawer's thread, by one at a time
    std::function<void(const std::string&)> failed;  ///< a view could not be drawn: one line
  };

  /// @param rate pictures a second that are worth a smaller size; 0: all are drawn in the size given
  /// @param refine what stands still is drawn once more, though its size was whole
  PictureLoop(MakeDraw make, Receiver receiver, std::size_t drawers = 1, double rate = 0.0, bool refine = false);
  /// Waits for pictures in progress and drops waiting views.
  ~PictureLoop();

  /// Any thread; returns at once. @pre view is not null and is changed by nobody any more
  void show(std::shared_ptr<const SceneView> view);
  /// Any thread: the size of pictures from here on (pixels). The newest view is drawn again.
  void resize(int width, int height);
  /// Any thread: forgets the view that waits to be drawn.
  void clear();
  /// Any thread: draws this view nowhere, unless there was a picture: what draws is ready then.
  void prepare(std::shared_ptr<const SceneView> view);

 private:
  struct Work {
    std::shared_ptr<const SceneView> view;
    int width = 0, height = 0;
    double side = 1.0;         ///< share of the size given
    bool still = false;        ///< no other view came for a moment
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
  std::shared_ptr<const SceneView> prepared_;  ///< is still to be drawn nowhere
  bool drawn_ = false;                         ///< one picture is there: other drawers make themselves ready
  int width_ = 0, height_ = 0;                 ///< 0: none is wanted yet
  bool stale_ = false;                         ///< the newest view was not taken yet in this size
  bool rough_ = false;                         ///< it was taken, and is to be drawn better once it stands still
  bool refine_;
  PictureScale scale_;
  bool stop_ = false;
  std::uint64_t taken_ = 0;      ///< pictures begun
  std::uint64_t delivered_ = 0;  ///< the newest of them that the receiver has
  std::mutex delivering_;
  std::vector<std::thread> threads_;  // last: they use what is above
};

/// Shows scene views, rendered off screen at the widget's size on a separate thread, in interactive quality, and in
/// that of films what stands still: the GUI thread only copies finished pictures to the screen. Views that arrive
/// faster than they can be rendered are skipped.
class ScenePictureWidget : public QWidget {
  Q_OBJECT
 public:
  /// @param drawers how many views are drawn at a time. @param rate pictures a second that are worth a smaller size,
  /// which is scaled up on the screen; 0: none (PictureLoop)
  explicit ScenePictureWidget(std::size_t drawers = 1, double rate = 0.0);
  ~ScenePictureWidget() override;

  /// Any thread; returns at once. @pre not null, changed by nobody any more
  void showView(std::shared_ptr<const SceneView> view);
  /// Makes ready what draws, before there is a view.
  void prepare();
  /// Shows a text instead of a picture, until the next view.
  void showText(const QString& text);

  /// Number of pictures shown so far.
  [[nodiscard]] quint64 shown() const { return shown_; }
  /// Sets the graphics of such widgets, from the next one made on; a graphics card where there is one, at
  /// first. GUI thread.
  static void drawBy(Graphics graphics);
  /// Description of the renderer (Renderer::graphics()); empty before the first picture.
  [[nodiscard]] std::string drawnBy() const;

  /// The picture on the screen; null before the first one.
  [[nodiscard]] const QImage& picture() const { return picture_; }
  /// The time of its view (s); negative before the first one.
  [[nodiscard]] double time() const { return time_; }
  /// Its share of the size that it is shown in; 1 before the first one.
  [[nodiscard]] double side() const;

  [[nodiscard]] QSize sizeHint() const override { return {640, 400}; }
  [[nodiscard]] QSize minimumSizeHint() const override { return {160, 100}; }

 signals:
  /// A picture came on the screen. @param time since the attempt's start (s)
  void pictureShown(quint64 step, double time);

 protected:
  void paintEvent(QPaintEvent* event) override;
  void resizeEvent(QResizeEvent* event) override;

 private:
  void takePicture();
  void takeFailure(const QString& text);

  QImage picture_;
  QString text_;
  quint64 shown_ = 0;
  double time_ = -1.0;
  bool awaits_ = false;  ///< a view was given after the last text

  mutable std::mutex mutex_;
  std::string drawnBy_;
  ScenePicture newest_;                ///< drawn and not yet on the screen
  std::unique_ptr<PictureLoop> loop_;  // last: its thread uses what is above
};

}  // namespace calot::gui
