// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/connective/connective_tissue.h"
#include "sim/contact/surface_patches.h"
#include "sim/contact/surface_surface.h"
#include "sim/geometry/embedding.h"
#include "sim/geometry/mesh_to_count.h"
#include "sim/scene/description.h"
#include "sim/scene/digests.h"
#include "sim/solid/solid.h"

namespace calot {

/// One organ's fixed data.
struct OrganModel {
  std::string name;
  std::string appearance;
  SolidModel solid;
  std::vector<Vec3> skin;  ///< vertices of the organ's surface at rest (m), carried by the solid:
  Embedding embedding;     ///< contact and pictures see the fine surface, mechanics the tetrahedra
  ContactSurface surface;  ///< triangles over the skin's vertices
  double cellSize = 0.0;   ///< of the tetrahedral lattice (m)
  StuffingReport meshing;
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
  [[nodiscard]] const DigestLayout& layout() const { return layout_; }
  [[nodiscard]] double stepSeconds() const { return tickLength * scene_.ticksPerStep; }

 private:
  Model() = default;
  std::string addConnective(const SceneDescription& scene, const ConnectiveDescription& description);
  SceneDescription scene_;
  std::vector<OrganModel> organs_;
  std::vector<TissuePair> tissuePairs_;
  std::vector<ConnectiveModel> connective_;
  DigestLayout layout_;
};

}  // namespace calot
