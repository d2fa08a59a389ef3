// SPDX-License-Identifier: GPL-3.0-or-later
// Words and marks over the frames of a film, and the recorded data that they show: phase, events, checkpoints, paths of
// the tools.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analytics/checkpoints/collector.h"
#include "gui/render/image.h"
#include "gui/render/translucent.h"
#include "gui/words/event_words.h"
#include "recorder/recorded_results.h"
#include "recorder/recording/reader.h"
#include "sim/scene/scene_view.h"

namespace calot::gui {

using Colour = std::array<std::uint8_t, 3>;

/// Anchor of a line of text.
enum class Anchor { left, middle, right };

/// Writes lines of words (UTF-8) in one font and size, with a dark edge that keeps them readable on tissue.
class Lettering {
 public:
  /// @param pixels height of a line, at least 6
  /// @throws calot::Error (failure) where the font (DejaVu Sans, package fonts-dejavu-core) is not there
  explicit Lettering(int pixels);
  ~Lettering();
  Lettering(const Lettering&) = delete;
  Lettering& operator=(const Lettering&) = delete;

  [[nodiscard]] int lineHeight() const;
  [[nodiscard]] int widthOf(const std::string& text) const;
  /// @param x, y the anchor (pixels): of the line's left, middle or right end, and of its top. What leaves the picture
  /// is cut off. @param opacity 0 to 1
  void write(Image& image, const std::string& text, int x, int y, Anchor anchor, const Colour& colour,
             double opacity = 1.0) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Lays a colour over a pixel. Nothing happens outside of the picture. @param opacity 0 to 1
inline void blend(Image& image, int x, int y, const std::array<std::uint8_t, 3>& colour, double opacity) {
  if (x < 0 || y < 0 || x >= image.width || y >= image.height || opacity <= 0.0) return;
  std::uint8_t* const pixel =
      image.rgba.data() +
      4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x));
  for (std::size_t c = 0; c < 3; ++c) {
    const double before = pixel[c];
    pixel[c] = static_cast<std::uint8_t>(before + opacity * (colour[c] - before) + 0.5);
  }
  const double covered = pixel[3];
  pixel[3] = static_cast<std::uint8_t>(covered + opacity * (255.0 - covered) + 0.5);
}

/// Data of one moment of an attempt.
struct Moment {
  struct Line {
    std::string text;
    bool fault = false;
    double time = 0.0;  ///< when it happened (s)
  };
  struct Place {
    Vec3 p_W = Vec3::Zero();
    double time = 0.0;  ///< s
  };
  double time = 0.0;                              ///< s
  std::string phase;                              ///< "clipping", or empty
  std::deque<Line> events;                        ///< of the last eventSeconds, oldest first
  std::vector<std::string> checkpoints;           ///< "path-length left  412 mm"
  std::array<std::deque<Place>, handCount> path;  ///< of the simulated tips in the last pathSeconds, oldest first
  std::vector<Puff> smoke;

  static constexpr double eventSeconds = 5.0, pathSeconds = 3.0;
};

/// Reads the results of a recording's steps and sums up, from its first step on: judgement needs all of them.
class MomentTrack {
 public:
  /// @param checkpoints are asked for: they are computed as the track goes on
  /// @throws Error (invalid) for a golden recording, which holds no results of its steps; (damaged) where it can't be
  /// read
  MomentTrack(const std::filesystem::path& recording, bool checkpoints);

  /// Data after step n; forward only. @pre n is not before that of the last call, and below the recording's stepCount()
  [[nodiscard]] const Moment& at(std::uint64_t n);

 private:
  void add(const recorder::RecordedStep& step);
  void refreshCheckpoints(double time);

  recorder::Recording recording_;
  double stepSeconds_ = 0.01;
  SubjectNames names_;
  std::unique_ptr<analytics::CheckpointCollector> collector_;  ///< none: no checkpoints are asked for
  std::uint64_t next_ = 0;                                     ///< step to read
  std::optional<recorder::RecordedResults> results_;
  std::optional<Judge> judge_;
  Moment moment_;
  SmokeTrail smoke_;
  double checkpointsAt_ = -1.0;  ///< when they were last computed (s)
};

/// Per phase of the procedure (identification to dissection): when it first began (s), or -1. @throws Error (damaged)
[[nodiscard]] std::array<double, 4> phaseStarts(const std::filesystem::path& recording);

/// Text and marks drawn over a frame.
struct Overlays {
  bool time = false, phase = false, checkpoints = false, events = false, tools = false;

  /// Some of them need what the steps recorded of themselves.
  [[nodiscard]] bool needTrack() const { return phase || checkpoints || events || tools; }
};

/// "time,phase". @throws calot::Error (invalid) naming what is not known
[[nodiscard]] Overlays parseOverlays(const std::string& text);

/// Titles and marks shown on every frame.
struct Captions {
  std::string title;       ///< at the upper edge; truncated if too long
  std::string mark;        ///< at the lower edge: a non-human operator ("synthetic")
  std::string doubt = {};  ///< in the middle of the upper half, in amber: what is shown is not what was recorded
};

/// Draws overlays in sizes that fit the picture's height: time and phase in the upper left corner, checkpoints in the
/// upper right, below a title, events in the lower left, above a mark that leaves no room beside it; the path of each
/// tool's tip over the last seconds as the camera sees it.
class OverlayPainter {
 public:
  explicit OverlayPainter(int pictureHeight);

  /// @param view what the picture shows: its camera places the paths
  void paint(Image& image, const Overlays& overlays, const Moment& moment, const SceneView& view,
             const Captions& captions = {}) const;

 private:
  void paintTitle(Image& image, std::string title) const;
  void paintDoubt(Image& image, const std::string& doubt) const;
  void paintEvents(Image& image, const Moment& moment, int bottom) const;

  Lettering letters_;
  int margin_;
};

}  // namespace calot::gui
