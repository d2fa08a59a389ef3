// SPDX-License-Identifier: GPL-3.0-or-later
// What an instrument is for contact: a union of capsules, rigid in its frame I (origin at the tip, z along the shaft
// towards the tip, x along the jaws' hinge). The implicit function at p is the least over all capsules of
//   |p - (nearest point of the capsule's segment)| - radius.
//
// Sizes are typical of 5 mm laparoscopic instruments and scale with the shaft's radius (a 10 mm clip applier is twice
// as large). They are those of the pictures (gui/render/instrument_mesh.cpp): what is drawn stands out of this shape by
// at most 0.9 mm, at the corners of the fork that holds the hinge (tests/gui/render/instrument_agreement_test.cpp).
//   grasper       jaws 17 mm, 3.9 to 2.6 mm wide
//   scissors      blades 15 mm, curved
//   clip applier  jaws 16 mm at 5 mm, with a lift that leaves room for a clip
//   hook          L hook: wire of 1.2 mm, toe 4.6 mm
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "sim/math/linear.h"
#include "sim/scene/samples.h"

namespace calot {

/// All points within `radius` of segment p0-p1. In I or in W, as its owner says.
struct Capsule {
  enum class Part : std::uint8_t { shaft, neck, upperJaw, lowerJaw, hook };

  Vec3 p0 = Vec3::Zero();  ///< m
  Vec3 p1 = Vec3::Zero();  ///< m
  double radius = 0.0;     ///< m
  Part part = Part::shaft;
  std::uint8_t piece = 0;  ///< unique within the instrument and the same at every jaw angle and length
};

/// Fixed capacity, no allocation: a value to be made anew whenever the jaw or the insertion changes.
class InstrumentShape {
 public:
  static constexpr std::size_t mostPieces = 15;  ///< of the shaft; the last takes the rest of it
  static constexpr std::size_t capacity = mostPieces + 9;
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
  friend InstrumentShape instrumentShape(InstrumentKind kind, double jaw, double shaftRadius, double length);
  friend InstrumentShape placed(const InstrumentShape& shape, const Pose& pose);
  void add(const Vec3& p0, const Vec3& p1, double radius, Capsule::Part part);
  void addJaw(const Vec3& p0, const Vec3& p1, double radius, double hinge, double cosine, double sine);
  void addShaft(double end, double length, double radius);
  void measure(double hinge);

  std::array<Capsule, capacity> capsule_{};
  std::size_t count_ = 0;
  double jawReach_ = 0.0;
  double lateralReach_ = 0.0;
};

/// The shape in I. @param jaw opening angle (rad), symmetric about z in the plane y-z, clamped to [0, widestJaw]
/// @param shaftRadius m @param length from the port to the tip (m). `InstrumentKind::none` has no capsules.
InstrumentShape instrumentShape(InstrumentKind kind, double jaw, double shaftRadius, double length);

/// The same shape in W. @param pose p_WI, q_WI
InstrumentShape placed(const InstrumentShape& shape, const Pose& pose);

/// Where a grasper holds tissue: between the toothed faces of its jaws, a wedge that closes with them.
struct GraspRegion {
  double hinge = 0.0;      ///< z_I of the hinge's line (m)
  double from = 0.0;       ///< z_I where the teeth begin (m)
  double to = 0.0;         ///< z_I where they end (m)
  double halfWidth = 0.0;  ///< along x_I (m)
  double slope = 0.0;      ///< tangent of half the jaw angle
  double slack = 0.0;      ///< half the thickness that closed jaws leave to tissue (m)

  /// The line between the closed jaws along which tissue is held, in I (m).
  [[nodiscard]] std::pair<Vec3, Vec3> line() const { return {Vec3(0.0, 0.0, from), Vec3(0.0, 0.0, to)}; }
  /// Is a point in I between the jaws?
  [[nodiscard]] bool contains(const Vec3& p) const {
    const double half = slack + slope * (p[2] - hinge);
    return p[2] >= from && p[2] <= to && p[0] >= -halfWidth && p[0] <= halfWidth && p[1] >= -half && p[1] <= half;
  }
  /// Bounds of the region in I (m).
  [[nodiscard]] Box box() const {
    const double half = slack + slope * (to - hinge);
    return {Vec3(-halfWidth, -half, from), Vec3(halfWidth, half, to)};
  }
};

/// The region of a grasper. @param jaw rad, clamped as above; beyond 2 rad the region no longer widens
GraspRegion graspRegion(double jaw, double shaftRadius);

}  // namespace calot
