// SPDX-License-Identifier: GPL-3.0-or-later
// Where things lie in the endoscope's picture. Frame C: x right, y down, z along the view.
#pragma once

#include <optional>

#include "sim/math/linear.h"
#include "sim/scene/samples.h"

namespace calot::recorder {

/// Radius of the endoscope's round field in wide pictures, in halves of their height, as trainer, films and dashboard
/// show it (gui/render/sight.h); the picture cuts it above and below.
inline constexpr double fieldRadius = 1.12;

/// The picture of an endoscope that stands at the scene's camera: what is level there is the horizon.
struct PictureFrame {
  CameraSample start;                ///< the scene's camera
  double verticalFieldOfView = 1.0;  ///< rad
};

/// A point of the picture: right and down from its centre, in halves of its height.
struct PicturePoint {
  double right = 0.0, down = 0.0;
};

/// Pixel of a point; none behind the lens. Occlusion is ignored: a point that is hidden by an organ
/// but inside the field of view has a point.
std::optional<PicturePoint> pointInPicture(const PictureFrame& frame, const CameraSample& camera, const Vec3& p_W);

/// Is the point inside the picture's round field? @param share of the field's radius, about its centre: 1 all of it
bool isInPicture(const PictureFrame& frame, const CameraSample& camera, const Vec3& p_W, double share = 1.0);

/// Angle by which the picture is rotated about the view from level (rad, in (-pi, pi]), positive where the camera is
/// rotated clockwise, seen by the operator. Level: the picture's vertical lies in one plane with the view and with the
/// vertical of the scene's camera. None where the view is within three degrees of that vertical.
std::optional<double> horizonDeviation(const PictureFrame& frame, const CameraSample& camera);

}  // namespace calot::recorder
