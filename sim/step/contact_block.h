// SPDX-License-Identifier: GPL-3.0-or-later
// The contact problem of a step as values: what detection finds, what the solver decides. Internal to this folder.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/contact/contact_solver.h"
#include "sim/contact/sphere_indentation.h"
#include "sim/instruments/instrument_shape.h"
#include "sim/scene/model.h"
#include "sim/scene/samples.h"
#include "sim/scene/state.h"
#include "sim/scene/step_result.h"
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
  /// For an instrument on an organ (findDimples()): the capsule's radius, its number, the place on the skin, the
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

/// Pressure of one capsule of an instrument on an organ (findDimples()).
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

/// The events and missed tolerances of the step at hand, in the order in which the stages report them.
class StepLog {
 public:
  /// Event::hand of an event that no instrument causes.
  static constexpr std::size_t noHand = 255;

  /// @param result outlives the log; its events and misses start empty.
  explicit StepLog(StepResult& result) : result_(result) {
    result_.events.clear();
    result_.misses = 0;
  }

  /// @param subject a structure, or what EventKind names. @param position p_W (m)
  void emit(EventKind kind, std::size_t hand, std::size_t subject, const Vec3& position, double value) {
    result_.events.push_back(
        {result_.step, kind, static_cast<std::uint8_t>(hand), static_cast<std::uint16_t>(subject), position, value});
  }
  /// @param tolerance a bit of calot::miss
  void miss(std::uint32_t tolerance) { result_.misses |= tolerance; }
  [[nodiscard]] bool hasMissed(std::uint32_t tolerance) const { return (result_.misses & tolerance) != 0; }

 private:
  StepResult& result_;
};

// The dimple under an instrument that presses on an organ, which the mesh is too coarse to resolve.
//
// A force on a mesh of cells of size h acts as if it were spread over a patch of size e: the mesh is stiffer to an
// instrument than tissue is, the more so the coarser it is. What is missing is known of the half-space that tissue is
// near the surface (sim/contact/sphere_indentation.h). It gives way along its smooth normal N, of which the rows'
// normals n_i have the shares p_i = n_i . N. Normal rows i of a hand on an organ, with forces l at the places x of the
// skin, open by
//   p_i u_i(l),  u_i = sum_j K_ij p_j l_j + g(F),
//   K_ij = k(|x_i - x_j|; s) - k(|x_i - x_j|; e),  F = sum of p_j l_j over the rows of one capsule of the instrument,
// k the Green's function of a load that is spread (by the instrument, s; by the mesh, e), and g by how much deeper a
// round end sinks in than a flat one. So the rows of a capsule share one dimple, however many the mesh makes, and
// capsules side by side press on each other's.
//
// Tissue is viscous: u + beta du/dt takes the place of u, beta the organ's stiffness damping, as in its mesh. By
// implicit Euler, u = w u(l) + (1 - w) u_before with w = h / (h + beta), which dissipates at any step. u_before is
// State.

/// Depth by which a structure's skin gives way to a hand's capsule beyond what the mesh resolves (m): detection takes
/// the capsule as much farther out.
Vec3 dimpleOf(const HandState& hand, std::size_t structure, std::size_t piece);

/// Size of the patch over which an organ's mesh spreads a force that its nodes take, as seen from a place on its skin
/// (m).
double meshSpread(const OrganModel& organ, const SolidSolver::Impulse& place, const SolidSolver::Impulse& force);

/// Collects the dimples of the blocks and what does not change within a step: `contact.dimples`,
/// `contact.sharedDimple`.
/// @pre rows are numbered
void findDimples(const Model& model, const State& state, double step, ContactSystem& contact);

/// By how much the dimples open the rows' gaps under these forces, and the derivative of that: `contact.dimpleGap`,
/// `contact.dimpleCompliance`. @pre findDimples()
void evaluateDimples(std::span<const double> lambda, ContactSystem& contact);

/// The same without the derivative.
void evaluateDimpleGaps(std::span<const double> lambda, ContactSystem& contact);

/// Keeps the dimples for the next step; those that nothing presses fade. @pre `contact.dimpleGap` is that of
/// `contact.lambda`
void storeDimples(const Model& model, double step, const ContactSystem& contact, State& state);

}  // namespace calot
