// SPDX-License-Identifier: GPL-3.0-or-later
// Contributions of all kinds of tissue to a Model: structures that can be touched, ties between bodies, and fields
// that several parts of a scene have.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

#include "sim/geometry/triangle_mesh.h"
#include "sim/math/fields.h"
#include "sim/math/linear.h"
#include "sim/math/record.h"
#include "sim/solid/solid.h"
#include "sim/tissue/structure_role.h"

namespace calot {

/// Position of a kind of tissue in the list of kinds (sim/tissue/tissues.h).
using TissueId = std::uint8_t;

/// A body with a name and a skin that can be touched: organs, then vessels, then fat, in the scene's order. Contacts,
/// events and StepResult refer to structures by their index in this list; it has at most maxStructures.
struct StructureModel {
  std::string name;
  std::string appearance;
  StructureRole role = StructureRole::other;
  TissueId kind = 0;
  std::size_t index = 0;   ///< among organs, vessel trees, or bodies of fat
  std::size_t branch = 0;  ///< of a vessel: in its tree
  std::size_t body = 0;    ///< what it is solved with: organs, then vessel trees, then fat
  double friction = 0.0;   ///< Coulomb coefficient of an instrument on it
  /// Solid that gives way in dimples where an instrument presses (docs/explanation/contact-forces.md); null: none does.
  const SolidModel* soft = nullptr;
  double nodeSpread = 0.0;  ///< size of the patch over which a node of `soft` spreads a force (m)
};

/// A spring and a damper between material points of two bodies that coincide in the reference configuration, or lie as
/// far apart there as the spring has to stretch for the weight that it carries.
struct Tie {
  static constexpr std::size_t none = ~std::size_t{0};

  std::array<std::size_t, 2> body{};
  std::array<MaterialPoint, 2> place;
  Vec3 offset = Vec3::Zero();  ///< of the spring's end from the first point, in the frame of what that belongs to: a
                               ///< vessel's node or an organ's element (m)
  std::size_t fat = none;      ///< body of fat with which it fades, as
  std::size_t fatTie = 0;      ///< its tie of that number
  double stiffness = 0.0;      ///< N/m
  double damping = 0.0;        ///< N s/m
};

/// Index of the first of this name, or list.size().
template <class Named>
std::size_t indexNamed(const std::vector<Named>& list, const std::string& name) {
  std::size_t i = 0;
  while (i < list.size() && list[i].name != name) ++i;
  return i;
}

// Common parts of the descriptions of several kinds of tissue.

/// Closed triangle surface of an organ in W, in the reference configuration (m).
struct SurfaceDescription {
  std::vector<Vec3> vertex;
  std::vector<Index3> triangle;  ///< outward

  [[nodiscard]] TriangleMesh mesh() const { return {vertex, triangle}; }

  static std::vector<Field> fields();
};

/// Isotropic material of a co-rotational solid.
struct MaterialDescription {
  double youngModulus = 5000.0;    ///< Pa
  double poissonRatio = 0.45;      ///< in [0, 0.5)
  double density = 1060.0;         ///< kg/m^3
  double massDamping = 0.0;        ///< Rayleigh alpha (1/s)
  double stiffnessDamping = 0.01;  ///< Rayleigh beta (s)

  static std::vector<Field> fields();
};

inline SolidModel::Material solidMaterial(const MaterialDescription& m) {
  return {lameConstants(m.youngModulus, m.poissonRatio), m.density, m.massDamping, m.stiffnessDamping};
}

class Model;
struct SceneDescription;
struct SceneView;
struct State;

/// Adds what pictures show of one kind of tissue to scene views, and keeps from view to view what stays the same.
class TissueViewer {
 public:
  virtual ~TissueViewer() = default;
  /// @pre the state is one of the model's
  virtual void addTo(SceneView& view, const State& state) = 0;
};

/// A name that goes into columns and file names.
inline constexpr TextRule sceneName{64, "^[a-z0-9][a-z0-9-]*$",
                                    "small letters, digits and hyphens are allowed, the first no hyphen"};

/// A coordinate (m): a scene is a part of one abdomen, so nothing lies farther from the origin.
inline constexpr Range sceneCoordinate = within(-1, 1);

/// The key "role" of a tissue, which has one of these roles, or `other`.
Field roleField(const Access& access, std::initializer_list<StructureRole> roles);

}  // namespace calot
