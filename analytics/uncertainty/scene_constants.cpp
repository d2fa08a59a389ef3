// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/uncertainty/scene_constants.h"

#include <fmt/format.h>

#include <algorithm>

namespace calot::analytics {
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
