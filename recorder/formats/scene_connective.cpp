// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/formats/scene_connective.h"

#include <algorithm>

#include "recorder/formats/scene_names.h"
#include "recorder/formats/scene_roles.h"
#include "recorder/formats/scene_rules.h"

namespace calot::recorder {

namespace {

constexpr std::size_t maxTissues = 16;

}  // namespace

std::vector<ConnectiveDescription> readConnective(const JsonPlace& place, const std::vector<OrganDescription>& organs) {
  std::vector<ConnectiveDescription> tissues;
  for (const JsonPlace& item : place.list(0, maxTissues)) {
    const JsonObject object = item.object(sceneRule("connective"));
    ConnectiveDescription tissue;
    tissue.name = readName(object, "name");
    const bool known = std::any_of(tissues.begin(), tissues.end(),
                                   [&](const ConnectiveDescription& other) { return other.name == tissue.name; });
    if (known) object.at("name").fail("a second connective tissue of this name");
    const auto organ = [&](const char* key) {
      std::string name = readName(object, key);
      const bool found =
          std::any_of(organs.begin(), organs.end(), [&](const OrganDescription& o) { return o.name == name; });
      if (!found) object.at(key).fail("the scene has no organ of this name");
      return name;
    };
    tissue.first = organ("first");
    tissue.second = organ("second");
    if (tissue.first == tissue.second) object.at("second").fail("joins an organ to itself");
    tissue.role = readRole(object, {StructureRole::cysticPlate});
    const bool onGallbladder = std::any_of(organs.begin(), organs.end(), [&](const OrganDescription& o) {
      return o.role == StructureRole::gallbladder && (o.name == tissue.first || o.name == tissue.second);
    });
    if (tissue.role == StructureRole::cysticPlate && !onGallbladder) {
      object.at("role").fail("neither organ that it joins has the role gallbladder");
    }
    object.read("reach", tissue.reach);
    object.read("strands", tissue.strands);
    object.read("stiffness", tissue.stiffness);
    object.read("damping", tissue.damping);
    object.read("strength", tissue.strength);
    object.read("fractureEnergy", tissue.fractureEnergy);
    if (const std::string fault = cohesiveFault(tissue); !fault.empty()) object.fail(fault);
    object.read("fadeTime", tissue.fadeTime);
    tissues.push_back(tissue);
  }
  return tissues;
}

}  // namespace calot::recorder
