// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/formats/scene_vessels.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "recorder/formats/scene_names.h"
#include "recorder/formats/scene_roles.h"
#include "recorder/formats/scene_rules.h"
#include "recorder/formats/scene_surface.h"
#include "sim/geometry/closest_point.h"

namespace calot::recorder {
namespace {

using Kind = VesselEndDescription::Kind;

constexpr std::size_t maxPoints = 1000;
constexpr double minStep = 1e-4;  ///< between neighbouring points (m)
constexpr double maxEnd = 0.005;  ///< of an end from what it is grown to (m)

template <class Named>
const Named* find(const std::vector<Named>& all, const std::string& name) {
  const auto found = std::find_if(all.begin(), all.end(), [&](const Named& one) { return one.name == name; });
  return found == all.end() ? nullptr : &*found;
}

std::vector<Vec3> readPath(const JsonPlace& place) {
  static const KeyRule bounds = sceneCoordinate();
  std::vector<Vec3> path;
  for (const JsonPlace& item : place.list(2, maxPoints)) {
    const Vec3 point = item.vector(bounds);
    if (!path.empty() && !((point - path.back()).norm() >= minStep)) {
      item.fail(fmt::format("nearer than {} m to the point before", minStep));
    }
    if (path.size() > 1 && !((point - path.back()).dot(path.back() - path[path.size() - 2]) > 0.0)) {
      item.fail("the path turns by 90 degrees or more at the point before");
    }
    path.push_back(point);
  }
  return path;
}

double distanceTo(const OrganDescription& organ, const Vec3& p) {
  double nearest = 1e300;
  const auto& v = organ.surface.vertex;
  for (const Index3& t : organ.surface.triangle) {
    nearest = std::min(nearest, closestOnTriangle(p, v[slot(t[0])], v[slot(t[1])], v[slot(t[2])]).squaredDistance);
  }
  return std::sqrt(nearest);
}

double distanceTo(const VesselDescription& vessel, const Vec3& p) {
  double nearest = 1e300;
  for (std::size_t i = 1; i < vessel.path.size(); ++i) {
    const Vec3& a = vessel.path[i - 1];
    const Vec3 along = vessel.path[i] - a;
    nearest = std::min(nearest, (p - a - closestOnSegment(p, a, vessel.path[i]) * along).norm());
  }
  return nearest;
}

VesselEndDescription readEnd(const JsonPlace& place, const Vec3& point, bool isStart,
                             const std::vector<OrganDescription>& organs,
                             const std::vector<VesselDescription>& earlier) {
  const JsonObject object = place.object(sceneRule("vesselEnd"));
  VesselEndDescription end;
  end.kind = readWord<Kind>(
      object, "kind", {{"free", Kind::free}, {"fixed", Kind::fixed}, {"organ", Kind::organ}, {"vessel", Kind::vessel}});
  if (end.kind == Kind::free || end.kind == Kind::fixed) {
    if (object.has("to")) object.at("to").fail("a free or a fixed end is grown to nothing");
    return end;
  }
  if (!object.has("to")) object.fail("the key \"to\" is missing");
  end.to = readName(object, "to");
  double distance = 0.0;
  if (end.kind == Kind::organ) {
    const OrganDescription* organ = find(organs, end.to);
    if (organ == nullptr) object.at("to").fail("the scene has no organ of this name");
    distance = distanceTo(*organ, point);
  } else {
    if (!isStart) object.at("kind").fail("only a start grows out of a vessel");
    const VesselDescription* vessel = find(earlier, end.to);
    if (vessel == nullptr) object.at("to").fail("no earlier vessel of the scene has this name");
    distance = distanceTo(*vessel, point);
  }
  if (!(distance <= maxEnd)) {
    object.at("to").fail(fmt::format("it lies {:.3g} m away; at most {} m is allowed", distance, maxEnd));
  }
  return end;
}

}  // namespace

std::vector<VesselDescription> readVessels(const JsonPlace& place, const std::vector<OrganDescription>& organs) {
  std::vector<VesselDescription> vessels;
  for (const JsonPlace& item : place.list(0, maxStructures)) {
    const JsonObject object = item.object(sceneRule("vessel"));
    VesselDescription vessel;
    vessel.name = readName(object, "name");
    if (find(organs, vessel.name) != nullptr) object.at("name").fail("an organ has this name");
    if (find(vessels, vessel.name) != nullptr) object.at("name").fail("another vessel has this name");
    vessel.appearance = readName(object, "appearance");
    vessel.role = readRole(object, {StructureRole::cysticDuct, StructureRole::cysticArtery, StructureRole::bileDuct,
                                    StructureRole::artery});
    vessel.path = readPath(object.at("path"));
    object.read("elements", vessel.elements);
    object.read("radius", vessel.radius);
    object.read("wall", vessel.wall);
    if (!(vessel.wall < vessel.radius)) object.at("wall").fail("not thinner than the radius");
    vessel.material = readMaterial(object.at("material"));
    object.read("ultimateStrain", vessel.ultimateStrain);
    object.read("burnThrough", vessel.burnThrough);
    object.read("friction", vessel.friction);
    vessel.start = readEnd(object.at("start"), vessel.path.front(), true, organs, vessels);
    vessel.end = readEnd(object.at("end"), vessel.path.back(), false, organs, vessels);
    vessels.push_back(std::move(vessel));
  }
  return vessels;
}

}  // namespace calot::recorder
