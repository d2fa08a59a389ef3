// SPDX-License-Identifier: GPL-3.0-or-later
// Cameras that watch printed handles: their lenses, where they stand, and the trocars in front of them.
#pragma once

#include <array>
#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "sim/math/linear.h"
#include "sim/math/record.h"
#include "sim/scene/samples.h"

namespace calot::recorder {

/// A lens as Brown's model has it (Brown 1966, "Decentering distortion of lenses", Photogrammetric Engineering 32:444).
/// Pixels are counted from the image's upper left corner; the centre of the first pixel is (0.5, 0.5).
struct CameraLens {
  int width = 0, height = 0;                         ///< of the image (pixels)
  Eigen::Vector2d focal = Eigen::Vector2d::Zero();   ///< pixels
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< principal point (pixels)
  std::array<double, 4> distortion{};                ///< k1, k2 radial; p1, p2 tangential
  double readout = 0.0;                              ///< from the first row's exposure to the last one's (s)
  int views = 0;                                     ///< of the board, that it was measured from
  double coverage = 0.0;                             ///< share of the image in which the board was seen
  double residual = 0.0;                             ///< root mean square reprojection error (pixels)
  double focalUncertainty = 0.0;                     ///< standard deviation of the focal length, relative
};

/// Pixel of a point of the camera's frame K (x right, y down, z away; m). @pre z > 0
Eigen::Vector2d projected(const CameraLens& lens, const Vec3& point);

/// Direction in K, as (x / z, y / z), in which a pixel looks.
Eigen::Vector2d undistorted(const CameraLens& lens, const Eigen::Vector2d& pixel);

struct RigCamera {
  CameraLens lens;
  Pose fromDevice;            ///< x_K = position + orientation x_D; the identity for the first camera
  double pairResidual = 0.0;  ///< root mean square reprojection error with the first camera's views (pixels)

  static std::vector<Field> fields();
};

struct Trocar {
  Vec3 point = Vec3::Zero();  ///< through which the shaft passes, in D (m)
  double residual = 0.0;      ///< root mean square distance of the shaft from it (m)

  static std::vector<Field> fields();
};

/// Limits that such a calibration must meet, beside those of every device; stored in it.
struct RigLimits {
  double lensResidual = 0.6;       ///< pixels, also of a pair
  double focalUncertainty = 0.01;  ///< relative
  double coverage = 0.4;           ///< share of the image
  double views = 8;
  double trocarResidual = 0.003;  ///< m
  double scaleError = 0.03;       ///< of the strokes' scale from 1: the cameras measure true lengths

  static std::vector<Field> fields();
};

/// Frame D is the first camera's.
struct CameraRig {
  std::vector<RigCamera> cameras;  ///< one or two
  double printScale = 1.0;         ///< length on the printed sheets per length meant
  std::array<std::optional<Trocar>, handCount> trocar;
  RigLimits limits;

  static std::vector<Field> fields();
};

std::vector<std::string> rigShortcomings(const CameraRig& rig);

}  // namespace calot::recorder
