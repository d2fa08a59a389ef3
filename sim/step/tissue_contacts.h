// SPDX-License-Identifier: GPL-3.0-or-later
// Contact points of tissue on tissue: of an organ with others and with itself, of vessels with organs and with other
// vessels, of fat with organs and with vessels. Internal to this folder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "sim/contact/capsule_contact.h"
#include "sim/contact/surface_surface.h"
#include "sim/math/linear.h"
#include "sim/scene/model.h"
#include "sim/scene/state.h"
#include "sim/solid/solid.h"
#include "sim/step/bodies.h"
#include "sim/step/contact_block.h"
#include "sim/step/surfaces.h"

namespace calot {

/// Overlap that tissue is left (m): contacts stay closed in spite of rounding. Larger shows; smaller chatters.
/// Assumed.
inline constexpr double allowedOverlap = 2e-5;
/// By which overlapping tissue parts in one step (m). Larger throws it apart; smaller lets overlaps last. Assumed.
inline constexpr double maxRecovery = 0.0005;

/// True if the tissue at a vertex of an organ's skin is inverted. Outward is then inward there, and contact would
/// hold it so.
bool isInverted(const Model& model, const State& state, std::size_t organ, int vertex);

/// Keeps, among the blocks from `first` on, the `limit` smallest gaps, in their order. Where tissue is crumpled,
/// hundreds of its points are inside of it: more rows than its nodes can respond to. @param gap of those blocks, as
/// found (m)
void keepDeepest(std::size_t first, std::size_t limit, std::span<const double> gap, std::vector<ContactBlock>& blocks);

/// Vertices of one organ against triangles of another; wet tissue on wet tissue slides without friction, so blocks are
/// unilateral.
class TissueContacts {
 public:
  explicit TissueContacts(const Model& model);

  void invalidate();
  /// Computes ahead the tables of the reference configurations. Changes no result.
  void precompute();
  /// Adds blocks of organs that are awake, at most `maxTissueContacts`. @return deepest overlap beyond that at rest (m)
  /// @pre surfaces are current
  double run(const Surfaces& surfaces, const State& state, const std::vector<bool>& awake,
             std::vector<ContactBlock>& blocks);

 private:
  const SurfacePair& restOf(std::size_t pair);
  const SurfaceDisplacement& displacementOf(const Surfaces& surfaces, std::size_t organ);
  double addPair(const Surfaces& surfaces, const State& state, std::size_t number, std::vector<ContactBlock>& blocks);

  const Model& model_;
  std::vector<std::unique_ptr<const SurfacePair>> selfRest_;  ///< per organ; empty until it folds
  std::vector<NearTriangles> nearTriangles_;                  ///< per tissue pair
  std::vector<SurfaceDisplacement> displacement_;             ///< per organ
  std::vector<std::uint32_t> patches_;
  std::vector<Box> queries_;
  std::vector<BroadPhase::Pair> pairs_;
  std::vector<VertexContact> found_;
  std::vector<double> gap_;  ///< of the blocks among organs, as found (m)
};

// Travel of organs and vessels since the last step, and bounds of vessels: bodies that are far apart are not searched
// for contact until it may have come near.

// Vessels as capsules, for their contact with other tissue: one along each element; two where it is parted, one a
// stump. Internal to this folder.

/// A straight piece of a vessel.
struct VesselCapsule {
  Vec3 p0 = Vec3::Zero();  ///< ends of its axis, towards the vessel's start and end (m, W)
  Vec3 p1 = Vec3::Zero();
  int node0 = 0;  ///< nodes that the ends follow; of a stump, both are the node that it hangs on
  int node1 = 0;
  std::size_t element = 0;  ///< of the branch, from 0
  bool after = false;       ///< the stump beyond a parting

  /// A place on its axis in terms of the vessel's nodes. @param s share of the way from p0 to p1
  [[nodiscard]] SolidSolver::Impulse place(double s) const;
};

/// Capsules of a branch in the order of its elements.
void vesselCapsules(const BeamModel& beams, const BeamState& state, std::size_t branch,
                    std::vector<VesselCapsule>& out);

/// Distances along a tree of vessels between its nodes at rest (m).
class TreeDistances {
 public:
  explicit TreeDistances(const BeamModel& beams);
  [[nodiscard]] double between(int a, int b) const {
    return distance_[static_cast<std::size_t>(a) * nodes_ + static_cast<std::size_t>(b)];
  }

 private:
  std::size_t nodes_;
  std::vector<double> distance_;
};

/// As far ahead as contact is sought for what comes fast (m). Larger: rows that stay open; smaller: passes through.
/// Assumed: what the fastest vessel goes in half a step.
inline constexpr double maxApproach = 0.05;

/// Derived from State alone, but from two of them: after a jump everything counts as moved.
class TissueTravel {
 public:
  struct Vessel {
    std::size_t tree = 0, branch = 0, structure = 0, body = 0;
    double radius = 0.0;  ///< m
    std::vector<VesselCapsule> rest;
    std::vector<VesselCapsule> now;
    std::vector<VesselCapsule> before;  ///< as `now` in the last follow()
    double motion = 0.0;                ///< largest of any end since the last follow() (m)
    double speed = 0.0;                 ///< largest of its tree's nodes (m/s)
  };

  explicit TissueTravel(const Model& model);

  /// To be called when the State was replaced.
  void invalidate();
  /// @pre surfaces are current
  void follow(const Surfaces& surfaces, const Bodies& bodies, const State& state, const std::vector<bool>& awake);

  /// In the order of structures.
  [[nodiscard]] std::span<const Vessel> vessels() const { return vessel_; }
  /// Largest motion of an organ's skin since the last follow() (m).
  [[nodiscard]] double organMotion(std::size_t organ) const { return organMotion_[organ]; }
  /// Largest speed of its nodes; 0 asleep (m/s).
  [[nodiscard]] double organSpeed(std::size_t organ) const { return organSpeed_[organ]; }

 private:
  const Model& model_;
  std::vector<Vessel> vessel_;
  std::vector<std::vector<Vec3>> organBefore_;
  std::vector<double> organMotion_, organSpeed_;
  std::vector<bool> wasAwake_;
};

/// Between the nearest points of two boxes (m).
inline double distanceOf(const Box& a, const Box& b) {
  return notNegative(Vec3((a.lower - b.upper).cwiseMax(b.lower - a.upper))).norm();
}

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
  double run(const Surfaces& surfaces, const TissueTravel& travel, const State& state, double step,
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
  double touchOrgan(const Surfaces& surfaces, const TissueTravel& travel, const State& state, double step,
                    std::size_t organ, std::size_t vessel, std::vector<ContactBlock>& blocks);
  double touchVessel(const TissueTravel& travel, double step, std::size_t one, std::size_t two,
                     std::vector<ContactBlock>& blocks);
  [[nodiscard]] bool areOneWall(const Vessel& a, std::size_t i, const Vessel& b, std::size_t j) const;
  [[nodiscard]] static double restOverlap(const Vessel& a, std::size_t i, const Vessel& b, std::size_t j);

  const Model& model_;
  std::vector<TreeDistances> distances_;  ///< per tree
  std::vector<Nearby> nearby_;            ///< per vessel, in TissueTravel's order
  std::vector<SurfaceContact> found_;
  Surfaces::Search search_;
  std::size_t searches_ = 0;
};

/// Keys of contact have the number of their pair in the bits from here up; below, a vertex, a cube or a capsule.
inline constexpr unsigned pairShift = 40;
/// The number of two structures: after those of pairs of organs.
std::uint64_t structurePairNumber(const Model& model, std::size_t a, std::size_t b);
/// The structures of such a number. @pre it is no pair of organs
std::array<std::size_t, 2> structuresOfPair(const Model& model, std::uint64_t number);

/// Each cube of fat counts as an ellipsoid of the fat that is left in it, flattened as the cube is, and touches organs
/// and vessels without friction, as all wet tissue: one row a cube and a structure, at the ellipsoid's point that is
/// nearest. A cube touches only what lies on a side on which the cube beside it is gone: where the next cube is there,
/// that one touches.
///
/// A cube does not touch a body that it is tied to until the last of those ties is gone. A cube that overlaps an organ
/// or a vessel in the reference configuration is measured from that depth; one whose middle lies in it there never
/// touches it.
///
/// Bodies that are far apart are not searched: for each cube and each organ or vessel the last distance found is kept,
/// less what both have moved since. This changes no result, so it is no part of State.
class FatContacts {
 public:
  /// @param travel of the same model
  FatContacts(const Model& model, const TissueTravel& travel);

  void invalidate();
  /// Adds the blocks of pairs of which one is awake, the deepest of each body of fat. @return deepest overlap beyond
  /// that at rest (m)
  /// @pre surfaces are current; the travel has followed each step since the last run or invalidate()
  double run(const Surfaces& surfaces, const Bodies& bodies, const TissueTravel& travel, const State& state,
             const std::vector<bool>& awake, std::vector<ContactBlock>& blocks);

  /// Searches among triangles or capsules in the last run().
  [[nodiscard]] std::size_t searches() const { return searches_; }

 private:
  /// A body that fat can touch: an organ, or a vessel.
  struct Target {
    std::size_t structure = 0, body = 0;
    std::optional<std::size_t> vessel;  ///< in TissueTravel's order
    double radius = 0.0;                ///< of a vessel (m)
  };
  /// One body of fat and one target.
  struct Pair {
    std::vector<std::vector<std::size_t>> ties;  ///< per cube: its ties to the target
    std::vector<double> restDistance;            ///< per cube: of its middle at rest, negative inside; NaN: unknown (m)
    /// Per cube: its middle is at least this far from the target's surface or axis; negative: unknown (m).
    std::vector<double> clearance;
  };
  struct Fat {
    std::size_t index = 0, structure = 0, body = 0;
    std::vector<Pair> pair;  ///< per target
    // Per cube:
    std::vector<Vec3> middle;    ///< m
    std::vector<double> motion;  ///< of the middle since the last run (m)
    std::vector<double> speed;   ///< of the middle (m/s)
    std::vector<double> size;    ///< radius of the ball of its fat, in edges; 0: cannot touch
    bool known = false;          ///< these are of the last run
    bool wasAwake = true;
  };
  /// The nearest point of a target to the middle of a cube.
  struct Nearest {
    bool found = false;
    double distance = 0.0;  ///< negative inside an organ (m)
    Vec3 point = Vec3::Zero();
    SolidSolver::Impulse place;
    bool inverted = false;
  };

  void tie(Fat& fat);
  static void follow(const FatBody& body, const State& state, bool awake, Fat& fat);
  static void wear(const Fat& fat, double motion, std::vector<double>& clearance);
  Nearest nearestOn(const Surfaces& surfaces, const TissueTravel& travel, const State& state, const Target& target,
                    const Vec3& from, double limit);
  double restDistance(const TissueTravel& travel, const Target& target, const Fat& fat, std::size_t cube, Pair& pair);
  double touch(const Surfaces& surfaces, const TissueTravel& travel, const State& state, const FatBody& body,
               double step, Fat& fat, std::size_t target, std::vector<ContactBlock>& blocks);

  const Model& model_;
  std::vector<Target> target_;  ///< organs, then vessels
  std::vector<Fat> fat_;
  std::vector<double> gap_;  ///< of the blocks added, as found (m)
  std::vector<std::uint32_t> all_;
  Surfaces::Search search_;
  std::size_t searches_ = 0;
};

}  // namespace calot
