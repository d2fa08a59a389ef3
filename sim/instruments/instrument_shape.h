// SPDX-License-Identifier: GPL-3.0-or-later
// An instrument's contact shape: a union of capsules, rigid in its frame I (origin at the tip, z along the shaft
// towards the tip, x along the jaws' hinge). The implicit function at p is the least over all capsules of
//   |p - (nearest point of the capsule's segment)| - radius.
//
// Sizes are typical of 5 mm laparoscopic instruments and scale with the shaft's radius (a 10 mm clip applier is twice
// as large); each instrument's stand in its definition. They are those of the pictures (gui/render): what
// is drawn stands out of this shape by at most 0.9 mm, at the corners of the fork that holds the hinge
// (tests/gui/render/instrument_agreement_test.cpp).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "sim/instruments/instruments.h"
#include "sim/math/linear.h"

namespace calot {

/// All points within `radius` of segment p0-p1. In I or in W, as its owner says.
struct Capsule {
  enum class Part : std::uint8_t {
    shaft,
    neck,
    upperJaw,
    lowerJaw,
    electrode,  ///< carries current where the instrument's action is to burn
  };

  Vec3 p0 = Vec3::Zero();  ///< m
  Vec3 p1 = Vec3::Zero();  ///< m
  double radius = 0.0;     ///< m
  Part part = Part::shaft;
  std::uint8_t piece = 0;  ///< unique within the instrument and the same at every jaw angle and length
};

/// Fixed capacity, no allocation: a value to be rebuilt whenever the jaw or the insertion changes.
class InstrumentShape {
 public:
  static constexpr std::size_t maxPieces = 15;  ///< of the shaft; the last takes the rest of it
  static constexpr std::size_t capacity = maxPieces + 9;
  static constexpr double pieceLength = 0.02;  ///< of the shaft (m)
  static constexpr double widestJaw = 2.5;     ///< rad

  [[nodiscard]] std::span<const Capsule> capsules() const { return {capsule_.data(), count_}; }

  /// Largest distance of a jaw's point from the hinge's line (m), 0 without jaws: when the jaw angle changes by d, no
  /// point moves in I by more than |d| / 2 times this.
  [[nodiscard]] double jawReach() const { return jawReach_; }

  /// Largest distance of any point from the shaft's axis (m): when the instrument rolls by d, no point moves by more
  /// than |d| times this.
  [[nodiscard]] double lateralReach() const { return lateralReach_; }

 private:
  friend class ShapeBuilder;
  friend InstrumentShape placed(const InstrumentShape& shape, const Pose& pose);

  std::array<Capsule, capacity> capsule_{};
  std::size_t count_ = 0;
  double jawReach_ = 0.0;
  double lateralReach_ = 0.0;
};

/// The shape in I. @param jaw opening angle (rad), symmetric about z in the plane y-z, clamped to [0, widestJaw]
/// @param shaftRadius m @param length from the port to the tip (m). Where nothing is mounted it has no capsules.
InstrumentShape instrumentShape(InstrumentKind kind, double jaw, double shaftRadius, double length);

/// The same shape in W. @param pose p_WI, q_WI
InstrumentShape placed(const InstrumentShape& shape, const Pose& pose);

/// The line between the closed jaws along which an instrument of action `grasp` holds tissue, in I (m), from where the
/// teeth begin to the tips. @param shaftRadius m
std::pair<Vec3, Vec3> graspLine(const InstrumentDefinition& instrument, double shaftRadius);

// Builder of the instruments' contact shapes. Internal to this folder.

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
  /// Sets the position of the jaws' hinge on the z axis (m). Call before adding a jaw.
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

/// The space between a pair of jaws, in I: a wedge that opens from the hinge's line at half the angle at which the jaws
/// count as open, as wide as the jaws, between two planes across the shaft:
///   |x| <= halfWidth,   |y| <= slope (z - hinge),   back <= z <= front.
struct JawSpace {
  double hinge = 0.0;      ///< z of the hinge's line (m)
  double slope = 0.0;      ///< tangent of half the angle
  double halfWidth = 0.0;  ///< m
  double back = 0.0;       ///< m
  double front = 0.0;      ///< m

  [[nodiscard]] bool contains(const Vec3& p) const;
};

/// @param depth from the tips backwards (m) @param beyond the tips (m) @param shaftRadius m. @pre it has jaws
JawSpace jawSpace(const InstrumentDefinition& instrument, double shaftRadius, double depth, double beyond);

/// A convex polygon of few corners.
struct SmallPolygon {
  static constexpr std::size_t capacity = 12;
  std::array<Vec3, capacity> corner;
  std::size_t count = 0;
};

/// The part of triangle abc (in I) that lies between the jaws; a segment is a triangle with two equal corners. May be
/// empty.
SmallPolygon between(const JawSpace& space, const Vec3& a, const Vec3& b, const Vec3& c);

// A rigid instrument through a trocar: the shaft pivots about the port, so the tip's place fixes yaw, pitch and
// insertion; roll about the shaft is what remains of the hand's orientation.

/// The shaft reaches at least this far past the port (m).
inline constexpr double minInsertion = 0.01;

/// Orientation with z along `axis` (unit) and x as near to `roll` (unit) as that allows; where they are parallel, a
/// fixed perpendicular.
Quat alongAxis(const Vec3& axis, const Vec3& roll);

/// Pose in W of an instrument whose tip is meant to be at `tip` and whose hand is turned by `orientation`.
/// A tip nearer to the port than minInsertion is moved to that distance, along `previousAxis` where the direction is
/// undefined. @param previousAxis unit, from port to tip
Pose throughPort(const Vec3& port, const Vec3& tip, const Quat& orientation, const Vec3& previousAxis);

/// Jacobian of a point of a tool: displacement of the tip (m), then roll about its axis (rad). The shaft turns
/// about the port, so the point at r from the port follows a displacement d of the tip by
///   ((a x d) / L) x r + a (a . d),   L the tip's distance from the port, a the axis,
/// and a roll by t about the axis by t a x (point - tip).
using ToolRow = Eigen::Matrix<double, 4, 1>;

/// The row that gives the point's displacement along `direction`; its transpose takes a force along `direction` to the
/// force on the tip (N) and the torque about the axis (N m) that do the same work.
/// @param tool pose of frame I; @pre the tip is at least minInsertion from the port
ToolRow toolRow(const Vec3& port, const Pose& tool, const Vec3& point, const Vec3& direction);

/// Angle about the axis of `to` by which the x axis of `from`, made perpendicular to it, meets that of `to` (rad).
double rollBetween(const Quat& from, const Quat& to);

/// The tool after a displacement of its tip and a roll, still through the port.
Pose movedTool(const Vec3& port, const Pose& tool, const Vec3& displacement, double roll);

}  // namespace calot
