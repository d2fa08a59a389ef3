// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/tissue/connective/connective_kind.h"

#include <utility>

#include "sim/connective/connective_tissue.h"
#include "sim/scene/model.h"
#include "sim/scene/scene_view.h"
#include "sim/scene/state.h"
#include "sim/tissue/structure.h"

namespace calot {

std::vector<Field> ConnectiveDescription::fields() {
  using S = ConnectiveDescription;
  return {
      object("connective",
             "Fibrous strands over the bed of the first organ on the second: they pull, tear, and burn under the "
             "energised hook"),
      {"name", at<S, &S::name>, sceneName, "Name in tables and events"},
      roleField(at<S, &S::role>, {StructureRole::cysticPlate}),
      {"first", at<S, &S::first>, sceneName, "Organ whose surface the bed is part of"},
      {"second", at<S, &S::second>, sceneName, "Organ that it lies on"},
      {"reach", at<S, &S::reach>, "m", above(0, 0.05),
       "Triangles of the first organ no farther from the second are the bed"},
      {"strands", at<S, &S::strands>, "", within(1, 20000), "Least number of strands"},
      optional("stiffness", at<S, &S::stiffness>, "N/m^3", above(0, 1e10), "Stiffness of a unit area of bed"),
      optional("damping", at<S, &S::damping>, "N s/m^3", within(0, 1e8), "Damping of a unit area of bed"),
      optional("strength", at<S, &S::strength>, "Pa", above(0, 1e9), "Largest traction, beyond which it softens"),
      optional("fractureEnergy", at<S, &S::fractureEnergy>, "J/m^2", above(0, 1e9),
               "Energy that tearing a unit area of bed takes, at least strength^2 / (2 stiffness)"),
      optional("fadeTime", at<S, &S::fadeTime>, "s", above(0, 100),
               "Time in which the energised hook burns a strand through"),
  };
}

Field ConnectiveKind::sceneKey() {
  return optional("connective", at<SceneDescription, &SceneDescription::connective>, "Connective tissue between organs")
      .items(0, 16);
}

namespace {

/// @return its fault, or nothing
std::string addConnective(const SceneDescription& scene, const ConnectiveDescription& description, Model& model) {
  const std::vector<OrganModel>& organs = model.organs();
  const std::string what = "connective tissue '" + description.name + "': ";
  const std::size_t a = indexNamed(organs, description.first);
  const std::size_t b = indexNamed(organs, description.second);
  for (const auto& [organ, name] : {std::pair{a, description.first}, std::pair{b, description.second}}) {
    if (organ == organs.size()) return what + "the scene has no organ '" + name + "'";
  }
  if (a == b) return what + "joins organ '" + description.first + "' to itself";
  if (std::string fault = cohesiveFault(description); !fault.empty()) return what + fault;
  ConnectiveMaterial material;
  material.stiffness = description.stiffness;
  material.damping = description.damping;
  material.strength = description.strength;
  material.fractureEnergy = description.fractureEnergy;
  material.fadeTime = description.fadeTime;
  const auto meshOf = [&](std::size_t o) {
    return TetrahedralMesh{organs[o].solid.rest(), organs[o].solid.tetrahedra()};
  };
  const TriangleMesh skinA = scene.organs[a].surface.mesh();
  const TriangleMesh skinB = scene.organs[b].surface.mesh();
  const TetrahedralMesh meshA = meshOf(a);
  const TetrahedralMesh meshB = meshOf(b);
  ConnectiveBed bed = makeBed({skinA, meshA}, {skinB, meshB}, description.reach, description.strands);
  if (!bed.ok()) return what + bed.error;
  model.connectiveModel.push_back(
      {description.name, a, b, ConnectiveTissue(std::move(bed.strands), std::move(bed.sheets), material), {}});
  return {};
}

class ConnectiveViewer final : public TissueViewer {
 public:
  explicit ConnectiveViewer(const Model& model) : model_(model) {}

  void addTo(SceneView& view, const State& state) override {
    for (std::size_t c = 0; c < model_.connective().size(); ++c) {
      const ConnectiveModel& tie = model_.connective()[c];
      const ConnectiveState& tissue = state.connective[c];
      ConnectiveView& connective = view.connective.emplace_back();
      connective.name = tie.name;
      connective.condition = tissue.condition;
      connective.sheet = tie.tissue.sheets();
      for (const Strand& strand : tie.tissue.strands()) {
        connective.strand.push_back(
            {strand.a.of(state.organ[tie.a].position), strand.b.of(state.organ[tie.b].position)});
      }
      for (const double alpha : tissue.alpha) connective.alpha.push_back(static_cast<float>(alpha));
    }
  }

 private:
  const Model& model_;
};

}  // namespace

std::string cohesiveFault(const ConnectiveDescription& description) {
  const CohesiveLaw law{description.stiffness, description.strength, description.fractureEnergy};
  if (law.fractureEnergy >= law.minFractureEnergy()) return {};
  return "fractureEnergy " + std::to_string(law.fractureEnergy) +
         " J/m^2 is below strength^2 / (2 stiffness) = " + std::to_string(law.minFractureEnergy()) +
         " J/m^2, which is stored before it softens";
}

std::string ConnectiveKind::build(const SceneDescription& scene, Model& model) {
  for (const ConnectiveDescription& description : scene.connective) {
    if (std::string fault = addConnective(scene, description, model); !fault.empty()) return fault;
  }
  return {};
}

const std::string& ConnectiveKind::nameOf(const Model& model, std::size_t index) {
  return model.connective()[index].name;
}

void ConnectiveKind::start(const Model& model, States& states) {
  for (const ConnectiveModel& connective : model.connective())
    states.connective.push_back(intactState(connective.tissue));
}

bool ConnectiveKind::fits(const Model& model, const States& states) {
  for (std::size_t c = 0; c < states.connective.size(); ++c) {
    const ConnectiveState& connective = states.connective[c];
    const std::size_t strands = model.connective()[c].tissue.strands().size();
    if (connective.condition.size() != strands || connective.alpha.size() != strands) return false;
    if (connective.damage.size() != strands) return false;
    for (std::size_t s = 0; s < strands; ++s) {
      if (connective.condition[s] > StrandCondition::torn) return false;
      if (!(connective.alpha[s] >= 0.0) || connective.alpha[s] > 1.0) return false;
      if (!(connective.damage[s] >= 0.0) || connective.damage[s] > 1.0) return false;
    }
  }
  return true;
}

void ConnectiveKind::resize(const Model& model, Results& results) {
  results.connective.resize(model.connective().size());
}

std::unique_ptr<TissueViewer> ConnectiveKind::makeViewer(const Model& model) {
  return std::make_unique<ConnectiveViewer>(model);
}

}  // namespace calot
