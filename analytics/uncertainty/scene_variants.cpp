// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/uncertainty/scene_variants.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "analytics/uncertainty/scene_constants.h"

namespace calot::analytics {
namespace {

/// A number of parts along `dimension` directions, with parts shorter by the ratio.
std::uint32_t parts(std::uint32_t count, double ratio, double dimension) {
  return static_cast<std::uint32_t>(std::lround(count * std::pow(ratio, dimension)));
}

}  // namespace

SceneDescription redivided(const SceneDescription& scene, std::uint32_t ticksPerStep, double elements) {
  SceneDescription divided = scene;
  divided.ticksPerStep = ticksPerStep;
  const double ratio = std::cbrt(elements);
  for (OrganDescription& organ : divided.organs) organ.tetrahedra = parts(organ.tetrahedra, ratio, 3.0);
  for (VesselDescription& vessel : divided.vessels) vessel.elements = parts(vessel.elements, ratio, 1.0);
  for (ConnectiveDescription& bed : divided.connective) bed.strands = parts(bed.strands, ratio, 2.0);
  for (FatDescription& fat : divided.fat) fat.cellsPerCube = std::max(1U, parts(fat.cellsPerCube, ratio, -1.0));
  return divided;
}

const std::array<AssumedFactor, designFactors>& assumedFactors() {
  static const std::array<AssumedFactor, designFactors> factors{{
      {"stiffness of organs", {"organs.liver.material.youngModulus", "organs.gallbladder.material.youngModulus"}, {}},
      {"damping",
       {"organs.liver.material.stiffnessDamping", "organs.gallbladder.material.stiffnessDamping",
        "connective.*.damping"},
       {}},
      {"stiffness of fat", {"fat.*.material.youngModulus", "fat.*.attachments.*.stiffness"}, {}},
      {"stiffness of vessels", {"vessels.*.material.youngModulus", "vessels.*.wall"}, {}},
      {"strength of vessels", {"vessels.*.ultimateStrain"}, {}},
      {"stiffness of the bed", {"connective.*.stiffness"}, {}},
      {"strength of the bed", {"connective.*.strength"}, {}},
      {"friction",
       {"organs.liver.friction", "organs.gallbladder.friction", "vessels.*.friction", "fat.*.friction"},
       {}},
      {"grip", {"hands.*.slipForce", "hands.*.tearForce", "hands.*.couplingStiffness"}, {}},
      {"pace of cautery",
       {"cautery.power", "cautery.recession", "cautery.reach"},
       {"organs.liver.burnThrough", "organs.gallbladder.burnThrough", "vessels.*.burnThrough",
        "connective.*.fadeTime"}},
      {"char", {"cautery.spot", "cautery.cutChar"}, {"cautery.charTime"}},
  }};
  return factors;
}

int designSign(std::size_t run, std::size_t factor) {
  assert(run < designRuns && factor < designFactors);
  constexpr std::array<int, designFactors> generator{1, 1, -1, 1, 1, 1, -1, -1, -1, 1, -1};
  if (run + 1 == designRuns) return -1;
  return generator[(factor + designFactors - run) % designFactors];
}

SceneDescription perturbed(const SceneDescription& scene, std::size_t run) {
  SceneDescription changed = scene;
  for (std::size_t f = 0; f < designFactors; ++f) {
    const AssumedFactor& factor = assumedFactors()[f];
    const double times = 1.0 + designSign(run, f) * assumedChange;
    for (const std::string& name : factor.constants) findSceneConstant(name)->multiply(changed, times);
    for (const std::string& name : factor.inverse) findSceneConstant(name)->multiply(changed, 1.0 / times);
  }
  return changed;
}

}  // namespace calot::analytics
