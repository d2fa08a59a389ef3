// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/checkpoints/scene_facts.h"

#include <algorithm>
#include <cmath>

#include "sim/connective/connective_tissue.h"

namespace calot::analytics {
namespace {

double areaOf(const SurfaceDescription& surface) {
  double area = 0.0;
  for (const Index3& t : surface.triangle) {
    const Vec3& origin = surface.vertex[static_cast<std::size_t>(t[0])];
    const Vec3 a = surface.vertex[static_cast<std::size_t>(t[1])] - origin;
    const Vec3 b = surface.vertex[static_cast<std::size_t>(t[2])] - origin;
    const double x = a.y() * b.z() - a.z() * b.y();
    const double y = a.z() * b.x() - a.x() * b.z();
    const double z = a.x() * b.y() - a.y() * b.x();
    area += 0.5 * std::sqrt(x * x + y * y + z * z);
  }
  return area;
}

TriangleMesh meshOf(const SurfaceDescription& surface) { return {surface.vertex, surface.triangle}; }

/// Area of the bed of a tissue (m^2), as the simulation finds it; 0 where the scene lacks one of its organs.
double bedAreaOf(const SceneDescription& scene, const ConnectiveDescription& tissue) {
  const auto organ = [&](const std::string& name) {
    return std::find_if(scene.organs.begin(), scene.organs.end(), [&](const auto& o) { return o.name == name; });
  };
  const auto first = organ(tissue.first), second = organ(tissue.second);
  if (first == scene.organs.end() || second == scene.organs.end() || second->surface.triangle.empty()) return 0.0;
  const SurfaceDistance distance(meshOf(second->surface));
  return areaOf({first->surface.vertex, bedTriangles(meshOf(first->surface), distance, tissue.reach)});
}

}  // namespace

bool SceneFacts::hasCystic() const {
  return std::any_of(vessel.begin(), vessel.end(), [](const Vessel& v) { return v.cystic; });
}

bool SceneFacts::hasSpared() const {
  return std::any_of(vessel.begin(), vessel.end(), [](const Vessel& v) { return v.spared; });
}

SceneFacts sceneFacts(const SceneDescription& scene) {
  SceneFacts facts;
  for (const OrganDescription& organ : scene.organs) {
    facts.organ.push_back({organ.name, organ.role, areaOf(organ.surface), organ.burnThrough > 0.0});
  }
  for (const VesselDescription& vessel : scene.vessels) {
    const std::vector<std::string>& spare = scene.procedure.spare;
    facts.vessel.push_back(
        {vessel.name, isCystic(vessel.role), std::find(spare.begin(), spare.end(), vessel.name) != spare.end()});
  }
  for (const ConnectiveDescription& tissue : scene.connective) {
    const bool holds = tissue.role == StructureRole::cysticPlate;
    facts.connective.push_back({tissue.name, holds, holds ? bedAreaOf(scene, tissue) : 0.0});
  }
  facts.fat = scene.fat.size();
  facts.picture = {scene.camera, scene.verticalFieldOfView};
  facts.triangle = std::any_of(scene.fat.begin(), scene.fat.end(),
                               [](const FatDescription& fat) { return fat.triangleDepth > 0.0; });
  facts.retractionOnRequest = std::any_of(scene.retraction.begin(), scene.retraction.end(),
                                          [](const RetractionDescription& r) { return r.stage > 0.0; });
  return facts;
}

}  // namespace calot::analytics
