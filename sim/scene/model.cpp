// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/scene/model.h"

#include <map>
#include <utility>

#include "sim/geometry/surface_distance.h"
#include "sim/math/floating_point.h"
#include "sim/scene/state.h"

namespace calot {

namespace {

TriangleMesh triangleMesh(const SurfaceDescription& surface) { return {surface.vertex, surface.triangle}; }

/// Nodes that the organ's anchors hold.
std::vector<bool> anchoredNodes(const OrganDescription& organ, const std::vector<Vec3>& nodes,
                                const std::map<std::string, const SurfaceDistance*>& surfaces) {
  std::vector<bool> fixed(nodes.size(), false);
  for (const AnchorDescription& anchor : organ.anchors) {
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      if (anchor.nearOrgan.empty()) {
        if ((nodes[n] - anchor.centre).norm() <= anchor.radius) fixed[n] = true;
      } else if (surfaces.at(anchor.nearOrgan)->signedDistance(nodes[n]) <= anchor.distance) {
        fixed[n] = true;
      }
    }
  }
  return fixed;
}

}  // namespace

Model::Built Model::build(SceneDescription scene) {
  const FloatingPointScope scope;
  Built built;
  if (scene.organs.size() > 15) {
    built.error = "a scene has at most 15 organs, this one has " + std::to_string(scene.organs.size());
    return built;
  }
  std::unique_ptr<Model> model(new Model);
  std::vector<std::unique_ptr<SurfaceDistance>> distances;
  std::map<std::string, const SurfaceDistance*> byName;
  for (const OrganDescription& organ : scene.organs) {
    for (const AnchorDescription& anchor : organ.anchors) {
      if (!anchor.nearOrgan.empty()) byName[anchor.nearOrgan] = nullptr;
    }
  }
  for (const OrganDescription& organ : scene.organs) {
    const auto wanted = byName.find(organ.name);
    if (wanted == byName.end()) continue;
    distances.push_back(std::make_unique<SurfaceDistance>(triangleMesh(organ.surface)));
    wanted->second = distances.back().get();
  }
  for (const auto& [name, distance] : byName) {
    if (distance == nullptr) {
      built.error = "an anchor names organ '" + name + "', which the scene does not have";
      return built;
    }
  }
  std::vector<std::string> names;
  for (const OrganDescription& organ : scene.organs) {
    StuffedMesh stuffed = stuffToCount(triangleMesh(organ.surface), static_cast<int>(organ.tetrahedra));
    if (!stuffed.ok()) {
      built.error = "organ '" + organ.name + "': " + stuffed.error;
      return built;
    }
    Embedding embedding(organ.surface.vertex, stuffed.mesh);
    ContactSurface contact(organ.surface.vertex, organ.surface.triangle);
    std::vector<Vec3>& nodes = stuffed.mesh.vertex;
    std::vector<bool> fixed = anchoredNodes(organ, nodes, byName);
    const MaterialDescription& m = organ.material;
    const SolidModel::Material material{lameConstants(m.youngModulus, m.poissonRatio), m.density, m.massDamping,
                                        m.stiffnessDamping};
    SolidModel solid(std::move(nodes), std::move(stuffed.mesh.tetrahedron), std::move(fixed), material);
    if (solid.freeNodes().empty()) {
      built.error = "organ '" + organ.name + "': its anchors hold every node";
      return built;
    }
    names.push_back(organ.name);
    model->organs_.push_back({organ.name, organ.appearance, std::move(solid), organ.surface.vertex,
                              std::move(embedding), std::move(contact), stuffed.cellSize, stuffed.report});
  }
  const std::vector<OrganModel>& organs = model->organs_;
  for (std::size_t a = 0; a < organs.size(); ++a) {
    for (std::size_t b = 0; b < organs.size(); ++b) {
      if (a == b) continue;
      model->tissuePairs_.push_back(
          {a, b, SurfacePair(organs[a].surface, organs[a].skin, organs[b].surface, organs[b].skin)});
    }
  }
  for (std::size_t o = 0; o < organs.size(); ++o) {
    model->tissuePairs_.push_back({o, o, std::nullopt});
  }
  model->layout_ = digestLayout(names);
  model->scene_ = std::move(scene);
  built.model = std::move(model);
  return built;
}

}  // namespace calot
