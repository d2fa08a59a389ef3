// SPDX-License-Identifier: GPL-3.0-or-later
// Constant data of a body of fat: a potential field in the reference configuration, coarse cubes and attachments.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sim/carving/carved_field.h"
#include "sim/carving/carved_surface.h"
#include "sim/geometry/triangle_mesh.h"
#include "sim/solid/solid.h"

namespace calot {

// State of a body of fat.

/// Two parts of State with separate fields: motion changes in every step in which the fat is awake, the field only when
/// something is carved. Everything else is derived from them (FatBody::rebuild()).
struct FatState {
  SolidState solid;
  CarvedBricks carved;
};

/// A body that fat is attached to: all fat within `reach` of it.
struct FatPartner {
  std::string name;
  std::function<double(const Vec3&)> distance;  ///< of a point from its surface at rest, negative inside (m)
  double reach = 0.002;                         ///< m
  double stiffness = 2e6;                       ///< per unit volume of attached fat (N/m^4)
  double damping = 2e4;                         ///< (N s/m^4)
};

/// A region of the reference configuration in which remaining fat is measured separately.
struct FatRegion {
  std::string name;
  std::function<bool(const Vec3&)> contains;  ///< called once per lattice node
};

struct FatSettings {
  double cell = 0.00075;  ///< of the potential field (m)
  int cellsPerCube = 3;   ///< edge of a mechanical cube (cells)
  SolidModel::Material material;
};

/// A spring and a damper from the fat in one cube to a partner.
struct FatTie {
  int cube = 0;
  MaterialPoint point;                      ///< centroid of the nodes that it represents
  Vec3 rest = Vec3::Zero();                 ///< point.of(reference positions), bit for bit: no force at rest
  double stiffness = 0.0;                   ///< with all of its nodes inside (N/m)
  double damping = 0.0;                     ///< N s/m
  std::size_t firstNode = 0, lastNode = 0;  ///< lattice nodes [first, last) of FatModel::tieNodes()
};

/// Lattice and cubes share their axes: cube h spans k^3 cells, a lattice node belongs to one cube (Fill). The solid
/// consists of the cubes to which nodes inside the fat belong, ascending; their corners are its nodes.
///
/// A point of the fat moves with the trilinear map of its cube. A point of the surface moves with the cube to
/// which the *inside* end of its lattice edge belongs, at most one cell beyond that cube: remaining fat never
/// depends on an empty cube.
class FatModel {
 public:
  /// @param surface closed, outward (m, W)
  /// @return null and one line of reason (without the fat's name) if there is no such fat
  static std::unique_ptr<FatModel> make(const TriangleMesh& surface, const FatSettings& settings,
                                        std::span<const FatPartner> partners, std::span<const FatRegion> regions,
                                        std::string& error);

  static constexpr double bandCells = 3.0;  ///< of the field

  /// Without parts that were unattached from the beginning.
  [[nodiscard]] const FieldModel& field() const { return field_; }
  [[nodiscard]] const BrickLattice& lattice() const { return field_.lattice; }
  [[nodiscard]] const SolidModel& solid() const { return *solid_; }
  /// SolidModel::preload()
  void preload(std::span<const Vec3> displacement) { solid_->preload(displacement); }
  [[nodiscard]] int cellsPerCube() const { return k_; }
  /// Inside nodes of a full cube.
  [[nodiscard]] int fullCount() const { return k_ * k_ * k_; }
  /// Fill of each cube before carving.
  [[nodiscard]] const std::vector<double>& restFill() const { return restFill_; }
  /// Lattice nodes attached to any partner, ascending.
  [[nodiscard]] const std::vector<std::uint32_t>& anchors() const { return anchor_; }

  [[nodiscard]] std::size_t partners() const { return tieStart_.size() - 1; }
  /// Ties of a partner, by cubes.
  [[nodiscard]] std::span<const FatTie> ties(std::size_t partner) const {
    return std::span(tie_).subspan(tieStart_[partner], tieStart_[partner + 1] - tieStart_[partner]);
  }
  /// Number of a partner's first tie among allTies().
  [[nodiscard]] std::size_t firstTie(std::size_t partner) const { return tieStart_[partner]; }
  [[nodiscard]] const std::vector<FatTie>& allTies() const { return tie_; }
  [[nodiscard]] const std::vector<std::uint32_t>& tieNodes() const { return tieNode_; }
  /// All springs in the reference configuration, for its compliance: force 0, damper h K + C. @param step h (s)
  [[nodiscard]] std::vector<Attachment> restAttachments(double step) const;

  [[nodiscard]] std::size_t regions() const { return region_.size(); }
  [[nodiscard]] const std::string& regionName(std::size_t region) const { return regionName_[region]; }
  /// Its lattice nodes, per brick.
  [[nodiscard]] const std::vector<BrickBits>& region(std::size_t region) const { return region_[region]; }

  /// Cube of a coarse hexahedron (Fill::hexahedron()), -1 if there is none.
  [[nodiscard]] int cubeOfHexahedron(std::uint32_t hexahedron) const { return cubeOf_[hexahedron]; }
  [[nodiscard]] int cubeAt(const Index3& h) const;
  /// Cube that a lattice node belongs to; -1: none.
  [[nodiscard]] int cubeOfNode(const Index3& node) const {
    return cubeAt((node.array() / k_).min(hexahedra_.array() - 1));
  }
  /// Position of a cube among the coarse hexahedra.
  [[nodiscard]] const Index3& hexahedronOfCube(int cube) const { return hexahedron_[slot(cube)]; }
  /// Coarse hexahedra along each axis.
  [[nodiscard]] const Index3& hexahedra() const { return hexahedra_; }
  /// Cubes at a node of the solid, ascending.
  [[nodiscard]] std::span<const std::int32_t> cubesAt(int node) const {
    return std::span(cubeAtNode_).subspan(cubeStart_[slot(node)], cubeStart_[slot(node) + 1] - cubeStart_[slot(node)]);
  }

  /// Weights of a cube's corners at a point given in cells from the lattice's origin.
  [[nodiscard]] std::array<double, 8> shares(int cube, const Vec3& cells) const;

  /// Blocks of 4^3 cells (SurfacePatch) that the surface can ever reach have a rank, ascending with their index.
  [[nodiscard]] std::int32_t rankOfBlock(std::uint32_t block) const { return rank_[block]; }
  [[nodiscard]] const std::vector<std::uint32_t>& blocks() const { return block_; }

 private:
  FatModel() = default;
  std::string cast(const TriangleMesh& surface, double cell);
  void attach(std::span<const FatPartner> partners);
  void removeLoose();
  std::string divide(const SolidModel::Material& material);
  void tie(std::span<const FatPartner> partners);
  void rankBlocks();

  FieldModel field_;
  std::unique_ptr<SolidModel> solid_;
  int k_ = 1;
  Index3 hexahedra_ = Index3::Zero();
  std::vector<std::int32_t> cubeOf_;
  std::vector<Index3> hexahedron_;
  std::vector<std::size_t> cubeStart_;
  std::vector<std::int32_t> cubeAtNode_;
  std::vector<double> restFill_;
  std::vector<std::vector<std::uint32_t>> partnerNodes_;  ///< per partner: lattice nodes, ascending
  std::vector<std::uint32_t> anchor_;
  std::vector<std::size_t> tieStart_;
  std::vector<FatTie> tie_;
  std::vector<std::uint32_t> tieNode_;
  std::vector<std::string> regionName_;
  std::vector<std::vector<BrickBits>> region_;
  std::vector<std::int32_t> rank_;
  std::vector<std::uint32_t> block_;
};

/// Uncarved, at rest, asleep.
[[nodiscard]] FatState restState(const FatModel& model);

/// True if this is a valid state of the model (sizes, finite numbers, bricks that fit the field). For external data.
[[nodiscard]] bool fits(const FatModel& model, const FatState& state);

/// The adaptive surface of a body of fat over successive States. If a State is more carved than the previous one, only
/// the affected parts are polygonized again, otherwise all. Vertices and triangles depend on the State alone.
class FatPicture {
 public:
  /// @param model outlives this. The uncarved body.
  explicit FatPicture(const FatModel& model);

  /// Updates to a State's carving; an invalid State counts as uncarved.
  /// @return true if vertices or triangles changed
  bool update(const CarvedBricks& carved);

  [[nodiscard]] const std::vector<Vec3>& rest() const { return mesh_.vertex; }  ///< m
  [[nodiscard]] const std::vector<Index3>& triangles() const { return mesh_.triangle; }
  /// Positions of the vertices (m, W). @param solid positions of the solid's nodes
  void positions(const std::vector<Vec3>& solid, std::vector<Vec3>& out) const;

 private:
  /// The cube that a vertex moves with: the one that contains it, or the nearest remaining one.
  struct Carrier {
    std::array<int, 8> node{};
    std::array<double, 8> share{};
  };

  [[nodiscard]] bool there(int cube) const;
  [[nodiscard]] int cubeNear(const Vec3& rest) const;
  void weld();

  const FatModel& model_;
  CarvedField field_;
  Fill fill_;
  AdaptiveSurface surface_;
  TriangleMesh mesh_;
  std::vector<Carrier> carrier_;  ///< per vertex
};

}  // namespace calot
