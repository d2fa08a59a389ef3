// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/formats/scene_organs.h"

#include <algorithm>

#include "recorder/base/json_faults.h"
#include "recorder/formats/scene_names.h"
#include "recorder/formats/scene_roles.h"
#include "recorder/formats/scene_rules.h"

namespace calot::recorder {

namespace {

constexpr std::size_t maxAnchors = 64;

AnchorDescription readAnchor(const JsonPlace& place) {
  const JsonObject object = place.object(sceneRule("anchor"));
  AnchorDescription anchor;
  if (object.has("sphere") == object.has("nearOrgan")) place.fail("one of \"sphere\" and \"nearOrgan\" is wanted");
  if (object.has("sphere")) {
    const JsonObject sphere = object.at("sphere").object(sceneRule("sphere"));
    sphere.read("centre", anchor.centre);
    sphere.read("radius", anchor.radius);
  } else {
    const JsonObject near = object.at("nearOrgan").object(sceneRule("nearOrgan"));
    anchor.nearOrgan = readName(near, "organ");
    near.read("distance", anchor.distance);
  }
  return anchor;
}

}  // namespace

OrganDescription readOrgan(const JsonPlace& place, const FetchAsset& fetch) {
  const JsonObject object = place.object(sceneRule("organ"));
  OrganDescription organ;
  JsonFaults::part([&] { organ.name = readName(object, "name"); });
  JsonFaults::part([&] { organ.appearance = readName(object, "appearance"); });
  JsonFaults::part([&] { organ.role = readRole(object, {StructureRole::liver, StructureRole::gallbladder}); });
  object.read("tetrahedra", organ.tetrahedra);
  object.read("friction", organ.friction);
  object.read("burnThrough", organ.burnThrough);
  JsonFaults::part([&] { organ.material = readMaterial(object.at("material")); });
  JsonFaults::part([&] {
    for (const JsonPlace& anchor : object.at("anchors").list(0, maxAnchors))
      JsonFaults::part([&] { organ.anchors.push_back(readAnchor(anchor)); });
  });
  JsonFaults::part([&] { organ.surface = closedSurface(readMesh(object.at("mesh"), fetch), "an organ"); });
  return organ;
}

void checkOrgans(const JsonPlace& place, const std::vector<OrganDescription>& organs) {
  const auto index = [&](const std::string& name) {
    const auto found =
        std::find_if(organs.begin(), organs.end(), [&](const OrganDescription& o) { return o.name == name; });
    return static_cast<std::size_t>(found - organs.begin());
  };
  const std::vector<JsonPlace> places = place.list(1, maxStructures);
  for (std::size_t i = 0; i < organs.size(); ++i) {
    const JsonObject object = places[i].object(sceneRule("organ"));
    if (index(organs[i].name) != i) object.at("name").fail("another organ has this name");
    const std::vector<JsonPlace> anchors = object.at("anchors").list(0, maxAnchors);
    for (std::size_t a = 0; a < anchors.size(); ++a) {
      const std::string& near = organs[i].anchors[a].nearOrgan;
      if (near.empty()) continue;
      const JsonPlace name =
          anchors[a].object(sceneRule("anchor")).at("nearOrgan").object(sceneRule("nearOrgan")).at("organ");
      if (index(near) == organs.size()) name.fail("the scene has no organ \"" + near + "\"");
      if (index(near) == i) name.fail("an organ cannot be anchored to itself");
    }
  }
}

}  // namespace calot::recorder
