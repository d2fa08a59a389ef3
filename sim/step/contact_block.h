// SPDX-License-Identifier: GPL-3.0-or-later
// The contact problem of a step as values: what detection finds, what the solver decides. Internal to this folder.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/contact/contact_solver.h"
#include "sim/contact/sphere_indentation.h"
#include "sim/instruments/port.h"
#include "sim/scene/samples.h"
#include "sim/solid/solid.h"

namespace calot {

/// One block of the contact problem: an instrument on a structure, tissue on tissue, grasped tissue, or an instrument
/// on the other.
struct ContactBlock {
  static constexpr std::size_t none = ~std::size_t{0};

  BlockKind kind = BlockKind::frictional;
  double limit = 0.0;            ///< friction coefficient; largest force of a grasp (N)
  double softness = 0.0;         ///< by which tissue sinks into tissue for the force at this point (m/N)
  std::size_t hand = none;       ///< whose instrument is pushed along +direction,
  std::size_t other = none;      ///< or which body is,
  std::size_t body = none;       ///< and which body along -direction,
  std::size_t otherHand = none;  ///< or whose instrument
  std::size_t structure = 0;     ///< whose skin that is
  std::size_t anchor = none;     ///< of a grasp: index of the grasped point
  std::array<Vec3, 3> direction{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  SolidSolver::Impulse place, otherPlace;  ///< nodes and weights at which the bodies are pushed
  std::array<ToolRow, 3> tool{ToolRow::Zero(), ToolRow::Zero(), ToolRow::Zero()};
  std::array<ToolRow, 3> otherTool{ToolRow::Zero(), ToolRow::Zero(), ToolRow::Zero()};  ///< of otherHand, signed
  std::array<double, 3> gap{};  ///< now; slip counts from the step's beginning (m)
  Vec3 where = Vec3::Zero();    ///< of instruments on each other: the place (m, W)
  std::uint64_t key = 0;        ///< names the contact point: equal in two steps means the same one
  /// For an instrument on an organ (contact_dimples.h): the capsule's radius, its number, the place on the skin, the
  /// size of the patch over which the mesh spreads a force there (m), and the dimple that it presses.
  double radius = 0.0;
  std::size_t piece = 0;
  Vec3 foot = Vec3::Zero();
  Vec3 smooth = Vec3::Zero();  ///< the skin's normal there, without its edges
  double spread = 0.0;
  std::size_t dimple = none;
  double share = 0.0;   ///< of a force along the normal, in the direction in which that gives way
  std::size_t row = 0;  ///< its first row

  [[nodiscard]] std::size_t rows() const { return blockRows(kind); }
  [[nodiscard]] bool isTissueOnTissue() const { return hand == none; }
  [[nodiscard]] bool isGrasp() const { return anchor != none; }
  /// An instrument on the other.
  [[nodiscard]] bool isClash() const { return otherHand != none; }
  /// Rows of a hand's instrument; null where it takes no part.
  [[nodiscard]] const std::array<ToolRow, 3>* toolOf(std::size_t which) const {
    if (which == none) return nullptr;
    return which == hand ? &tool : which == otherHand ? &otherTool : nullptr;
  }
};

/// Contact-free motion of an instrument, and the displacement that the virtual coupling still demands.
struct InstrumentTravel {
  Pose before;                        ///< simulated pose at the step's beginning
  Pose reference;                     ///< simulated pose after the contact-free advance
  ToolRow stretch = ToolRow::Zero();  ///< of the virtual coupling: from `reference` to the real pose
  double reach = 0.0;                 ///< how far contacts are looked for (m)
};
using InstrumentTravels = std::array<InstrumentTravel, handCount>;

/// Pressure of one capsule of an instrument on an organ (contact_dimples.h).
struct Dimple {
  std::size_t hand = 0;
  std::uint64_t key = 0;       ///< structure and capsule
  double radius = 0.0;         ///< of the capsule (m)
  double modulus = 0.0;        ///< E* of the organ (Pa)
  double newShare = 1.0;       ///< w, of the elastic dimple in that of a step
  Vec3 before = Vec3::Zero();  ///< of the last step (m)
  Vec3 way = Vec3::Zero();     ///< in which it gives way: the skin's normal, without its edges
  double force = 0.0;          ///< along that (N)
  Indentation end;             ///< by how much deeper the capsule sinks in than a flat end
};

/// The contact problem of a step: gap = W lambda + free, blocks in the order of hands, structures and contact points,
/// grasps, instruments on each other, then tissue on tissue. n rows.
struct ContactSystem {
  std::vector<ContactBlock> blocks;
  std::size_t rows = 0;
  std::vector<BlockKind> kinds;            ///< per block
  std::vector<double> limits;              ///< per block
  std::vector<double> carried;             ///< forces under which the tissue moves already (N)
  std::vector<double> lambda;              ///< forces decided so far (N)
  std::vector<double> trueGap;             ///< with `carried` applied to the tissue (m)
  std::vector<double> freeGap;             ///< gaps without any force, as the problem sees them (m)
  std::vector<double> tissueCompliance;    ///< estimate of the tissue's response, n x n (m/N)
  std::vector<double> couplingCompliance;  ///< of the virtual couplings, n x n (m/N)
  std::vector<double> compliance;          ///< W: both and the dimples', n x n (m/N)
  std::vector<Dimple> dimples;
  std::vector<std::size_t> pressed;      ///< blocks that press dimples; m of them
  std::vector<double> sharedDimple;      ///< K of their normals, m x m (m/N)
  std::vector<double> dimpleGap;         ///< by which dimples open the rows, part of `trueGap` (m)
  std::vector<double> dimpleCompliance;  ///< derivative of that of the blocks that press, m x m (m/N)

  /// Numbers the blocks' rows in order; lists kinds and limits.
  void numberRows();
};

/// Adds to a body's nodes what forces (or impulses) in the rows do to it. @param nodal stays empty where that is
/// nothing
/// @param forces a value per row @param nodes of the body
void addNodalForces(std::span<const ContactBlock> blocks, std::size_t body, std::size_t nodes,
                    std::span<const double> forces, double scale, std::vector<Vec3>& nodal);

}  // namespace calot
