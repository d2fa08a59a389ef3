// SPDX-License-Identifier: GPL-3.0-or-later
// Contact points of vessels with organs and with other vessels. Internal to this folder.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/contact/capsule_contact.h"
#include "sim/step/bodies.h"
#include "sim/step/contact_block.h"
#include "sim/step/surfaces.h"
#include "sim/step/tissue_travel.h"

namespace calot {

/// Along a vessel from where it is grown to an organ or runs into it (its axis is inside in the reference
/// configuration), in which it does not touch that organ: there it is held (m). Larger: it passes through the organ
/// beside its root; smaller: contact and tie pull against each other. Assumed: twice the length over which ends are
/// tied.
inline constexpr double tiedReach = 0.006;
/// By which a vessel sinks into an organ or another vessel for the force at a contact point (m/N). Of few points, each
/// carries much: ten times harder than organs on organs. Larger: visible overlap; smaller: rows that repeat each other.
/// Assumed.
inline constexpr double vesselSoftness = 1e-4;
/// Vessels of one tree touch each other only farther apart along the tree than this many times the sum of their radii:
/// at their junction they are one wall. Larger: they pass through each other beside it; smaller: a bent junction pushes
/// itself apart. Assumed.
inline constexpr double junctionReach = 4.0;

/// Capsules of vessels against triangles of organs and against capsules of other vessels. Wet tissue on wet tissue
/// slides without friction, as organs do: blocks are unilateral. Rows are the capsules' ends, each once, and a point
/// between them where that is deeper than both: a vessel that lies along a surface rests on all its nodes, and an edge
/// or another vessel that crosses it between two is felt.
///
/// A capsule that overlaps an organ or another vessel in the reference configuration is measured from that depth,
/// however large: what a scene draws into each other does not push at rest.
///
/// Bodies that are far apart are not searched. For each capsule and each organ the last distance found is kept, less
/// what both have moved since; while that is out of reach, no triangle is. This changes no result, so it is no part of
/// State.
class VesselContacts {
 public:
  /// @param travel of the same model
  VesselContacts(const Model& model, const TissueTravel& travel);

  void invalidate();
  /// Adds the blocks of pairs of which one is awake. @return deepest overlap beyond that at rest (m)
  /// @pre surfaces are current; the travel has followed each step since the last run or invalidate()
  double run(Surfaces& surfaces, const TissueTravel& travel, const State& state, double step,
             const std::vector<bool>& awake, std::vector<ContactBlock>& blocks);

  /// Searches among triangles or capsules in the last run().
  [[nodiscard]] std::size_t searches() const { return searches_; }

 private:
  /// The last distance found, less motion since.
  struct Clearance {
    double distance = -1.0;  ///< of the axis from the other surface or axis (m); negative: unknown
    bool outside = false;    ///< surely
  };
  /// Contacts of one vessel.
  struct Nearby {
    // Per organ:
    std::vector<std::vector<double>> restOffset;  ///< per element: gap at rest where they overlap, or 0 (m)
    std::vector<std::vector<bool>> tied;          ///< per element
    std::vector<std::vector<Clearance>> toOrgan;  ///< per capsule
    // Per vessel:
    std::vector<std::vector<Clearance>> toVessel;
  };
  using Vessel = TissueTravel::Vessel;

  /// A point of an organ's surface near a vessel.
  struct Point {
    double gap = 1e300;
    Vec3 normal = Vec3::Zero();  ///< unit, from the organ towards the vessel
    std::array<int, 3> node{};
    Vec3 weight = Vec3::Zero();
  };

  void measureRest(const Vessel& vessel, Nearby& nearby);
  [[nodiscard]] Point endOnOrgan(const Surfaces& surfaces, std::size_t organ, std::span<const std::uint32_t> patches,
                                 const Vec3& end, double radius, double reach) const;
  double touchOrgan(Surfaces& surfaces, const TissueTravel& travel, const State& state, double step, std::size_t organ,
                    std::size_t vessel, std::vector<ContactBlock>& blocks);
  double touchVessel(const TissueTravel& travel, double step, std::size_t one, std::size_t two,
                     std::vector<ContactBlock>& blocks);
  [[nodiscard]] bool areOneWall(const Vessel& a, std::size_t i, const Vessel& b, std::size_t j) const;
  [[nodiscard]] static double restOverlap(const Vessel& a, std::size_t i, const Vessel& b, std::size_t j);

  const Model& model_;
  std::vector<TreeDistances> distances_;  ///< per tree
  std::vector<Nearby> nearby_;            ///< per vessel, in TissueTravel's order
  std::vector<SurfaceContact> found_;
  std::size_t searches_ = 0;
};

/// The number that the keys of contact of two structures have in their bits from 40 up: after those of pairs of organs.
std::uint64_t structurePairNumber(const Model& model, std::size_t a, std::size_t b);
/// The structures of such a number. @pre it is no pair of organs
std::array<std::size_t, 2> structuresOfPair(const Model& model, std::uint64_t number);

}  // namespace calot
