// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/scene/model.h"

#include <map>
#include <utility>

#include "sim/connective/connective_bed.h"
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

std::vector<double> vertexAreas(const SurfaceDescription& surface) {
  std::vector<double> area(surface.vertex.size(), 0.0);
  for (const Index3& t : surface.triangle) {
    const Vec3& a = surface.vertex[static_cast<std::size_t>(t[0])];
    const Vec3& b = surface.vertex[static_cast<std::size_t>(t[1])];
    const Vec3& c = surface.vertex[static_cast<std::size_t>(t[2])];
    const double third = (b - a).cross(c - a).norm() / 6.0;
    for (int k = 0; k < 3; ++k) area[static_cast<std::size_t>(t[k])] += third;
  }
  return area;
}

}  // namespace

Model::Built Model::build(SceneDescription scene) {
  const FloatingPointScope scope;
  Built built;
  const std::size_t structures = scene.organs.size() + scene.vessels.size() + scene.fat.size();
  if (structures > maxStructures) {
    built.error = std::to_string(structures) + " structures (organs, vessels and bodies of fat); at most " +
                  std::to_string(maxStructures) + " are allowed";
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
    const std::vector<bool> fixed = anchoredNodes(organ, nodes, byName);
    const MaterialDescription& m = organ.material;
    const SolidModel::Material material{lameConstants(m.youngModulus, m.poissonRatio), m.density, m.massDamping,
                                        m.stiffnessDamping};
    SolidModel solid(std::move(nodes), std::move(stuffed.mesh.tetrahedron), fixed, material);
    if (solid.freeNodes().empty()) {
      built.error = "organ '" + organ.name + "': its anchors hold every node";
      return built;
    }
    names.push_back(organ.name);
    model->organs_.push_back({organ.name, organ.appearance, std::move(solid), organ.surface.vertex,
                              std::move(embedding), std::move(contact), vertexAreas(organ.surface), stuffed.cellSize});
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
  std::vector<std::string> tissues;
  for (const ConnectiveDescription& description : scene.connective) {
    built.error = model->addConnective(scene, description);
    if (!built.error.empty()) return built;
    tissues.push_back(description.name);
  }
  built.error = model->addVessels(scene);
  if (!built.error.empty()) return built;
  DigestNames digested{names, tissues, {}, {}, false};
  for (const FatDescription& description : scene.fat) {
    built.error = model->addFat(scene, description);
    if (!built.error.empty()) return built;
    digested.fat.push_back(description.name);
  }
  model->listStructures(scene);
  for (const VesselTree& tree : model->vesselTree_) digested.vesselTrees.push_back(tree.name);
  built.error = model->addProcedure(scene);
  if (!built.error.empty()) return built;
  built.error = model->addRetractions(scene);
  if (!built.error.empty()) return built;
  digested.procedure = model->procedure_.present;
  model->layout_ = digestLayout(digested);
  model->scene_ = std::move(scene);
  built.model = std::move(model);
  return built;
}

/// @return what is wrong with it, or nothing
std::string Model::addConnective(const SceneDescription& scene, const ConnectiveDescription& description) {
  const auto index = [&](const std::string& name) {
    std::size_t o = 0;
    while (o < organs_.size() && organs_[o].name != name) ++o;
    return o;
  };
  const std::string what = "connective tissue '" + description.name + "': ";
  const std::size_t a = index(description.first);
  const std::size_t b = index(description.second);
  for (const auto& [organ, name] : {std::pair{a, description.first}, std::pair{b, description.second}}) {
    if (organ == organs_.size()) return what + "the scene has no organ '" + name + "'";
  }
  if (a == b) return what + "joins organ '" + description.first + "' to itself";
  const auto meshOf = [&](std::size_t o) {
    return TetrahedralMesh{organs_[o].solid.rest(), organs_[o].solid.tetrahedra()};
  };
  const TriangleMesh skinA = triangleMesh(scene.organs[a].surface);
  const TriangleMesh skinB = triangleMesh(scene.organs[b].surface);
  const TetrahedralMesh meshA = meshOf(a);
  const TetrahedralMesh meshB = meshOf(b);
  ConnectiveBed bed = makeBed({skinA, meshA}, {skinB, meshB}, description.reach, description.strands);
  if (!bed.ok()) return what + bed.error;
  ConnectiveMaterial material;
  material.stiffness = description.stiffness;
  material.damping = description.damping;
  material.strength = description.strength;
  material.fadeTime = description.fadeTime;
  connective_.push_back(
      {description.name, a, b, ConnectiveTissue(std::move(bed.strands), std::move(bed.sheets), material)});
  return {};
}

}  // namespace calot
