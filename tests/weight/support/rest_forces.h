// SPDX-License-Identifier: GPL-3.0-or-later
// Forces on all nodes of a scene in the reference configuration, added up from elements, beams, ties, strands and
// weight by themselves, beside the step.
#pragma once

#include <string>
#include <vector>

#include "recorder/formats/scene_file.h"
#include "sim/math/executor.h"
#include "sim/scene/state.h"
#include "sim/vessel/beam_model.h"

namespace calot::test {

inline SceneDescription sceneNamed(const std::string& name) {
  return recorder::loadScene(std::string(CALOT_SOURCE_DIR) + "/assets/scenes/" + name + ".json").description;
}

/// Per body and node (N); moments per node of vessels (N m).
struct RestForces {
  std::vector<std::vector<Vec3>> force;
  std::vector<std::vector<Vec3>> moment;
  Vec3 weight = Vec3::Zero();  ///< of all that is not fixed
};

inline void addAt(const MaterialPoint& point, const Vec3& force, std::vector<Vec3>& out) {
  for (std::size_t k = 0; k < point.count; ++k) out[static_cast<std::size_t>(point.node[k])] += point.weight[k] * force;
}

inline std::vector<Vec3> solidForces(const SolidModel& solid, std::span<const double> fill, const Vec3& gravity) {
  SolidState state = restState(solid);
  SerialExecutor executor;
  std::vector<double> mass = solid.mass();
  if (!fill.empty()) solid.massOf(fill, mass);
  std::vector<Vec3> out;
  for (const double m : mass) out.emplace_back(m * gravity);
  const auto add = [&](const auto& node, const auto& force, std::size_t corners, std::size_t l) {
    for (std::size_t a = 0; a < corners; ++a) {
      out[static_cast<std::size_t>(node[a])] += Vec3(force[a][0][l], force[a][1][l], force[a][2][l]);
    }
  };
  if (solid.madeOfCubes()) {
    std::vector<HexahedronResult> result(solid.groups());
    solid.hexahedra().evaluate(state.position, state.velocity, 0.0, 8, fill, state.rotation, result, executor);
    for (std::size_t e = 0; e < solid.cubes().size(); ++e) {
      add(solid.cubes()[e], result[e / laneCount].force, 8, e % laneCount);
    }
  } else {
    std::vector<ElementResult> result(solid.groups());
    solid.elements().evaluate(state.position, state.velocity, 0.0, solid.material().lame, 8, state.rotation, result,
                              executor);
    for (std::size_t e = 0; e < solid.tetrahedra().size(); ++e) {
      const Index4& t = solid.tetrahedra()[e];
      add(std::array{t[0], t[1], t[2], t[3]}, result[e / laneCount].force, 4, e % laneCount);
    }
  }
  return out;
}

inline void addBeams(const BeamModel& beams, const Vec3& gravity, std::vector<Vec3>& force, std::vector<Vec3>& moment) {
  const BeamState rest = restState(beams);
  for (const double m : beams.mass()) force.emplace_back(m * gravity);
  moment.assign(beams.nodes(), Vec3::Zero());
  for (std::size_t index = 0; index < beams.elements().size(); ++index) {
    const BeamElement& e = beams.elements()[index];
    const BeamStrain s = strainOf(e, rest, index);
    const BeamStiffness k = stiffnessOf(e, s, 0.0);
    const auto a = static_cast<std::size_t>(e.a);
    const auto b = static_cast<std::size_t>(e.b);
    force[a] += s.force;
    force[b] -= s.force;
    moment[a] += s.moment - k.ga.transpose() * s.force;
    moment[b] -= s.moment + k.gb.transpose() * s.force;
  }
}

/// Zero at nodes that are fixed.
inline RestForces restForces(const Model& model) {
  RestForces out;
  const Vec3& gravity = model.scene().gravity;
  const std::size_t organs = model.organs().size();
  std::vector<std::vector<Vec3>> position;
  for (const OrganModel& organ : model.organs()) {
    out.force.push_back(solidForces(organ.solid, {}, gravity));
    position.push_back(organ.solid.rest());
  }
  out.moment.resize(organs);
  for (const VesselTree& tree : model.vesselTrees()) {
    addBeams(tree.beams, gravity, out.force.emplace_back(), out.moment.emplace_back());
    position.push_back(tree.beams.rest());
  }
  for (const auto& fat : model.fat()) {
    out.force.push_back(solidForces(fat->solid(), fat->restFill(), gravity));
    out.moment.emplace_back();
    position.push_back(fat->solid().rest());
  }
  for (const Tie& tie : model.ties()) {
    Vec3 end = tie.place[0].of(position[tie.body[0]]);
    if (tie.body[0] < organs) {
      end += tie.offset;
    } else {
      const BeamModel& beams = model.vesselTrees()[tie.body[0] - organs].beams;
      end += beams.restOrientation()[static_cast<std::size_t>(tie.place[0].node[0])] * tie.offset;
    }
    const Vec3 pull = tie.stiffness * (end - tie.place[1].of(position[tie.body[1]]));
    addAt(tie.place[0], -pull, out.force[tie.body[0]]);
    addAt(tie.place[1], pull, out.force[tie.body[1]]);
  }
  for (const ConnectiveModel& connective : model.connective()) {
    const SolidState a = restState(model.organs()[connective.a].solid);
    const SolidState b = restState(model.organs()[connective.b].solid);
    ConnectiveLoads loads;
    linearise(connective.tissue, intactState(connective.tissue), {a.position, a.velocity, a.rotation},
              {b.position, b.velocity, b.rotation}, 0.01, loads);
    for (const Attachment& on : loads.onA) addAt(on.point, on.force, out.force[connective.a]);
    for (const Attachment& on : loads.onB) addAt(on.point, on.force, out.force[connective.b]);
  }
  for (std::size_t o = 0; o < organs; ++o) {
    const SolidModel& solid = model.organs()[o].solid;
    for (std::size_t n = 0; n < solid.nodes(); ++n) {
      if (solid.row(n) < 0) out.force[o][n].setZero();
    }
    out.weight += solid.wholeMass() * gravity;
  }
  for (std::size_t t = 0; t < model.vesselTrees().size(); ++t) {
    const BeamModel& beams = model.vesselTrees()[t].beams;
    for (std::size_t n = 0; n < beams.nodes(); ++n) {
      out.weight += beams.mass()[n] * gravity;
      if (!beams.fixed(n)) continue;
      out.force[organs + t][n].setZero();
      out.moment[organs + t][n].setZero();
    }
  }
  for (const auto& fat : model.fat()) {
    std::vector<double> mass;
    fat->solid().massOf(fat->restFill(), mass);
    for (const double m : mass) out.weight += m * gravity;
  }
  return out;
}

}  // namespace calot::test
