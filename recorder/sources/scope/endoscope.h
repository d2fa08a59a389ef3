// SPDX-License-Identifier: GPL-3.0-or-later
// A rigid endoscope through its port. docs/how-to/endoscope.md
// Where things lie in the endoscope's picture. Frame C: x right, y down, z along the view.
#pragma once

#include <array>
#include <optional>

#include "sim/math/linear.h"
#include "sim/scene/description.h"
#include "sim/scene/samples.h"

namespace calot::recorder {

/// Radius of the endoscope's round field in wide pictures, in halves of their height, as trainer, films and dashboard
/// show it (gui/render/draw_list.h); the picture cuts it above and below.
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

/// Place of a point in the picture; none behind the lens. Tissue before it does not matter: what is hidden by an organ
/// Pixel of a point; none behind the lens. Occlusion is ignored: a point that is hidden by an organ
/// but inside the field of view has a point.
std::optional<PicturePoint> pointInPicture(const PictureFrame& frame, const CameraSample& camera, const Vec3& p_W);

/// Is the point inside the picture's round field? @param share of the field's radius, about its centre: 1 all of it
bool isInPicture(const PictureFrame& frame, const CameraSample& camera, const Vec3& p_W, double share = 1.0);

/// Angle by which the picture is rotated about the view from level (rad, in (-pi, pi]), positive where the camera is
/// rotated clockwise, seen by the operator. Level: the picture's vertical lies in one plane with the view and with the
/// vertical of the scene's camera. None where the view is within three degrees of that vertical.
std::optional<double> horizonDeviation(const PictureFrame& frame, const CameraSample& camera);

/// Degrees of freedom of the endoscope: the shaft about its port, in and out and about itself, and the camera head on
/// it.
struct ScopeJoints {
  double pan = 0.0;        ///< of the shaft to the right, about the vertical of the scene's camera (rad)
  double tilt = 0.0;       ///< of the shaft upwards, about its level axis (rad)
  double insertion = 0.0;  ///< from the port to the lens (m)
  double cable = 0.0;      ///< light cable about the shaft: 0 up, so that an angled optic looks down (rad)
  double head = 0.0;       ///< camera head about the shaft: 0 level (rad)

  bool operator==(const ScopeJoints&) const = default;
};

/// Geometry of the endoscope of a scene.
///
/// The port lies `portDistance` behind the scene's camera, on its line of sight. Frame of the base: the scene's camera,
/// moved into the port. Shaft d = R d_0 with R = R_C R_y(pan) R_x(tilt), d_0 = (0, 0, 1); lens p = port + insertion d;
/// camera R R_z(cable) R_x(-optic) R_z(head - cable): the light cable rotates the direction of view about the shaft,
/// and the picture is level as long as the camera head is. With a straight optic the light cable changes nothing.
class Endoscope {
 public:
  static constexpr double portDistance = 0.08;                   ///< m
  static constexpr double maxSwing = 1.05;                       ///< of pan and tilt, each way (rad)
  static constexpr double minInsertion = 0.02;                   ///< m
  static constexpr double maxInsertion = 0.20;                   ///< m
  static constexpr double maxRotation = 3.141592653589793;       ///< of light cable and camera head, each way (rad)
  static constexpr double maxOptic = 70.0 * 0.0174532925199433;  ///< rad

  /// @param optic angle between shaft and direction of view (rad), in [0, maxOptic]
  Endoscope(const SceneDescription& scene, double optic);

  [[nodiscard]] double optic() const { return optic_; }
  [[nodiscard]] const Vec3& port() const { return port_; }
  [[nodiscard]] const PictureFrame& frame() const { return frame_; }

  /// How the endoscope stands at the start: a straight optic exactly as the scene's camera; an angled one looks at the
  /// same point of the first organ from the same distance, from above.
  [[nodiscard]] const ScopeJoints& start() const { return start_; }
  /// From the lens to that point (m).
  [[nodiscard]] double workingDistance() const { return workingDistance_; }

  [[nodiscard]] CameraSample pose(const ScopeJoints& joints) const;
  /// The joints at which the endoscope has this pose. A pose that it cannot have gives those of the lens and the view
  /// that come nearest, within the limits.
  [[nodiscard]] ScopeJoints jointsOf(const CameraSample& camera) const;
  [[nodiscard]] static ScopeJoints withinLimits(const ScopeJoints& joints);

  /// Joints with the light cable up and the camera head level that show a point in the picture's centre, from a
  /// distance; nearer to the port than that, from as far as the limits let. The present ones where the point is too
  /// near to the port to be shown.
  [[nodiscard]] ScopeJoints aimedAt(const Vec3& p_W, double distance, const ScopeJoints& present) const;

 private:
  double optic_;
  PictureFrame frame_;
  Quat base_;
  Vec3 port_;
  double workingDistance_;
  ScopeJoints start_;
};

/// Driver of the endoscope: keys, a device, or an assistant who follows the instruments.
class ScopeDriver {
 public:
  ScopeDriver() = default;
  ScopeDriver(const ScopeDriver&) = delete;
  ScopeDriver& operator=(const ScopeDriver&) = delete;
  virtual ~ScopeDriver() = default;

  /// The endoscope stands so: before the first tick.
  virtual void setOut(const ScopeJoints& joints) = 0;

  /// Target of the endoscope; it follows within its limits and speeds. Called once for each tick, in order.
  /// @param time of the attempt (s) @param present joints now @param hands both instruments in this tick
  [[nodiscard]] virtual ScopeJoints wish(double time, const ScopeJoints& present, const TickSamples& hands) = 0;

  /// Called while the run is paused: motion in the meantime moves nothing.
  virtual void rest() {}

  /// Does it live in real time, so that the run must keep its pace?
  [[nodiscard]] virtual bool realTime() const { return false; }
};

/// Moves an endoscope towards where it is wished: each joint as a critically damped spring would, no faster than its
/// greatest speed, within its limits.
class ScopeMotion {
 public:
  static constexpr double frequency = 8.0;        ///< of the springs (rad/s): a step is over in 0.7 s
  static constexpr double maxSwingSpeed = 0.6;    ///< pan and tilt (rad/s)
  static constexpr double maxInsertSpeed = 0.08;  ///< m/s
  static constexpr double maxRotateSpeed = 1.5;   ///< light cable and camera head (rad/s)

  void setOut(const ScopeJoints& joints) {
    joints_ = joints;
    speed_ = {};
  }
  /// Advances by one tick.
  void advance(const ScopeJoints& wish);
  [[nodiscard]] const ScopeJoints& joints() const { return joints_; }

 private:
  ScopeJoints joints_;
  ScopeJoints speed_;  ///< 1/s
};

}  // namespace calot::recorder
