// SPDX-License-Identifier: GPL-3.0-or-later
// Contact points of fat with organs and with vessels. Internal to this folder.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/step/bodies.h"
#include "sim/step/contact_block.h"
#include "sim/step/surfaces.h"
#include "sim/step/tissue_travel.h"

namespace calot {

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
  double run(Surfaces& surfaces, const Bodies& bodies, const TissueTravel& travel, const State& state,
             const std::vector<bool>& awake, std::vector<ContactBlock>& blocks);

  /// Searches among triangles or capsules in the last run().
  [[nodiscard]] std::size_t searches() const { return searches_; }

 private:
  /// A body that fat can touch: an organ, or a vessel.
  struct Target {
    std::size_t structure = 0, body = 0;
    std::size_t vessel = ContactBlock::none;  ///< in TissueTravel's order
    double radius = 0.0;                      ///< of a vessel (m)
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
  Nearest nearestOn(Surfaces& surfaces, const TissueTravel& travel, const State& state, const Target& target,
                    const Vec3& from, double limit);
  double restDistance(const TissueTravel& travel, const Target& target, const Fat& fat, std::size_t cube, Pair& pair);
  double touch(Surfaces& surfaces, const TissueTravel& travel, const State& state, const FatBody& body, double step,
               Fat& fat, std::size_t target, std::vector<ContactBlock>& blocks);

  const Model& model_;
  std::vector<Target> target_;  ///< organs, then vessels
  std::vector<Fat> fat_;
  std::vector<double> gap_;  ///< of the blocks added, as found (m)
  std::vector<std::uint32_t> all_;
  std::size_t searches_ = 0;
};

}  // namespace calot
