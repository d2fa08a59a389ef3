// SPDX-License-Identifier: GPL-3.0-or-later
// A body of fat: everything derived from its State, and the strokes that change it.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "sim/carving/carved_field.h"
#include "sim/carving/carved_surface.h"
#include "sim/contact/surface_patches.h"
#include "sim/fat/fat_model.h"

namespace calot {

/// A node of the fat's surface: coordinates in its cube in units of its edge, slightly beyond the cube at most.
struct SkinNode {
  double x, y, z;
  std::uint32_t number;
  std::int32_t cube;
};

/// A CarvedSurface as a ContactSurface. All indices are functions of the field alone, so that order, ties and keys
/// equal those of a rebuilt surface:
/// - node 192 rank + 64 axis + x + 4 y + 16 z is a lattice edge: the rank of its block (FatModel) and the position of
///   its lower end in the block. A vertex keeps its index as long as it exists.
/// - triangle 320 rank + k is the k-th of a block (four cells along each axis hold at most 320). Contact keys use
///   triangle names (SurfacePatch), which a stroke in the same block changes only where it changes their cell.
/// - patches are those of the CarvedSurface, in order of their keys.
///
/// The cost of a stroke is proportional to the number of blocks that it changed, plus some 10 ns per patch for
/// the list of patches.
class CarvedContact final : public SurfaceTopology {
 public:
  /// Trilinear map of one cube: coefficients of 1, x, y, z, xy, xz, yz, xyz, each three components and one of padding.
  using CubeMap = std::array<double, 32>;

  static constexpr std::uint32_t nodesOfBlock = 192;
  static constexpr std::uint32_t trianglesOfBlock = 320;

  /// @param model, field outlive this
  CarvedContact(const FatModel& model, const CarvedField& field);
  CarvedContact(const CarvedContact&) = delete;
  CarvedContact& operator=(const CarvedContact&) = delete;

  /// Rebuilds everything. @pre the surface is that of the field, and the field the model's
  void rebuild(const CarvedSurface& surface);
  /// Rebuilds what the last stroke changed. @pre the surface was updated, and update() or rebuild()
  /// ran after every stroke
  void update(const CarvedSurface& surface);

  [[nodiscard]] const ContactSurface& surface() const { return surface_; }
  /// Upper bound of node indices.
  [[nodiscard]] std::size_t nodeCapacity() const { return cut_.size(); }
  /// True if this vertex exists now.
  [[nodiscard]] bool exists(int node) const {
    const auto n = static_cast<std::size_t>(node);
    return n < cut_.size() && (mask_[n / 64] >> (n % 64) & 1U) != 0;
  }
  /// Positions of the vertices (m, W), by index, for these positions of the solid's nodes. Entries without a vertex are
  /// unchanged. Allocates on first use.
  void positions(std::span<const Vec3> solid, std::vector<Vec3>& out) const;
  /// A vertex in the reference configuration (m).
  [[nodiscard]] Vec3 rest(int node) const {
    const BrickLattice& lattice = model_.lattice();
    return lattice.position(Index3::Zero()) + lattice.cell() * cellsOf(static_cast<std::size_t>(node));
  }
  /// Nodes of the solid that a vertex depends on, and their weights.
  [[nodiscard]] MaterialPoint anchor(int node) const;
  /// A point of a triangle in terms of the solid's nodes: each corner's cube times the corner's weight, up to 24 nodes.
  /// The weights add up to one and reproduce the point for any deformation of the cubes, so that a force there keeps
  /// its resultant, moment and power.
  [[nodiscard]] SolidSolver::Impulse influence(const std::array<int, 3>& corner, const Vec3& weight) const;
  /// Number of reallocations by update().
  [[nodiscard]] std::size_t growths() const { return growths_; }

  // SurfaceTopology
  [[nodiscard]] std::size_t across(std::size_t triangle, int k) const override;
  std::size_t around(int node, std::span<std::uint32_t, maxAround> out) const override;

 private:
  [[nodiscard]] int nodeOf(std::uint32_t latticeEdge) const;
  [[nodiscard]] std::uint32_t latticeEdgeOf(int node) const;
  [[nodiscard]] std::uint32_t triangleOf(std::uint32_t name) const;
  [[nodiscard]] Vec3 cellsOf(std::size_t node) const;
  [[nodiscard]] std::uint64_t insideOfBlock(const Index3& block) const;
  void markRaised();
  void mark(const Index3& block);
  void measure(std::uint32_t rank);
  void writeBlock(const CarvedSurface& surface, std::uint32_t rank);
  void listPatches(const CarvedSurface& surface);
  void listNodes() const;

  const FatModel& model_;
  const CarvedField& field_;
  SurfaceAdjacency adjacency_;
  ContactSurface surface_;
  std::vector<Index3> origin_;         ///< first node of each ranked block
  std::vector<std::uint64_t> mask_;    ///< per rank and axis: which edges are cut
  std::vector<double> cut_;            ///< per node: share of the edge
  std::vector<std::int32_t> cube_;     ///< per node: its cube
  std::vector<std::uint16_t> count_;   ///< triangles of each ranked block
  std::vector<std::uint32_t> first_;   ///< its first patch
  std::vector<std::uint8_t> written_;  ///< rewritten since its corners were listed
  std::vector<std::uint8_t> dirty_;
  std::vector<std::uint32_t> dirtyRank_;
  // The lists being built.
  std::vector<ContactSurface::Patch> patch_;
  std::vector<std::size_t> cornerStart_;
  std::vector<int> corner_;
  std::size_t listed_ = 0;  ///< capacity after the last update
  // Scratch of positions().
  mutable std::vector<double> padded_;
  mutable std::vector<CubeMap> map_;
  mutable std::vector<double> placed_;
  mutable std::vector<SkinNode> skinNode_;  ///< all vertices, computed on demand
  mutable bool nodesListed_ = false;        ///< valid since the last stroke
  std::size_t growths_ = 0;
};

/// Motion of fat for carving.
/// Lattice nodes move with the trilinear maps of their cubes. Nodes of an empty cube next to a remaining one are
/// carved as part of the latter, one cell beyond it: they are outside and only determine where the surface lies
/// between them and the inside.
class CubeMotion final : public TissueMotion {
 public:
  /// @param model outlives this
  explicit CubeMotion(const FatModel& model);

  /// Chooses the boxes that a stroke can change.
  /// @param now, before positions of the solid's nodes at the end and the beginning of the stroke (m, W);
  /// both outlive the stroke
  /// @param fill per cube; 0: empty
  /// @param depth as for carve() (m)
  void choose(std::span<const SweptCapsule> tool, std::span<const Vec3> now, std::span<const Vec3> before,
              std::span<const double> fill, double depth);
  [[nodiscard]] std::span<const NodeBox> boxes() const { return box_; }

  void fillLanes(std::size_t box, const Index3& first, int count, NodeLanes& out) const override;

 private:
  /// Distance between the bounds of tool and cube beyond which the cube is not affected (m).
  struct Reach {
    double depth = 0.0;  ///< of the carving, in W
    double beyond[3]{};  ///< greatest length of a cell along each axis
  };
  [[nodiscard]] Reach reachOf(const Index8& corner, double depth) const;
  void add(int cube, const Box& tool, const Reach& reach, std::span<const double> fill);

  const FatModel& model_;
  std::span<const Vec3> now_;
  std::span<const Vec3> before_;
  std::vector<NodeBox> box_;
  std::vector<std::int32_t> cube_;  ///< of each box
};

// Remaining volume of fat in the reference configuration: in total and by regions.

/// Each lattice node represents a cell's volume, of which the share clamp(1/2 - phi / cell, 0, 1) is inside: exact for
/// surfaces parallel to the axes, second-order accurate elsewhere. Shares are multiples of 2^-20 of a cell, so that
/// sums are exact and incremental updates equal a full pass. Derived from the field; never saved.
class FatVolume {
 public:
  explicit FatVolume(const FatModel& model);

  void rebuild(const CarvedField& field);
  /// Updates what the last stroke changed. Allocates nothing.
  void update(const CarvedField& field);

  /// m^3
  [[nodiscard]] double total() const { return unit_ * static_cast<double>(total_); }
  [[nodiscard]] double inRegion(std::size_t region) const { return unit_ * static_cast<double>(region_[region]); }

 private:
  void mark(std::uint32_t brick);
  void measure(const CarvedField& field, std::uint32_t brick);
  [[nodiscard]] BrickBits countedNodes(const CarvedField& field, std::uint32_t brick) const;

  const FatModel& model_;
  double unit_;                      ///< m^3
  std::vector<std::int64_t> brick_;  ///< (1 + regions) sums for each brick: all, then each region
  std::vector<std::uint8_t> marked_;
  std::vector<std::uint32_t> work_;
  std::int64_t total_ = 0;
  std::vector<std::int64_t> region_;
};

/// Outcome of a stroke, or of a string that tore.
struct FatStroke {
  bool changed = false;       ///< the field changed: the `carved` part of State must be rehashed
  double removed = 0.0;       ///< volume, islands included (m^3)
  double islands = 0.0;       ///< volume of islands, to the accuracy of a cell (m^3)
  std::uint32_t nodes = 0;    ///< lattice nodes removed
  Vec3 where = Vec3::Zero();  ///< their mean position (m, W); undefined without any
};

/// One per State that is stepped. Nothing in it is part of State: after a restore, rebuild() recomputes everything, and
/// two bodies then evolve identically, bit for bit, whatever their history.
///
/// A step: beginStep(); the caller moves the solid (SolidSolver with fill() and attachments made of ties()); stroke()
/// if an energised hook is near; the caller updates the contact surface's positions.
class FatBody {
 public:
  /// @param model outlives this. The uncarved body.
  explicit FatBody(const FatModel& model);
  FatBody(const FatBody&) = delete;
  FatBody& operator=(const FatBody&) = delete;

  /// @return false if the state is not valid for the model (fits()): the body is then uncarved
  [[nodiscard]] bool rebuild(const FatState& state);

  /// Stores the tissue's positions, relative to which strokes of this step are swept.
  void beginStep(const FatState& state);
  /// Removes what the tool's capsules sweep over between the step's beginning and end, and islands. Nodes of the solid
  /// that belong only to empty cubes are stopped. @pre beginStep() of this step
  /// @param rise by which the surface can recede in this step (m), as for carve()
  FatStroke stroke(FatState& state, std::span<const SweptCapsule> tool,
                   double rise = std::numeric_limits<double>::infinity());
  /// Parts a string of fat that is pulled too far (sim/fat/fat_strings.cpp), at most one: the cube that is stretched
  /// most, of those that are stretched too far for their section across the pull, loses all of its fat, and with it
  /// what binds its neighbours. A function of the State alone. Allocates nothing. @pre the body is that of the State
  FatStroke tear(FatState& state);

  /// True if connected fat joins thing 0 with thing 1, through its ties and, from one part of it to another, through
  /// further things. Costs a search of the graph of bricks.
  /// @param thing per tie (FatModel::allTies()): number of what it hangs on @param things how many there are, at least
  /// 2
  [[nodiscard]] bool joins(std::span<const std::uint32_t> thing, std::uint32_t things);

  [[nodiscard]] const FatModel& model() const { return model_; }
  /// Remaining share of each cube, for SolidSolver and SolidModel::volume().
  [[nodiscard]] std::span<const double> fill() const { return fill_; }
  /// Remaining share of a tie (FatModel::allTies()): the share of its nodes that are still inside.
  [[nodiscard]] double tieShare(std::size_t tie) const { return tieShare_[tie]; }
  /// Correction of a node's compliance relative to the reference configuration (RestCompliance): the rotation of
  /// its cubes, times a factor above one where fat around it is gone. Compliance between a and b is
  /// approximately rotation(a) C_ab rotation(b)^T.
  [[nodiscard]] Mat3 rotation(const FatState& state, int node) const;

  /// The contact surface; CarvedContact::positions() maps it.
  [[nodiscard]] const CarvedContact& contact() const { return contact_; }
  [[nodiscard]] const CarvedSurface& surface() const { return surface_; }
  [[nodiscard]] const CarvedField& field() const { return field_; }
  [[nodiscard]] const FatVolume& volume() const { return volume_; }

  /// Number of reallocations in strokes; constant in steady state.
  [[nodiscard]] std::size_t growths() const { return surface_.growths() + contact_.growths(); }

 private:
  void rebuildAll();
  FatStroke finish(FatState& state);
  [[nodiscard]] int overstretched(const FatState& state) const;
  [[nodiscard]] double section(int cube, int axis) const;
  void updateFill(std::span<const std::uint32_t> hexahedra);
  void measureTies(int cube);
  [[nodiscard]] Vec3 meanPosition(const FatState& state, std::uint32_t& nodes) const;

  const FatModel& model_;
  CarvedField field_;
  Islands islands_;
  CarvedSurface surface_;
  CarvedContact contact_;
  Fill coarse_;
  FatVolume volume_;
  CubeMotion motion_;
  std::vector<Vec3> before_;
  std::vector<double> fill_;
  std::vector<double> tieShare_;
  std::vector<std::size_t> tieStart_;  ///< per cube: start of its ties in tieOfCube_
  std::vector<std::size_t> tieOfCube_;
};

}  // namespace calot
