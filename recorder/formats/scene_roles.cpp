// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/formats/scene_roles.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "recorder/formats/scene_names.h"
#include "recorder/formats/scene_rules.h"

namespace calot::recorder {
namespace {

StructureRole roleOfOrgan(const OrganDescription& organ) {
  if (organ.appearance == "liver") return StructureRole::liver;
  if (organ.appearance == "gallbladder") return StructureRole::gallbladder;
  return StructureRole::other;
}

StructureRole roleOfVessel(const VesselDescription& vessel, bool entersGallbladder) {
  const bool duct = vessel.appearance == "duct";
  if (entersGallbladder) return duct ? StructureRole::cysticDuct : StructureRole::cysticArtery;
  if (duct) return StructureRole::bileDuct;
  return vessel.appearance == "artery" ? StructureRole::artery : StructureRole::other;
}

}  // namespace

StructureRole readRole(const JsonObject& object, std::initializer_list<StructureRole> allowed) {
  if (!object.has("role")) return StructureRole::other;
  std::map<std::string, StructureRole> words{{nameOf(StructureRole::other), StructureRole::other}};
  for (const StructureRole role : allowed) words.emplace(nameOf(role), role);
  return readWord(object, "role", words);
}

bool statesRoles(const JsonObject& root) {
  constexpr std::pair<const char*, const char*> lists[] = {
      {"organs", "organ"}, {"connective", "connective"}, {"vessels", "vessel"}, {"fat", "fat"}};
  return std::any_of(std::begin(lists), std::end(lists), [&](const auto& list) {
    if (!root.has(list.first)) return false;
    const std::vector<JsonPlace> items = root.at(list.first).list(0, std::numeric_limits<std::size_t>::max());
    return std::any_of(items.begin(), items.end(),
                       [&](const JsonPlace& item) { return item.object(sceneRule(list.second)).has("role"); });
  });
}

void deriveRoles(SceneDescription& scene) {
  const auto isGallbladder = [&](const std::string& name) {
    return std::any_of(scene.organs.begin(), scene.organs.end(), [&](const OrganDescription& organ) {
      return organ.name == name && organ.role == StructureRole::gallbladder;
    });
  };
  const auto entersGallbladder = [&](const VesselEndDescription& end) {
    return end.kind == VesselEndDescription::Kind::organ && isGallbladder(end.to);
  };
  for (OrganDescription& organ : scene.organs) organ.role = roleOfOrgan(organ);
  for (ConnectiveDescription& tissue : scene.connective) {
    const bool bed = isGallbladder(tissue.first) || isGallbladder(tissue.second);
    tissue.role = bed ? StructureRole::cysticPlate : StructureRole::other;
  }
  for (VesselDescription& vessel : scene.vessels) {
    vessel.role = roleOfVessel(vessel, entersGallbladder(vessel.start) || entersGallbladder(vessel.end));
  }
  for (FatDescription& fat : scene.fat) fat.role = StructureRole::triangleFat;
}

}  // namespace calot::recorder
