// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sim/scene/description.h"
#include "sim/tissue/structure.h"
#include "sim/tissue/tissues.h"

namespace calot {

/// Names of what is digested, fixed by the Model: components in order, and their fields in order.
struct DigestLayout {
  struct Field {
    std::uint32_t component = 0;
    std::string name;  ///< "organ.liver/position"
  };
  std::vector<std::string> components;  ///< "clock", "camera", "hand.left.input", "organ.liver", ...
  std::vector<Field> fields;
};

/// Digests of one State: XXH3-64 of each component's field bytes, and the low 32 bits of each field's own XXH3-64.
struct StateDigest {
  std::vector<std::uint64_t> component;
  std::vector<std::uint32_t> field;
  bool operator==(const StateDigest&) const = default;
};

/// Fat close around a vessel that the scene's procedure divides.
struct VesselCover {
  std::size_t vessel = 0;  ///< of the scene's
  std::size_t fat = 0;     ///< body of fat, and
  std::size_t region = 0;  ///< its region (FatModel::region())
};

/// Nodes that an assistant pulls.
struct RetractionModel {
  std::size_t organ = 0;
  std::vector<int> node;
};

/// Everything that is built from the scene and never changes afterwards: a pure function of the description.
class Model : public Tissues::Models {
 public:
  /// A Model, or one sentence that says what is wrong with the description.
  struct Built {
    std::unique_ptr<const Model> model;
    std::string error;
  };
  static Built build(SceneDescription scene);

  [[nodiscard]] const SceneDescription& scene() const { return scene_; }
  [[nodiscard]] const std::vector<StructureModel>& structures() const { return structure_; }
  [[nodiscard]] const std::vector<Tie>& ties() const { return tie_; }
  [[nodiscard]] const std::vector<VesselCover>& covers() const { return cover_; }
  /// In the scene's order.
  [[nodiscard]] const std::vector<RetractionModel>& retractions() const { return retraction_; }
  /// Linear systems: organs, then vessel trees, then fat.
  [[nodiscard]] std::size_t bodies() const;
  /// True if a body is in equilibrium in the reference configuration. An unsupported body with weight is not.
  [[nodiscard]] bool holds(std::size_t body) const { return held_[body]; }
  /// Index of the structure of this name, or structures().size().
  [[nodiscard]] std::size_t structureNamed(const std::string& name) const;
  [[nodiscard]] const DigestLayout& layout() const { return layout_; }
  [[nodiscard]] double stepSeconds() const { return tickLength * scene_.ticksPerStep; }

  /// While it is built (kinds of tissue, in their build()): a spring between two bodies.
  void addTie(Tie tie) { tie_.push_back(std::move(tie)); }

 private:
  Model() = default;
  std::string addProcedure(const SceneDescription& scene);
  std::string addRetractions(const SceneDescription& scene);
  void carryWeight();

  SceneDescription scene_;
  std::vector<StructureModel> structure_;
  std::vector<Tie> tie_;
  std::vector<VesselCover> cover_;
  std::vector<RetractionModel> retraction_;
  std::vector<bool> held_;  ///< per body
  DigestLayout layout_;
};

}  // namespace calot
