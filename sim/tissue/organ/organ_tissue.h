// SPDX-License-Identifier: GPL-3.0-or-later
// Organs: closed surfaces filled with co-rotational tetrahedra, whose fine skin contact and pictures see.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/contact/surface_patches.h"
#include "sim/contact/surface_surface.h"
#include "sim/geometry/isosurface_stuffing.h"
#include "sim/math/record.h"
#include "sim/solid/solid.h"
#include "sim/tissue/structure.h"

namespace calot {

/// Region of an organ whose nodes are held at their rest position: all nodes inside the sphere, or (when `nearOrgan` is
/// not empty) all nodes within `distance` of that organ's rest surface.
struct AnchorDescription {
  Vec3 centre = Vec3::Zero();  ///< m
  double radius = 0.0;         ///< m
  std::string nearOrgan;
  double distance = 0.0;  ///< m

  static std::vector<Field> fields();
};

struct OrganDescription {
  std::string name;
  std::string appearance;
  StructureRole role = StructureRole::other;
  SurfaceDescription surface;
  std::uint32_t tetrahedra = 0;  ///< requested number
  MaterialDescription material;
  double friction = 0.1;     ///< Coulomb coefficient of an instrument on this organ
  double burnThrough = 0.0;  ///< cautery at one spot that perforates its wall (s); 0: it has none
  std::vector<AnchorDescription> anchors;

  static std::vector<Field> fields();
};

/// One organ's fixed data.
struct OrganModel {
  std::string name;
  std::string appearance;
  SolidModel solid;
  std::vector<Vec3> skin;              ///< vertices of the organ's surface at rest (m), carried by the solid:
  Embedding embedding;                 ///< contact and pictures see the fine surface, mechanics the tetrahedra
  ContactSurface surface;              ///< triangles over the skin's vertices
  std::vector<double> triangleArea;    ///< at rest (m^2)
  std::vector<std::uint8_t> division;  ///< of each triangle's sides, for CharState (sim/geometry/triangle_mesh.h)
  double cellSize = 0.0;               ///< of the tetrahedral lattice (m)
};

/// Two organs that may touch each other, or one that may touch itself: vertices of `a` against triangles of `b`.
struct TissuePair {
  std::size_t a = 0;
  std::size_t b = 0;
  /// Two organs in the reference configuration. For an organ with itself, computed when it first folds: most never do.
  std::optional<SurfacePair> rest;
};

/// Burns of an organ's skin by cautery, by cells of its triangles (OrganModel::division). Irreversible.
struct CharState {
  std::vector<std::uint32_t> triangle;   ///< burned anywhere, in the order in which they were first touched
  std::vector<std::uint32_t> firstCell;  ///< of each of them, in the lists below
  std::vector<float> charring;           ///< per cell: coagulation (s)
  std::vector<float> exposure;           ///< per cell: cautery of the wall (s)
  double area = 0.0;                     ///< charred (m^2)
  double maxExposure = 0.0;              ///< over all cells (s)
  bool perforated = false;               ///< burned or torn open

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("triangle", self.triangle);
    visit("firstCell", self.firstCell);
    visit("charring", self.charring);
    visit("exposure", self.exposure);
    visit("area", self.area);
    visit("maxExposure", self.maxExposure);
    visit("perforated", self.perforated);
  }
};

/// One organ at the end of a step.
struct OrganResult {
  double volume = 0.0;
  double maxDisplacement = 0.0;
  double maxSpeed = 0.0;
  double residual = 0.0;
  std::uint32_t iterations = 0;
  bool asleep = false;
  double charredArea = 0.0;
  double wallExposure = 0.0;

  template <class Visit>
  static void fields(Visit&& visit) {
    visit(ResultField{"volume", "m^3", "", 1, "of the deformed tetrahedra"}, &OrganResult::volume);
    visit(ResultField{"largest_displacement", "m", "", 1, "over its nodes, from the reference configuration"},
          &OrganResult::maxDisplacement);
    visit(ResultField{"largest_speed", "m/s", "", 1, "over its nodes"}, &OrganResult::maxSpeed);
    visit(ResultField{"residual", "1", "", 1, "relative residual of the linear solve; 0 asleep"},
          &OrganResult::residual);
    visit(ResultField{"iterations", "", "", 1, "of the linear solve; 0 asleep"}, &OrganResult::iterations);
    visit(ResultField{"asleep", "", "", 1, "1: untouched and idle, not solved in this step"}, &OrganResult::asleep);
    visit(ResultField{"charred_area", "m^2", "", 3, "of the organ's skin in the reference configuration"},
          &OrganResult::charredArea);
    visit(ResultField{"wall_exposure", "s", "", 4, "most cautery of any place of its skin, as time at full power"},
          &OrganResult::wallExposure);
  }
};

/// Organs as a kind of tissue; sim/tissue/tissues.h documents the members.
struct OrganTissue {
  using Result = OrganResult;
  static constexpr const char* componentPrefix = "organ.";
  static constexpr bool hasStructures = true;
  static constexpr ResultGroup results{"/observables/organs", 1,
                                       "one column an organ, in the order of `/scene/organs`"};

  struct Descriptions {
    std::vector<OrganDescription> organs;
  };
  static Field sceneKey();
  struct Models {
    std::vector<OrganModel> organModel;
    std::vector<TissuePair> tissuePair;

    [[nodiscard]] const std::vector<OrganModel>& organs() const { return organModel; }
    /// Every ordered pair of organs, then each organ with itself.
    [[nodiscard]] const std::vector<TissuePair>& tissuePairs() const { return tissuePair; }
  };
  struct States {
    std::vector<SolidState> organ;
    std::vector<CharState> charred;  ///< per organ
  };
  struct Results {
    std::vector<OrganResult> organ;
  };
  struct Names {
    std::vector<std::string> organs;
  };

  template <class Self, class Visit>
  static void components(Self& self, Visit&& visit) {
    for (std::size_t o = 0; o < self.organ.size(); ++o) visit("organ.", o, self.organ[o]);
    for (std::size_t o = 0; o < self.charred.size(); ++o) visit("charred.", o, self.charred[o]);
  }
  static auto& resultsOf(auto& results) { return results.organ; }
  static auto& namesOf(auto& names) { return names.organs; }

  static std::string build(const SceneDescription& scene, Model& model);
  static void listStructures(const Model& model, TissueId kind, std::size_t firstBody,
                             std::vector<StructureModel>& structures);
  static std::size_t bodies(const Models& models) { return models.organs().size(); }
  static const std::string& nameOf(const Model& model, std::size_t index);
  static void start(const Model& model, States& states);
  static bool fits(const Model& model, const States& states);
  static void resize(const Model& model, Results& results);
  static std::unique_ptr<TissueViewer> makeViewer(const Model& model);
};

/// Material points of an organ's solid, with their elements, that lie at points of the reference configuration (m).
std::vector<MaterialPoint> pointsOnOrgan(const OrganModel& organ, const std::vector<Vec3>& points);

}  // namespace calot
