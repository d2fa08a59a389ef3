// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/tissue/vessel/vessel_tissue.h"

#include <algorithm>

#include "sim/scene/model.h"
#include "sim/scene/state.h"
#include "sim/tissue/structure.h"
#include "sim/vessel/beam_state.h"

namespace calot {

std::vector<Field> VesselEndDescription::fields() {
  using S = VesselEndDescription;
  const auto number = [](Kind kind) { return static_cast<std::uint32_t>(kind); };
  return {
      object("vesselEnd", "Support of an end of a vessel"),
      {"kind", at<S, &S::kind>,
       FieldWords{{"free", number(Kind::free)},
                  {"fixed", number(Kind::fixed)},
                  {"organ", number(Kind::organ)},
                  {"vessel", number(Kind::vessel)}},
       "free: no support; fixed: held in the reference configuration; organ: grown to an organ; vessel "
       "(starts only): grows out of an earlier vessel of the list, at its node nearest to the start"},
      optional("to", at<S, &S::to>, sceneName,
               "That organ or vessel, at most 0.005 m away; a free or a fixed end has no such key"),
      Field(at<S, &S::stiffness>),
      Field(at<S, &S::damping>),
  };
}

std::vector<Field> VesselDescription::fields() {
  using S = VesselDescription;
  return {
      object("vessel", "Duct or artery: a tube along a curve (docs/explanation/vessels.md)"),
      {"name", at<S, &S::name>, sceneName, "Name, unique among organs, vessels and fat"},
      {"appearance", at<S, &S::appearance>, sceneName, "Look that a renderer gives it"},
      roleField(at<S, &S::role>, {StructureRole::cysticDuct, StructureRole::cysticArtery, StructureRole::bileDuct,
                                  StructureRole::artery}),
      Field("path", at<S, &S::path>, "m", sceneCoordinate,
            "Points of the centre line in the reference configuration, from start to end, joined by a smooth "
            "curve; neighbours at least 0.0001 m apart, no bend of 90 degrees or more")
          .items(2, 1000),
      optional("elements", at<S, &S::elements>, "", within(2, 400), "Beam elements of equal length"),
      {"radius", at<S, &S::radius>, "m", within(0.0002, 0.02), "Outer radius"},
      {"wall", at<S, &S::wall>, "m", within(0.00005, 0.02), "Thickness of the wall, below the radius"},
      {"material", at<S, &S::material>, "Material of the wall"},
      optional("ultimateStrain", at<S, &S::ultimateStrain>, "", above(0, 10),
               "Stretch (length over length in the reference configuration, less 1) at which it tears"),
      optional("burnThrough", at<S, &S::burnThrough>, "s", above(0, 1000), "Cautery at one spot that parts it"),
      optional("friction", at<S, &S::friction>, "", within(0, 2), "Coulomb coefficient of an instrument on it"),
      {"start", at<S, &S::start>, "Support of the first end"},
      {"end", at<S, &S::end>, "Support of the last end"},
  };
}

Field VesselTissue::sceneKey() {
  return optional("vessels", at<SceneDescription, &SceneDescription::vessels>,
                  "Ducts and arteries; organs, vessels and fat together are at most 16")
      .items(0, maxStructures);
}

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

std::string VesselTissue::build(const SceneDescription& scene, Model& model) {
  const std::vector<OrganModel>& organs = model.organs();
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
      const std::size_t parent = indexNamed(scene.vessels, d.start.to);
      if (parent >= v) return what + "grows out of '" + d.start.to + "', which is not a vessel before it";
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
    model.vesselTree.push_back({scene.vessels[vessel[t][0]].name, BeamModel(branches[t]), vessel[t]});
  }
  for (std::size_t v = 0; v < scene.vessels.size(); ++v) {
    const BeamModel& beams = model.vesselTree[home[v].tree].beams;
    const BeamModel::Branch& branch = beams.branches()[home[v].branch];
    for (const bool atEnd : {false, true}) {
      const VesselEndDescription& end = atEnd ? scene.vessels[v].end : scene.vessels[v].start;
      if (end.kind != VesselEndDescription::Kind::organ) continue;
      const std::size_t organ = indexNamed(organs, end.to);
      if (organ == organs.size()) {
        return "vessel '" + scene.vessels[v].name + "': is grown to '" + end.to +
               "', which is not an organ of the scene";
      }
      std::vector<int> grown;
      for (std::size_t i = 0; i < branch.node.size(); ++i) {
        const double away = atEnd ? branch.length() - branch.arcLength[i] : branch.arcLength[i];
        if (away <= grownLength) grown.push_back(branch.node[i]);
      }
      std::vector<Vec3> points;
      points.reserve(grown.size());
      for (const int node : grown) points.push_back(beams.rest()[static_cast<std::size_t>(node)]);
      const std::vector<MaterialPoint> places = pointsOnOrgan(organs[organ], points);
      for (std::size_t i = 0; i < grown.size(); ++i) {
        Tie tie;
        tie.body = {organ, organs.size() + home[v].tree};
        tie.place = {places[i], placeOnNode(grown[i])};
        tie.stiffness = end.stiffness / static_cast<double>(grown.size());
        tie.damping = end.damping / static_cast<double>(grown.size());
        model.addTie(tie);
      }
    }
  }
  return {};
}

void VesselTissue::listStructures(const Model& model, TissueId kind, std::size_t firstBody,
                                  std::vector<StructureModel>& structures) {
  const std::size_t first = structures.size();
  structures.resize(first + model.scene().vessels.size());
  for (std::size_t t = 0; t < model.vesselTrees().size(); ++t) {
    const VesselTree& tree = model.vesselTrees()[t];
    for (std::size_t b = 0; b < tree.vessel.size(); ++b) {
      const VesselDescription& d = model.scene().vessels[tree.vessel[b]];
      structures[first + tree.vessel[b]] = {d.name, d.appearance, d.role, kind, t, b, firstBody + t, d.friction};
    }
  }
}

const std::string& VesselTissue::nameOf(const Model& model, std::size_t index) {
  return model.vesselTrees()[index].name;
}

void VesselTissue::start(const Model& model, States& states) {
  for (std::size_t t = 0; t < model.vesselTrees().size(); ++t) {
    states.vessel.push_back(restState(model.vesselTrees()[t].beams));
    if (!model.holds(model.organs().size() + t)) states.vessel.back().quietSteps = 0;
  }
}

bool VesselTissue::fits(const Model& model, const States& states) {
  for (std::size_t t = 0; t < states.vessel.size(); ++t) {
    if (!calot::fits(model.vesselTrees()[t].beams, states.vessel[t])) return false;
  }
  return true;
}

void VesselTissue::resize(const Model& model, Results& results) { results.vessel.resize(model.scene().vessels.size()); }

}  // namespace calot
