// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/connective/connective_tissue.h"
#include "sim/contact/surface_patches.h"
#include "sim/contact/surface_surface.h"
#include "sim/fat/fat_model.h"
#include "sim/geometry/embedding.h"
#include "sim/geometry/mesh_to_count.h"
#include "sim/scene/description.h"
#include "sim/scene/digests.h"
#include "sim/scene/structure_limit.h"
#include "sim/solid/solid.h"
#include "sim/vessel/beam_model.h"
#include "sim/vessel/tube_surface.h"

namespace calot {

/// One organ's fixed data.
struct OrganModel {
  std::string name;
  std::string appearance;
  SolidModel solid;
  std::vector<Vec3> skin;          ///< vertices of the organ's surface at rest (m), carried by the solid:
  Embedding embedding;             ///< contact and pictures see the fine surface, mechanics the tetrahedra
  ContactSurface surface;          ///< triangles over the skin's vertices
  std::vector<double> vertexArea;  ///< a third of the triangles around each vertex, at rest (m^2)
  double cellSize = 0.0;           ///< of the tetrahedral lattice (m)
};

/// Vessels that grow out of one another, solved together: branch b is the scene's vessel vessel[b].
struct VesselTree {
  std::string name;  ///< of its first vessel
  BeamModel beams;
  std::vector<std::size_t> vessel;
};

/// Skins of vessels as contact and pictures have them.
inline constexpr TubeSurface::Settings tubeSettings{8, 1};

enum class StructureKind : std::uint8_t { organ, vessel, fat };

/// What has a name and a skin, and can be touched: organs, then vessels, then fat, in the scene's order. Contacts,
/// events and StepResult name structures by their place in this list; it has at most maxStructures.
struct StructureModel {
  std::string name;
  std::string appearance;
  StructureRole role = StructureRole::other;
  StructureKind kind = StructureKind::organ;
  std::size_t index = 0;   ///< among organs, vessel trees, or bodies of fat
  std::size_t branch = 0;  ///< of a vessel: in its tree
  std::size_t body = 0;    ///< what it is solved with: organs, then vessel trees, then fat
  double friction = 0.0;   ///< Coulomb coefficient of an instrument on it
};

/// A spring and a damper between places of two bodies that lie on each other at rest.
struct Tie {
  static constexpr std::size_t none = ~std::size_t{0};

  std::array<std::size_t, 2> body{};
  std::array<SolidPlace, 2> place;
  Vec3 offset = Vec3::Zero();  ///< of the first place from its node, in the node's frame; of vessels only (m)
  std::size_t fat = none;      ///< body of fat with which it fades, as
  std::size_t fatTie = 0;      ///< its tie of that number
  double stiffness = 0.0;      ///< N/m
  double damping = 0.0;        ///< N s/m
};

/// A scene's procedure, by numbers.
struct ProcedureModel {
  static constexpr std::size_t none = ~std::size_t{0};

  /// A vessel to be divided.
  struct Divide {
    std::size_t structure = 0;
    std::size_t coverRegion = none;  ///< FatModel's region close around it
  };
  bool present = false;
  std::size_t specimen = 0;               ///< organ
  std::size_t bed = none;                 ///< connective tissue
  std::size_t fat = none;                 ///< body of fat
  std::size_t clearRegion = none;         ///< FatModel's region that is to be cleared
  std::vector<Divide> divide;             ///< as the scene lists them
  std::vector<std::size_t> spare;         ///< structures
  std::vector<std::uint32_t> lowerThird;  ///< strands of the bed, ascending
};

/// Nodes that an assistant pulls.
struct RetractionModel {
  std::size_t organ = 0;
  std::vector<int> node;
};

/// Two organs that may touch each other, or one that may touch itself: vertices of `a` against triangles of `b`.
struct TissuePair {
  std::size_t a = 0;
  std::size_t b = 0;
  /// Of two organs. Of an organ with itself it is worked out by who meets it folded: most never are.
  std::optional<SurfacePair> rest;
};

/// Connective tissue between organs `a` and `b`.
struct ConnectiveModel {
  std::string name;
  std::size_t a = 0;
  std::size_t b = 0;
  ConnectiveTissue tissue;
};

/// Everything that is built from the scene and never changes afterwards: a pure function of the description.
class Model {
 public:
  /// A Model, or one sentence that says what is wrong with the description.
  struct Built {
    std::unique_ptr<const Model> model;
    std::string error;
  };
  static Built build(SceneDescription scene);

  [[nodiscard]] const SceneDescription& scene() const { return scene_; }
  [[nodiscard]] const std::vector<OrganModel>& organs() const { return organs_; }
  /// Every ordered pair of organs, then each organ with itself.
  [[nodiscard]] const std::vector<TissuePair>& tissuePairs() const { return tissuePairs_; }
  [[nodiscard]] const std::vector<ConnectiveModel>& connective() const { return connective_; }
  [[nodiscard]] const std::vector<VesselTree>& vesselTrees() const { return vesselTree_; }
  [[nodiscard]] const std::vector<StructureModel>& structures() const { return structure_; }
  [[nodiscard]] const std::vector<Tie>& ties() const { return tie_; }
  [[nodiscard]] const ProcedureModel& procedure() const { return procedure_; }
  /// In the scene's order.
  [[nodiscard]] const std::vector<RetractionModel>& retractions() const { return retraction_; }
  [[nodiscard]] const std::vector<std::unique_ptr<const FatModel>>& fat() const { return fat_; }
  /// Organs, then vessel trees, then fat.
  [[nodiscard]] std::size_t bodies() const { return organs_.size() + vesselTree_.size() + fat_.size(); }
  /// Index of the structure of this name, or structures().size().
  [[nodiscard]] std::size_t structureNamed(const std::string& name) const;
  [[nodiscard]] const DigestLayout& layout() const { return layout_; }
  [[nodiscard]] double stepSeconds() const { return tickLength * scene_.ticksPerStep; }

 private:
  Model() = default;
  std::string addVessels(const SceneDescription& scene);
  std::string addProcedure(const SceneDescription& scene);
  std::string addRetractions(const SceneDescription& scene);
  std::string addFat(const SceneDescription& scene, const FatDescription& description);
  [[nodiscard]] std::vector<SolidPlace> placesOnOrgan(std::size_t organ, const std::vector<Vec3>& points) const;
  void listStructures(const SceneDescription& scene);
  std::string addConnective(const SceneDescription& scene, const ConnectiveDescription& description);
  SceneDescription scene_;
  std::vector<OrganModel> organs_;
  std::vector<TissuePair> tissuePairs_;
  std::vector<ConnectiveModel> connective_;
  std::vector<VesselTree> vesselTree_;
  std::vector<std::unique_ptr<const FatModel>> fat_;
  std::vector<StructureModel> structure_;
  std::vector<Tie> tie_;
  ProcedureModel procedure_;
  std::vector<RetractionModel> retraction_;
  DigestLayout layout_;
};

}  // namespace calot
