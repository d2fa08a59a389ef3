// SPDX-License-Identifier: GPL-3.0-or-later
// Lenses, and where a second camera stands, from films of the printed board.
#pragma once

#include <cstdint>
#include <Eigen/Core>
#include <string>
#include <vector>

#include "recorder/sources/devices/camera/camera_rig.h"
#include "recorder/sources/devices/camera/frame_source.h"

namespace calot::recorder {

struct BoardView {
  std::int64_t time = 0;  ///< ns
  std::vector<SeenTag> tags;
};

/// Views of the board in a film that differ from each other and in which it stood still, at most 30.
/// @param source is read to its end
std::vector<BoardView> boardViews(FrameSource& source);

/// Pixel of a corner, and its distance from the lens model's projection.
struct CornerResidual {
  Eigen::Vector2d pixel, error;
};

struct LensFit {
  CameraLens lens;
  std::vector<Pose> board;  ///< of each view, in the camera's frame
  std::vector<CornerResidual> residuals;
};

/// Lens from views of a plane board (Zhang 2000, "A flexible new technique for camera calibration", IEEE PAMI 22:1330),
/// with the principal point at first in the image's middle.
/// @param name of the film, for messages
/// @throws Error (damaged) naming it, where there are fewer than three views, or they are too alike
LensFit fitLens(const std::vector<BoardView>& views, int width, int height, double printScale, const std::string& name);

struct PairFit {
  Pose second;            ///< of the first camera's frame in the second's: RigCamera::fromDevice
  double residual = 0.0;  ///< pixels
  int views = 0;          ///< seen by both
};

/// Pose of the second camera from views of the same moments.
/// @throws Error (damaged) where fewer than three moments are seen by both
PairFit fitPair(const std::vector<BoardView>& first, const LensFit& firstLens, const std::vector<BoardView>& second,
                const LensFit& secondLens, double printScale, const std::string& name);

/// Moments at which both cameras of a pair saw the board, standing still; views of both, of equal number and order.
void pairedViews(FrameSource& first, FrameSource& second, std::vector<BoardView>& ofFirst,
                 std::vector<BoardView>& ofSecond);

}  // namespace calot::recorder
