// SPDX-License-Identifier: GPL-3.0-or-later
// The contact problem of a step as values: what detection finds, what the solver decides. Internal to this folder.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <variant>
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

/// A body that a block pushes, at nodes of its own.
struct PushedBody {
  std::size_t body = 0;
  SolidSolver::Impulse place;
};

/// An instrument that a block pushes, by what a force in each of the block's rows does to it.
struct PushedTool {
  std::size_t hand = 0;
  std::array<ToolRow, 3> row{ToolRow::Zero(), ToolRow::Zero(), ToolRow::Zero()};
};

/// How a capsule of an instrument presses on soft tissue (findDimples()).
struct Press {
  double radius = 0.0;         ///< of the capsule (m)
  double size = 0.0;           ///< radius of a round end as large as what of the capsule touches (m)
  std::size_t piece = 0;       ///< its number
  Vec3 foot = Vec3::Zero();    ///< the place on the skin (m)
  Vec3 smooth = Vec3::Zero();  ///< the skin's normal there, without its edges
  double spread = 0.0;         ///< size of the patch over which the mesh spreads a force there (m)
  std::size_t dimple = 0;      ///< that it presses
  double share = 0.0;          ///< of a force along the normal, in the direction in which that gives way
};

// A block's direction points from what is pushed against it to what is pushed along it.

/// An instrument, pushed along, on a structure's skin.
struct ToolOnTissue {
  PushedTool tool;
  PushedBody tissue;
  std::size_t structure = 0;
  std::optional<Press> press;  ///< of soft tissue, where the scene has dimples
};

/// An instrument, pushed along, that holds tissue.
struct Grasped {
  PushedTool tool;
  PushedBody tissue;
  std::size_t anchor = 0;  ///< index of the grasped point
};

/// The left instrument, pushed along, on the right one.
struct ToolOnTool {
  PushedTool left, right;
  Vec3 where = Vec3::Zero();  ///< p_W (m)
};

/// Wet tissue on wet tissue, which slides without friction.
struct TissueOnTissue {
  PushedBody along, against;
  double softness = 0.0;  ///< by which tissue sinks into tissue for the force at this point (m/N)
};

/// The key of an instrument's touch has its structure in the bits from here up to those of the capsule.
inline constexpr unsigned structureShift = 52;
static_assert(maxStructures <= std::size_t{1} << (56U - structureShift));

/// One block of the contact problem.
struct ContactBlock {
  std::variant<ToolOnTissue, Grasped, ToolOnTool, TissueOnTissue> of;
  BlockKind kind = BlockKind::frictional;
  double limit = 0.0;  ///< friction coefficient; largest force of a grasp (N)
  std::array<Vec3, 3> direction{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  std::array<double, 3> gap{};  ///< now; slip counts from the step's beginning (m)
  std::uint64_t key = 0;        ///< names the contact point: equal in two steps means the same one
  std::size_t row = 0;          ///< its first row

  [[nodiscard]] std::size_t rows() const { return blockRows(kind); }
  /// The block as one of its kinds, or null.
  template <class Kind>
  [[nodiscard]] const Kind* as() const {
    return std::get_if<Kind>(&of);
  }
  /// The instrument of one that touches or holds tissue, or null.
  [[nodiscard]] const PushedTool* tool() const;
  /// Rows of a hand's instrument, or null.
  [[nodiscard]] const std::array<ToolRow, 3>* toolOf(std::size_t hand) const;
  /// The bodies, or null.
  [[nodiscard]] const PushedBody* along() const;
  [[nodiscard]] const PushedBody* against() const;
  /// How it presses, or null.
  [[nodiscard]] const Press* press() const;
  [[nodiscard]] Press* press() { return const_cast<Press*>(std::as_const(*this).press()); }
};

/// Contact-free motion of an instrument, and the displacement that the virtual coupling still demands.
struct InstrumentTravel {
  Pose before;                        ///< simulated pose at the step's beginning
  Pose reference;                     ///< simulated pose after the contact-free advance
  ToolRow stretch = ToolRow::Zero();  ///< of the virtual coupling: from `reference` to the real pose
  double reach = 0.0;                 ///< how far contacts are looked for (m)
};
using InstrumentTravels = std::array<InstrumentTravel, handCount>;

/// Pressure of one capsule of an instrument on soft tissue (findDimples()).
struct Dimple {
  std::size_t hand = 0;
  std::uint64_t key = 0;       ///< structure and capsule
  double radius = 0.0;         ///< of the capsule (m)
  double size = 0.0;           ///< Press::size (m)
  double modulus = 0.0;        ///< E* of the tissue (Pa)
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
  std::vector<double> ruler;               ///< the same of the reference configuration, by which errors are measured
  std::vector<Dimple> dimples;
  std::vector<std::size_t> pressed;      ///< blocks that press dimples; m of them
  std::vector<double> sharedDimple;      ///< K of their normals, m x m (m/N)
  std::vector<double> dimpleGap;         ///< by which dimples open the rows, part of `trueGap` (m)
  std::vector<double> dimpleCompliance;  ///< derivative of that of the blocks that press, m x m (m/N)
  ResponseState learned;                 ///< of this step and those before

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
Vec3 dimpleOf(const TouchState& touches, std::size_t structure, std::size_t piece);

/// Size of the patch over which a structure's mesh spreads a force that its nodes take, as seen from a place on its
/// skin (m).
double meshSpread(const StructureModel& structure, const SolidSolver::Impulse& place,
                  const SolidSolver::Impulse& force);

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
