// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/tissue/organ/organ_tissue.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "sim/geometry/surface_distance.h"
#include "sim/geometry/triangle_mesh.h"
#include "sim/scene/model.h"
#include "sim/scene/scene_view.h"
#include "sim/scene/state.h"
#include "sim/tissue/structure.h"

namespace calot {

namespace {

/// Size of the patch over which a node of the lattice spreads a force, in edges of its cells. 0.225 gives the
/// compliance of the meshes of a block of 1,100 to 20,000 tetrahedra, less that of the half-space outside the cells, at
/// vertices, edges and faces within 5 %; this is best down to 6 mm (docs/explanation/accuracy.md). Larger: softer
/// contact on coarse meshes.
constexpr double latticeSpread = 0.235;

std::vector<Field> sphereFields() {
  using S = AnchorDescription;
  return {
      object("sphere", "Sphere in W"),
      {"centre", at<S, &S::centre>, "m", sceneCoordinate, "Centre"},
      {"radius", at<S, &S::radius>, "m", above(0, 1), "Radius"},
  };
}

std::vector<Field> nearOrganFields() {
  using S = AnchorDescription;
  return {
      object("nearOrgan", "Nearness to another organ"),
      {"organ", at<S, &S::nearOrgan>, sceneName, "Name of that organ"},
      {"distance", at<S, &S::distance>, "m", above(0, 0.1), "Largest distance of a node"},
  };
}

}  // namespace

std::vector<Field> AnchorDescription::fields() {
  return {
      object("anchor", "Either a sphere or nearness to another organ"),
      optional("sphere", keyGroup<AnchorDescription, sphereFields>, "All nodes inside"),
      optional("nearOrgan", keyGroup<AnchorDescription, nearOrganFields>,
               "All nodes near another organ's surface, in the reference configuration"),
  };
}

std::vector<Field> OrganDescription::fields() {
  using S = OrganDescription;
  return {
      object("organ", "Deformable organ"),
      {"name", at<S, &S::name>, sceneName, "Name, unique among organs, vessels and fat"},
      {"appearance", at<S, &S::appearance>, sceneName, "Look that a renderer gives it"},
      roleField(at<S, &S::role>, {StructureRole::liver, StructureRole::gallbladder}),
      {"mesh", at<S, &S::surface>, "Closed surface in W, in the reference configuration"},
      {"tetrahedra", at<S, &S::tetrahedra>, "", within(10, 1e6), "Requested number of tetrahedra"},
      {"material", at<S, &S::material>, "Material"},
      optional("friction", at<S, &S::friction>, "", within(0, 2), "Coulomb coefficient of an instrument on this organ"),
      optional("burnThrough", at<S, &S::burnThrough>, "s", within(0, 1000),
               "Cautery at one spot that perforates its wall; 0: it has no wall"),
      Field("anchors", at<S, &S::anchors>, "Regions whose nodes are held in the reference configuration").items(0, 64),
  };
}

Field OrganTissue::sceneKey() {
  return Field("organs", at<SceneDescription, &SceneDescription::organs>,
               "Organs, in the order of every table of organs")
      .items(1, maxStructures);
}

namespace {

/// Surfaces that anchors measure distances from, by the organ's name.
using AnchorSurfaces = std::map<std::string, std::unique_ptr<SurfaceDistance>>;

/// @return the fault, or nothing
std::string findAnchorSurfaces(const SceneDescription& scene, AnchorSurfaces& surfaces) {
  for (const OrganDescription& organ : scene.organs) {
    for (const AnchorDescription& anchor : organ.anchors) {
      if (!anchor.nearOrgan.empty()) surfaces[anchor.nearOrgan] = nullptr;
    }
  }
  for (const OrganDescription& organ : scene.organs) {
    const auto wanted = surfaces.find(organ.name);
    if (wanted != surfaces.end()) wanted->second = std::make_unique<SurfaceDistance>(organ.surface.mesh());
  }
  for (const auto& [name, distance] : surfaces) {
    if (distance == nullptr) return "an anchor names organ '" + name + "', which the scene does not have";
  }
  return {};
}

/// Nodes that the organ's anchors constrain.
std::vector<bool> anchoredNodes(const OrganDescription& organ, const std::vector<Vec3>& nodes,
                                const AnchorSurfaces& surfaces) {
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

/// Sides of the cells by which char is kept (m): a third of the width that the hook's wire touches of a flat skin.
/// Larger: the edge of what is charred becomes ragged; smaller: more State. Assumed.
constexpr double longestCell = 0.0005;
constexpr std::uint32_t maxDivision = 255;

/// Areas of a surface's triangles (m^2) and into how many cells their sides are divided.
void measureTriangles(const SurfaceDescription& surface, std::vector<double>& area,
                      std::vector<std::uint8_t>& division) {
  for (const Index3& t : surface.triangle) {
    const Vec3& a = surface.vertex[static_cast<std::size_t>(t[0])];
    const Vec3& b = surface.vertex[static_cast<std::size_t>(t[1])];
    const Vec3& c = surface.vertex[static_cast<std::size_t>(t[2])];
    area.push_back(0.5 * (b - a).cross(c - a).norm());
    division.push_back(static_cast<std::uint8_t>(cellsAlongSide(a, b, c, longestCell, maxDivision)));
  }
}

/// Is this a state of burns of the organ's skin? Checks external data.
bool fitsBurns(const OrganModel& organ, const CharState& burns) {
  if (burns.firstCell.size() != burns.triangle.size() || burns.charring.size() != burns.exposure.size()) return false;
  std::vector<bool> seen(organ.division.size(), false);
  std::size_t cells = 0;
  for (std::size_t k = 0; k < burns.triangle.size(); ++k) {
    const std::size_t t = burns.triangle[k];
    if (t >= seen.size() || seen[t] || burns.firstCell[k] != cells) return false;
    seen[t] = true;
    cells += std::size_t{organ.division[t]} * organ.division[t];
  }
  const auto isTime = [](float seconds) { return seconds >= 0.0F && seconds < 1e9F; };
  return burns.exposure.size() == cells && std::all_of(burns.charring.begin(), burns.charring.end(), isTime) &&
         std::all_of(burns.exposure.begin(), burns.exposure.end(), isTime);
}

}  // namespace

std::string OrganTissue::build(const SceneDescription& scene, Model& model) {
  AnchorSurfaces surfaces;
  if (std::string fault = findAnchorSurfaces(scene, surfaces); !fault.empty()) return fault;
  std::vector<OrganModel>& organs = model.organModel;
  for (const OrganDescription& organ : scene.organs) {
    StuffedMesh stuffed = stuffToCount(organ.surface.mesh(), static_cast<int>(organ.tetrahedra));
    if (!stuffed.ok()) return "organ '" + organ.name + "': " + stuffed.error;
    Embedding embedding(organ.surface.vertex, stuffed.mesh);
    ContactSurface contact(organ.surface.vertex, organ.surface.triangle);
    std::vector<Vec3>& nodes = stuffed.mesh.vertex;
    const std::vector<bool> fixed = anchoredNodes(organ, nodes, surfaces);
    SolidModel solid(std::move(nodes), std::move(stuffed.mesh.tetrahedron), fixed, solidMaterial(organ.material));
    if (solid.freeNodes().empty()) return "organ '" + organ.name + "': its anchors hold every node";
    organs.push_back({organ.name,
                      organ.appearance,
                      std::move(solid),
                      organ.surface.vertex,
                      std::move(embedding),
                      std::move(contact),
                      {},
                      {},
                      stuffed.cellSize});
    measureTriangles(organ.surface, organs.back().triangleArea, organs.back().division);
  }
  for (std::size_t a = 0; a < organs.size(); ++a) {
    for (std::size_t b = 0; b < organs.size(); ++b) {
      if (a == b) continue;
      model.tissuePair.push_back(
          {a, b, SurfacePair(organs[a].surface, organs[a].skin, organs[b].surface, organs[b].skin)});
    }
  }
  for (std::size_t o = 0; o < organs.size(); ++o) model.tissuePair.push_back({o, o, std::nullopt});
  return {};
}

void OrganTissue::listStructures(const Model& model, TissueId kind, std::size_t firstBody,
                                 std::vector<StructureModel>& structures) {
  for (std::size_t o = 0; o < model.organs().size(); ++o) {
    const OrganDescription& d = model.scene().organs[o];
    const OrganModel& organ = model.organs()[o];
    structures.push_back({d.name, d.appearance, d.role, kind, o, 0, firstBody + o, d.friction, &organ.solid,
                          latticeSpread * organ.cellSize});
  }
}

const std::string& OrganTissue::nameOf(const Model& model, std::size_t index) { return model.organs()[index].name; }

void OrganTissue::start(const Model& model, States& states) {
  for (std::size_t o = 0; o < model.organs().size(); ++o) {
    states.organ.push_back(restState(model.organs()[o].solid));
    if (!model.holds(o)) states.organ.back().quietSteps = 0;
    states.charred.emplace_back();
  }
}

bool OrganTissue::fits(const Model& model, const States& states) {
  for (std::size_t o = 0; o < states.organ.size(); ++o) {
    const SolidModel& solid = model.organs()[o].solid;
    const SolidState& organ = states.organ[o];
    if (organ.position.size() != solid.nodes() || organ.velocity.size() != solid.nodes()) return false;
    if (organ.rotation.size() != solid.groups()) return false;
    if (!fitsBurns(model.organs()[o], states.charred[o])) return false;
  }
  return true;
}

void OrganTissue::resize(const Model& model, Results& results) { results.organ.resize(model.organs().size()); }

std::vector<MaterialPoint> pointsOnOrgan(const OrganModel& organ, const std::vector<Vec3>& points) {
  const Embedding embedding(points, {organ.solid.rest(), organ.solid.tetrahedra()});
  std::map<std::array<int, 4>, int> elements;
  for (std::size_t e = 0; e < organ.solid.tetrahedra().size(); ++e) {
    const Index4& t = organ.solid.tetrahedra()[e];
    elements.emplace(std::array{t[0], t[1], t[2], t[3]}, static_cast<int>(e));
  }
  std::vector<MaterialPoint> places;
  for (const Embedding::Anchor& anchor : embedding.anchors()) {
    MaterialPoint& place = places.emplace_back();
    place.element = elements.at(anchor.node);
    place.count = anchor.node.size();
    std::copy(anchor.node.begin(), anchor.node.end(), place.node.begin());
    std::copy(anchor.weight.begin(), anchor.weight.end(), place.weight.begin());
  }
  return places;
}

namespace {

class OrganViewer final : public TissueViewer {
 public:
  explicit OrganViewer(const Model& model) : model_(model) {
    for (const OrganModel& organ : model.organs()) {
      std::vector<double>& area = vertexArea_.emplace_back(organ.skin.size(), 0.0);
      for (std::size_t t = 0; t < organ.triangleArea.size(); ++t) {
        for (int k = 0; k < 3; ++k)
          area[static_cast<std::size_t>(organ.surface.triangles()[t][k])] += organ.triangleArea[t] / 3.0;
      }
    }
  }

  void addTo(SceneView& view, const State& state) override {
    for (std::size_t o = 0; o < model_.organs().size(); ++o) {
      const OrganModel& organ = model_.organs()[o];
      SurfaceView& surface = view.surface.emplace_back();
      surface.organ = organ.name;
      surface.appearance = organ.appearance;
      surface.role = model_.structures()[o].role;
      surface.rest = organ.skin;
      organ.embedding.map(state.organ[o].position, surface.position);
      surface.triangle = organ.surface.triangles();
      if (state.charred[o].area > 0.0) addChar(organ, state.charred[o], surface);
    }
  }

 private:
  /// At a vertex: mean over the cells around it, each by its area and its weight of that vertex.
  void addChar(const OrganModel& organ, const CharState& charred, SurfaceView& surface) const {
    const double full = model_.scene().cautery.charTime;
    const std::vector<double>& area = vertexArea_[static_cast<std::size_t>(&organ - model_.organs().data())];
    std::vector<double> sum(organ.skin.size(), 0.0);
    for (std::size_t k = 0; k < charred.triangle.size(); ++k) {
      const std::size_t t = charred.triangle[k];
      const std::uint32_t n = organ.division[t];
      const Index3& corner = organ.surface.triangles()[t];
      forEachTriangleCell(n, [&](std::uint32_t cell, const Vec3& weight) {
        const double share = organ.triangleArea[t] / (n * n) * double{charred.charring[charred.firstCell[k] + cell]};
        for (int c = 0; c < 3; ++c) sum[static_cast<std::size_t>(corner[c])] += weight[c] * share;
      });
    }
    for (std::size_t v = 0; v < sum.size(); ++v)
      surface.charred.push_back(area[v] > 0.0 ? static_cast<float>(sum[v] / (area[v] * full)) : 0.0F);
  }

  const Model& model_;
  std::vector<std::vector<double>> vertexArea_;  ///< per organ: a third of the triangles around each vertex (m^2)
};

}  // namespace

std::unique_ptr<TissueViewer> OrganTissue::makeViewer(const Model& model) {
  return std::make_unique<OrganViewer>(model);
}

}  // namespace calot
