// SPDX-License-Identifier: GPL-3.0-or-later
// What the definitions of instruments build their contact shapes with. Internal to this folder.
#pragma once

#include "sim/instruments/instrument_shape.h"

namespace calot {

inline constexpr double mm = 1e-3;                 ///< m
inline constexpr double nominalRadius = 2.5 * mm;  ///< of a shaft: sizes in definitions are those of 5 mm instruments

/// Fills a shape. Points and radii are given in I, scaled: a definition multiplies its sizes with `scale()`.
class ShapeBuilder {
 public:
  /// @param shape empty @param jaw rad, clamped to [0, InstrumentShape::widestJaw]; not a number counts as closed
  /// @param shaftRadius m @param length from the port to the tip (m)
  ShapeBuilder(InstrumentShape& shape, double jaw, double shaftRadius, double length);

  [[nodiscard]] double scale() const { return scale_; }  ///< 1 for a shaft of 5 mm
  [[nodiscard]] double millimetre() const { return mm * scale_; }

  void add(const Vec3& p0, const Vec3& p1, double radius, Capsule::Part part);
  /// Where the line about which jaws open stands on the z axis (m). Before the first jaw.
  void setHinge(double z) { hinge_ = z; }
  /// A part of both jaws, given for the upper one when closed, from the hinge's line: x along it, y across, z to the
  /// tip.
  void addJaws(const Vec3& p0, const Vec3& p1, double radius);
  /// The fork that holds the hinge, from `sleeve` to a little past the hinge. After the jaws.
  void addFork(double sleeve);
  /// The shaft, in pieces from the working end towards the port. @param sleeve z where its full radius ends (m). Last.
  void addShaft(double sleeve);

  /// The reaches of what was built.
  void measure();

 private:
  InstrumentShape& shape_;
  double scale_;
  double shaftRadius_;
  double length_;
  double cosine_;  ///< of half the jaw angle
  double sine_;
  double hinge_ = 0.0;
};

}  // namespace calot
