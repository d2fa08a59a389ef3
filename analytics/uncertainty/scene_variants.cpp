// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/uncertainty/scene_variants.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

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

namespace {

/// One of an organ.
SceneConstant ofOrgan(const std::string& organ, const std::string& name,
                      const std::function<double&(OrganDescription&)>& of) {
  return {fmt::format("organs.{}.{}", organ, name), [organ, of](SceneDescription& scene, double factor) {
            const auto found =
                std::find_if(scene.organs.begin(), scene.organs.end(), [&](const auto& o) { return o.name == organ; });
            if (found == scene.organs.end() || of(*found) == 0.0) return false;
            of(*found) *= factor;
            return true;
          }};
}

/// One of every element of a list.
template <class Part>
SceneConstant ofEach(const std::string& name, std::vector<Part> SceneDescription::*list,
                     const std::function<double&(Part&)>& of) {
  return {name, [list, of](SceneDescription& scene, double factor) {
            for (Part& part : scene.*list) of(part) *= factor;
            return !(scene.*list).empty();
          }};
}

SceneConstant ofHands(const std::string& name, double HandDescription::*member) {
  return {"hands.*." + name, [member](SceneDescription& scene, double factor) {
            for (HandDescription& hand : scene.hands) hand.*member *= factor;
            return true;
          }};
}

SceneConstant ofCautery(const std::string& name, double CauteryDescription::*member) {
  return {"cautery." + name, [member](SceneDescription& scene, double factor) {
            scene.cautery.*member *= factor;
            return true;
          }};
}

void addOrgans(std::vector<SceneConstant>& all) {
  using Organ = OrganDescription;
  for (const char* organ : {"liver", "gallbladder"}) {
    all.push_back(ofOrgan(organ, "material.youngModulus", [](Organ& o) -> double& { return o.material.youngModulus; }));
    all.push_back(
        ofOrgan(organ, "material.stiffnessDamping", [](Organ& o) -> double& { return o.material.stiffnessDamping; }));
    all.push_back(ofOrgan(organ, "material.density", [](Organ& o) -> double& { return o.material.density; }));
    all.push_back(ofOrgan(organ, "friction", [](Organ& o) -> double& { return o.friction; }));
    all.push_back(ofOrgan(organ, "burnThrough", [](Organ& o) -> double& { return o.burnThrough; }));
  }
  // Times 0.5 - nu, which compressibility goes with: nu itself may not reach one half.
  all.push_back({"organs.*.material.poissonRatio (0.5 - nu)", [](SceneDescription& scene, double factor) {
                   for (Organ& organ : scene.organs) {
                     organ.material.poissonRatio = 0.5 - factor * (0.5 - organ.material.poissonRatio);
                   }
                   return true;
                 }});
}

void addBed(std::vector<SceneConstant>& all) {
  using Bed = ConnectiveDescription;
  const auto list = &SceneDescription::connective;
  all.push_back(ofEach<Bed>("connective.*.stiffness", list, [](Bed& b) -> double& { return b.stiffness; }));
  all.push_back(ofEach<Bed>("connective.*.damping", list, [](Bed& b) -> double& { return b.damping; }));
  // With the share of the fracture's energy that is stored when it begins, sigma^2 / (2 k G_c), as it was.
  all.push_back({"connective.*.strength", [](SceneDescription& scene, double factor) {
                   for (Bed& bed : scene.connective) {
                     bed.strength *= factor;
                     bed.fractureEnergy *= factor * factor;
                   }
                   return !scene.connective.empty();
                 }});
  all.push_back(ofEach<Bed>("connective.*.fadeTime", list, [](Bed& b) -> double& { return b.fadeTime; }));
}

void addVesselsAndFat(std::vector<SceneConstant>& all) {
  using Vessel = VesselDescription;
  using Fat = FatDescription;
  const auto vessels = &SceneDescription::vessels;
  all.push_back(ofEach<Vessel>("vessels.*.material.youngModulus", vessels,
                               [](Vessel& v) -> double& { return v.material.youngModulus; }));
  all.push_back(ofEach<Vessel>("vessels.*.wall", vessels, [](Vessel& v) -> double& { return v.wall; }));
  all.push_back(
      ofEach<Vessel>("vessels.*.ultimateStrain", vessels, [](Vessel& v) -> double& { return v.ultimateStrain; }));
  all.push_back(ofEach<Vessel>("vessels.*.burnThrough", vessels, [](Vessel& v) -> double& { return v.burnThrough; }));
  all.push_back(ofEach<Vessel>("vessels.*.friction", vessels, [](Vessel& v) -> double& { return v.friction; }));
  all.push_back(ofEach<Fat>("fat.*.material.youngModulus", &SceneDescription::fat,
                            [](Fat& f) -> double& { return f.material.youngModulus; }));
  all.push_back(ofEach<Fat>("fat.*.friction", &SceneDescription::fat, [](Fat& f) -> double& { return f.friction; }));
  all.push_back({"fat.*.attachments.*.stiffness", [](SceneDescription& scene, double factor) {
                   for (Fat& fat : scene.fat) {
                     for (FatAttachmentDescription& attachment : fat.attachments) attachment.stiffness *= factor;
                   }
                   return !scene.fat.empty();
                 }});
}

std::vector<SceneConstant> listed() {
  std::vector<SceneConstant> all;
  addOrgans(all);
  addBed(all);
  addVesselsAndFat(all);
  all.push_back(ofEach<RetractionDescription>("retraction.*.stiffness", &SceneDescription::retraction,
                                              [](RetractionDescription& r) -> double& { return r.stiffness; }));
  all.push_back(ofHands("couplingStiffness", &HandDescription::couplingStiffness));
  all.push_back(ofHands("slipForce", &HandDescription::slipForce));
  all.push_back(ofHands("tearForce", &HandDescription::tearForce));
  all.push_back(ofCautery("power", &CauteryDescription::power));
  all.push_back(ofCautery("reach", &CauteryDescription::reach));
  all.push_back(ofCautery("recession", &CauteryDescription::recession));
  all.push_back(ofCautery("coagulationPace", &CauteryDescription::coagulationPace));
  all.push_back(ofCautery("cutChar", &CauteryDescription::cutChar));
  all.push_back(ofCautery("spot", &CauteryDescription::spot));
  all.push_back(ofCautery("charTime", &CauteryDescription::charTime));
  return all;
}

}  // namespace

const std::vector<SceneConstant>& sceneConstants() {
  static const std::vector<SceneConstant> all = listed();
  return all;
}

const SceneConstant* findSceneConstant(std::string_view name) {
  const std::vector<SceneConstant>& all = sceneConstants();
  const auto found = std::find_if(all.begin(), all.end(), [&](const SceneConstant& c) { return c.name == name; });
  return found == all.end() ? nullptr : &*found;
}

}  // namespace calot::analytics
