// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of handles and boards of known motion, as a webcam would take them: lens, blur, noise, rolling exposure,
// uneven light, things in the way.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "recorder/sources/devices/camera/camera_rig.h"
#include "recorder/sources/devices/camera/frame_source.h"
#include "recorder/sources/devices/camera/marker_sheets.h"
#include "sim/math/random.h"

namespace calot::recorder::cameratest {

/// What a camera does to a picture.
struct Imaging {
  double exposure = 0.0;  ///< s
  double noise = 2.0;     ///< standard deviation (grey levels)
  double lensBlur = 0.6;  ///< standard deviation (pixels)
  double light = 1.0;     ///< of 1: well exposed
  double gradient = 0.2;  ///< of the light from the left to the right, relative
  int samples = 3;        ///< of a pixel, each way
  int moments = 1;        ///< of an exposure
};

/// A body with tags that moves in D.
struct Body {
  std::vector<TagPlace> tags;
  std::function<Pose(double)> at;        ///< of the body at a time (s)
  std::function<TagPlace(double)> flap;  ///< the flap's tag at a time, or none
};

/// A dark rectangle in front of everything, in the picture (pixels).
struct Occluder {
  double left = 0.0, top = 0.0, right = 0.0, bottom = 0.0;
};

GreyImage rendered(const RigCamera& camera, const std::vector<Body>& bodies, double time, const Imaging& imaging,
                   Random& random, const std::optional<Occluder>& occluder = std::nullopt);

/// A webcam's lens: 1280 x 720, 70 degrees wide, a little distortion.
CameraLens webcam();
/// One camera, or two with their axes meeting at 0.4 m.
CameraRig rigOfCameras(int count, double readout = 0.0);

/// The same with pictures so many times smaller.
CameraRig shrunk(CameraRig rig, int factor);

/// A handle half a metre away and nearer, moved and tilted as a hand does; the tip's shaft passes no certain point.
Pose handMotion(Hand hand, double time);
Body handleBody(Hand hand, std::function<Pose(double)> at);

/// exp of a rotation vector after `base`.
Pose posed(const Vec3& position, const Vec3& turn, const Quat& base);

}  // namespace calot::recorder::cameratest
