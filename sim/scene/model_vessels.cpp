// SPDX-License-Identifier: GPL-3.0-or-later
// The part of a Model that is built from vessels: trees of beams, and what ties their ends to organs.
#include <algorithm>
#include <string>
#include <vector>

#include "sim/scene/model.h"

namespace calot {

namespace {

/// An end that is grown to an organ is tied over this length, so that it does not hinge (m).
constexpr double grownLength = 0.003;

int nearestNode(const BeamModel& beams, std::size_t branch, const Vec3& point) {
  const std::vector<int>& nodes = beams.branches()[branch].node;
  return *std::min_element(nodes.begin(), nodes.end(), [&](int a, int b) {
    return (beams.rest()[static_cast<std::size_t>(a)] - point).squaredNorm() <
           (beams.rest()[static_cast<std::size_t>(b)] - point).squaredNorm();
  });
}

MaterialPoint placeOnNode(int node) {
  MaterialPoint place;
  place.node[0] = node;
  place.weight[0] = 1.0;
  place.count = 1;
  return place;
}

}  // namespace

std::vector<MaterialPoint> Model::placesOnOrgan(std::size_t organ, const std::vector<Vec3>& points) const {
  const SolidModel& solid = organs_[organ].solid;
  const Embedding embedding(points, {solid.rest(), solid.tetrahedra()});
  std::vector<MaterialPoint> places;
  for (const Embedding::Anchor& anchor : embedding.anchors()) {
    MaterialPoint& place = places.emplace_back();
    place.count = anchor.node.size();
    std::copy(anchor.node.begin(), anchor.node.end(), place.node.begin());
    std::copy(anchor.weight.begin(), anchor.weight.end(), place.weight.begin());
  }
  return places;
}

/// @return what is wrong with them, or nothing
std::string Model::addVessels(const SceneDescription& scene) {
  struct Home {
    std::size_t tree = 0, branch = 0;
  };
  std::vector<Home> home;
  std::vector<std::vector<BeamBranch>> branches;
  std::vector<std::vector<std::size_t>> vessel;
  for (std::size_t v = 0; v < scene.vessels.size(); ++v) {
    const VesselDescription& d = scene.vessels[v];
    const std::string what = "vessel '" + d.name + "': ";
    if (d.path.size() < 2 || d.elements < 1) return what + "needs two points and an element";
    for (std::size_t i = 0; i + 1 < d.path.size(); ++i) {
      if (!((d.path[i + 1] - d.path[i]).norm() > 1e-6)) return what + "two neighbouring points of its path coincide";
    }
    BeamBranch branch;
    branch.node = evenNodes(d.path, d.elements);
    branch.section = {d.radius, d.wall};
    const MaterialDescription& m = d.material;
    branch.material = {m.youngModulus, m.poissonRatio, m.density, m.massDamping, m.stiffnessDamping, d.ultimateStrain};
    branch.fixedStart = d.start.kind == VesselEndDescription::Kind::fixed;
    branch.fixedEnd = d.end.kind == VesselEndDescription::Kind::fixed;
    if (d.start.kind == VesselEndDescription::Kind::vessel) {
      std::size_t parent = 0;
      while (parent < v && scene.vessels[parent].name != d.start.to) ++parent;
      if (parent == v) return what + "grows out of '" + d.start.to + "', which is no vessel before it";
      home.push_back({home[parent].tree, branches[home[parent].tree].size()});
      branch.join = nearestNode(BeamModel(branches[home[parent].tree]), home[parent].branch, d.path.front());
    } else {
      home.push_back({branches.size(), 0});
      branches.emplace_back();
      vessel.emplace_back();
    }
    branches[home[v].tree].push_back(std::move(branch));
    vessel[home[v].tree].push_back(v);
    const std::string fault = BeamModel::faultOf(branches[home[v].tree]);
    if (!fault.empty()) return what + fault;
  }
  for (std::size_t t = 0; t < branches.size(); ++t) {
    vesselTree_.push_back({scene.vessels[vessel[t][0]].name, BeamModel(branches[t]), vessel[t]});
  }
  for (std::size_t v = 0; v < scene.vessels.size(); ++v) {
    const BeamModel& beams = vesselTree_[home[v].tree].beams;
    const BeamModel::Branch& branch = beams.branches()[home[v].branch];
    for (const bool atEnd : {false, true}) {
      const VesselEndDescription& end = atEnd ? scene.vessels[v].end : scene.vessels[v].start;
      if (end.kind != VesselEndDescription::Kind::organ) continue;
      std::size_t organ = 0;
      while (organ < organs_.size() && organs_[organ].name != end.to) ++organ;
      if (organ == organs_.size()) {
        return "vessel '" + scene.vessels[v].name + "': is grown to '" + end.to + "', which is no organ of the scene";
      }
      std::vector<int> grown;
      for (std::size_t i = 0; i < branch.node.size(); ++i) {
        const double away = atEnd ? branch.length() - branch.arcLength[i] : branch.arcLength[i];
        if (away <= grownLength) grown.push_back(branch.node[i]);
      }
      std::vector<Vec3> points;
      points.reserve(grown.size());
      for (const int node : grown) points.push_back(beams.rest()[static_cast<std::size_t>(node)]);
      const std::vector<MaterialPoint> places = placesOnOrgan(organ, points);
      for (std::size_t i = 0; i < grown.size(); ++i) {
        Tie tie;
        tie.body = {organ, organs_.size() + home[v].tree};
        tie.place = {places[i], placeOnNode(grown[i])};
        tie.stiffness = end.stiffness / static_cast<double>(grown.size());
        tie.damping = end.damping / static_cast<double>(grown.size());
        tie_.push_back(tie);
      }
    }
  }
  return {};
}

void Model::listStructures(const SceneDescription& scene) {
  for (std::size_t o = 0; o < organs_.size(); ++o) {
    const OrganDescription& d = scene.organs[o];
    structure_.push_back({d.name, d.appearance, StructureKind::organ, o, 0, o, d.friction});
  }
  structure_.resize(organs_.size() + scene.vessels.size());
  for (std::size_t f = 0; f < scene.fat.size(); ++f) {
    const FatDescription& d = scene.fat[f];
    structure_.push_back(
        {d.name, d.appearance, StructureKind::fat, f, 0, organs_.size() + vesselTree_.size() + f, d.friction});
  }
  for (std::size_t t = 0; t < vesselTree_.size(); ++t) {
    for (std::size_t b = 0; b < vesselTree_[t].vessel.size(); ++b) {
      const std::size_t v = vesselTree_[t].vessel[b];
      const VesselDescription& d = scene.vessels[v];
      structure_[organs_.size() + v] = {d.name,    d.appearance, StructureKind::vessel, t, b, organs_.size() + t,
                                        d.friction};
    }
  }
}

std::size_t Model::structureNamed(const std::string& name) const {
  std::size_t s = 0;
  while (s < structure_.size() && structure_[s].name != name) ++s;
  return s;
}

}  // namespace calot
