// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/tissue/structure.h"

#include <utility>

namespace calot {

Field roleField(const Access& access, std::initializer_list<StructureRole> roles) {
  FieldWords words{{nameOf(StructureRole::other), 0}};
  for (const StructureRole role : roles) words.emplace_back(nameOf(role), static_cast<std::uint32_t>(role));
  return optional(
      "role", access, std::move(words),
      "Role in the anatomy, by which judgement and performers identify it; a scene that states no role gets roles "
      "from what it contains (docs/reference/scenes.md)");
}

// Files name a surface by its own file; these are the values of a scene that has read it.
std::vector<Field> SurfaceDescription::fields() {
  using S = SurfaceDescription;
  return {object("mesh", ""), Field(at<S, &S::vertex>), Field(at<S, &S::triangle>)};
}

std::vector<Field> MaterialDescription::fields() {
  using S = MaterialDescription;
  return {
      object("material", "Isotropic, co-rotational linear elasticity; sources in docs/reference/materials.md"),
      {"youngModulus", at<S, &S::youngModulus>, "Pa", within(10, 1e9), "Young's modulus E"},
      {"poissonRatio", at<S, &S::poissonRatio>, "", below(0, 0.5), "Poisson's ratio nu"},
      {"density", at<S, &S::density>, "kg/m^3", within(100, 20000), "Density rho"},
      optional("massDamping", at<S, &S::massDamping>, "1/s", within(0, 1000), "Rayleigh damping alpha"),
      optional("stiffnessDamping", at<S, &S::stiffnessDamping>, "s", within(0, 10), "Rayleigh damping beta"),
  };
}

}  // namespace calot
