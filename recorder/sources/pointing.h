// SPDX-License-Identifier: GPL-3.0-or-later
// Orientation of an instrument through a port. Frame I of the instrument: z along the shaft towards the tip, x across
// the jaw's hinge. Only + - * / sqrt and the elementary functions of sim/: the same bits everywhere.
#pragma once

#include <array>
#include <cstddef>

#include "sim/math/linear.h"
#include "sim/math/random.h"

namespace calot::recorder {

/// Widest opening of an instrument's jaw, as devices and motion files may ask for it (rad).
constexpr double widestJaw = 1.2;

/// Unit vector along the shaft; W's -y (straight into the abdomen) where port and tip are less than a micrometre apart.
Vec3 shaftDirection(const Vec3& port, const Vec3& tip);

/// q_WI of an instrument that passes the port and ends at the tip. At roll 0 the hinge's axis x lies level: x is along
/// e x z, with e W's +y axis (or, where the shaft is within about a degree of e, W's +z axis).
/// @param roll rotation about the shaft, right-handed about z (rad).
Quat pointing(const Vec3& port, const Vec3& tip, double roll = 0.0);

/// The orientation closest to `orientation` with its z axis along `shaft`: `orientation` followed by the minimal
/// rotation of its z axis onto the shaft, which preserves the roll. A rotation by 180 degrees, whose axis is
/// undetermined, is about the orientation's own x axis.
/// @pre `shaft` is a unit vector
Quat alignedToShaft(const Quat& orientation, const Vec3& shaft);

/// How far a matrix is off a rotation: the largest part of |R R^T - 1|, 2 for a reflection; NaN where it has NaN.
double rotationDefect(const Mat3& matrix);
/// Tolerance for rotations in files of poses, whose numbers are rounded.
inline constexpr double rotationTolerance = 1e-3;
/// Greatest distance of positions in files of poses (m); larger values indicate a different unit.
inline constexpr double maxPosition = 5.0;

/// Quaternion of a rotation matrix, from the largest of its four components (Shepperd 1978); normalised, w >= 0.
/// @pre the matrix is a rotation within about 1e-3
Quat quaternionOf(const Mat3& rotation);

/// Normalised linear interpolation on the shorter arc. @param s in [0, 1]
Quat interpolated(const Quat& from, const Quat& to, double s);

/// Minimum-jerk progress of a stroke, 10 s^3 - 15 s^4 + 6 s^5, clamped outside [0, 1] (Flash and Hogan 1985, "The
/// coordination of arm movements", J. Neuroscience 5:1688). Speed and acceleration are zero at both ends; the greatest
/// speed is 1.875 times the mean.
double minimumJerk(double s);

/// Movement about the planned tip: a sum of sines with frequencies and phases drawn once.
class Unsteadiness {
 public:
  Unsteadiness() = default;
  /// @param amplitude root mean square of each axis (m). @param lower, upper band (Hz).
  Unsteadiness(double amplitude, double lower, double upper, Random& random);
  [[nodiscard]] Vec3 at(double time) const;

 private:
  static constexpr std::size_t sines = 4;
  double amplitude_ = 0.0;
  std::array<std::array<double, sines>, 3> omega_{}, phase_{};
};

}  // namespace calot::recorder
