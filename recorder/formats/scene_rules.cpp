// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/formats/scene_assets.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "recorder/base/json_reader.h"
#include "sim/geometry/brick_lattice.h"
#include "sim/geometry/closest_point.h"

namespace calot::recorder {
namespace {

using EndKind = VesselEndDescription::Kind;

constexpr double minStep = 1e-4;                             ///< between neighbouring points of a path (m)
constexpr double maxEnd = 0.005;                             ///< of a vessel's end from what it is grown to (m)
constexpr double minCells = 4.0;                             ///< of fat, along a side of its box
constexpr double maxCells = 16e6;                            ///< of fat, in its box
constexpr double sideCells = BrickLattice::maxNodes - 16.0;  ///< along a side, with room for a margin

template <class Named>
const Named* find(const std::vector<Named>& all, const std::string& name) {
  const auto found = std::find_if(all.begin(), all.end(), [&](const Named& one) { return one.name == name; });
  return found == all.end() ? nullptr : &*found;
}

/// Does an earlier object have the same value of this member?
template <class Object>
bool isRepeated(const std::vector<Object>& all, std::size_t i, std::string Object::*member) {
  return std::any_of(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(i),
                     [&](const Object& other) { return other.*member == all[i].*member; });
}

template <class Named>
void checkKnown(const JsonPlace& place, const std::vector<Named>& all, const std::string& name, const char* what) {
  if (find(all, name) == nullptr) place.fail(fmt::format("the scene has no {} of this name", what));
}

void checkWorkspace(const JsonPlace& workspace, const SceneDescription& scene) {
  if (!((scene.workspace[1] - scene.workspace[0]).array() >= 0.01).all())
    workspace.at("upper").fail("every side of the workspace must be at least 0.01 m long");
}

// Camera frame C: x right, y down, z along the view.
void orientCamera(const JsonPlace& place, CameraSample& camera) {
  const Vec3 up = place.has("up") ? place.at("up").vector(within(-1, 1)) : Vec3::UnitY();
  const Vec3 view = place.at("target").vector(within(-1, 1)) - camera.position;
  if (!(view.norm() > 0.001)) place.at("target").fail("the target is the camera's own position");
  const Vec3 forward = view / view.norm();
  const Vec3 across = forward.cross(up);
  if (!(across.norm() > 0.01 * up.norm()) || !(up.norm() > 0.01)) place.fail("\"up\" is zero or along the view");
  Mat3 axes;
  axes.col(0) = across / across.norm();
  axes.col(1) = forward.cross(axes.col(0));
  axes.col(2) = forward;
  camera.orientation = Quat(axes).normalized();
}

void checkHand(const JsonPlace& place, const HandDescription& hand, const std::array<Vec3, 2>& workspace) {
  if ((hand.home.array() < workspace[0].array()).any() || (hand.home.array() > workspace[1].array()).any())
    place.at("home").fail("outside the workspace");
  if (!((hand.home - hand.port).norm() >= 0.01)) place.at("home").fail("nearer than 0.01 m to the port");
  const Vec3 nearest = hand.port.cwiseMax(workspace[0]).cwiseMin(workspace[1]);
  if (!((hand.port - nearest).norm() <= 0.3)) place.at("port").fail("farther than 0.3 m from the workspace");
}

void checkAnchors(const JsonPlace& organs, const SceneDescription& scene) {
  for (std::size_t i = 0; i < scene.organs.size(); ++i) {
    const OrganDescription& organ = scene.organs[i];
    for (std::size_t a = 0; a < organ.anchors.size(); ++a) {
      const JsonPlace place = organs.at(i).at("anchors").at(a);
      if (place.has("sphere") == place.has("nearOrgan"))
        JsonFaults::part([&] { place.fail("one of \"sphere\" and \"nearOrgan\" is expected"); });
    }
  }
}

void checkOrgans(const JsonPlace& organs, const SceneDescription& scene) {
  for (std::size_t i = 0; i < scene.organs.size(); ++i) {
    const OrganDescription& organ = scene.organs[i];
    if (isRepeated(scene.organs, i, &OrganDescription::name))
      organs.at(i).at("name").fail("another organ has this name");
    for (std::size_t a = 0; a < organ.anchors.size(); ++a) {
      const std::string& near = organ.anchors[a].nearOrgan;
      if (near.empty()) continue;
      const JsonPlace name = organs.at(i).at("anchors").at(a).at("nearOrgan").at("organ");
      if (find(scene.organs, near) == nullptr) name.fail("the scene has no organ \"" + near + "\"");
      if (near == organ.name) name.fail("an organ cannot be anchored to itself");
    }
  }
}

void checkConnective(const JsonPlace& place, const ConnectiveDescription& tissue, const SceneDescription& scene) {
  checkKnown(place.at("first"), scene.organs, tissue.first, "organ");
  checkKnown(place.at("second"), scene.organs, tissue.second, "organ");
  if (tissue.first == tissue.second) place.at("second").fail("joins an organ to itself");
  const bool onGallbladder = std::any_of(scene.organs.begin(), scene.organs.end(), [&](const OrganDescription& o) {
    return o.role == StructureRole::gallbladder && (o.name == tissue.first || o.name == tissue.second);
  });
  if (tissue.role == StructureRole::cysticPlate && !onGallbladder)
    place.at("role").fail("neither organ that it joins has the role gallbladder");
  if (const std::string fault = cohesiveFault(tissue); !fault.empty()) place.fail(fault);
}

void checkPath(const JsonPlace& place, const std::vector<Vec3>& path) {
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Vec3 step = path[i] - path[i - 1];
    if (!(step.norm() >= minStep)) place.at(i).fail(fmt::format("nearer than {} m to the point before", minStep));
    if (i > 1 && !(step.dot(path[i - 1] - path[i - 2]) > 0.0))
      place.at(i).fail("the path turns by 90 degrees or more at the point before");
  }
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

/// @param earlier vessels before that of this end
void checkEnd(const JsonPlace& place, const VesselEndDescription& end, const Vec3& point, bool isStart,
              const SceneDescription& scene, std::size_t earlier) {
  if (end.kind == EndKind::free || end.kind == EndKind::fixed) {
    if (place.has("to")) place.at("to").fail("a free or a fixed end is grown to nothing");
    return;
  }
  const JsonPlace to = place.at("to");
  double distance = 0.0;
  if (end.kind == EndKind::organ) {
    const OrganDescription* organ = find(scene.organs, end.to);
    if (organ == nullptr) to.fail("the scene has no organ of this name");
    distance = distanceTo(*organ, point);
  } else {
    if (!isStart) place.at("kind").fail("only a start grows out of a vessel");
    const VesselDescription* vessel = find(scene.vessels, end.to);
    if (vessel == nullptr || vessel >= scene.vessels.data() + earlier)
      to.fail("no earlier vessel of the scene has this name");
    distance = distanceTo(*vessel, point);
  }
  if (!(distance <= maxEnd)) to.fail(fmt::format("it lies {:.3g} m away; at most {} m is allowed", distance, maxEnd));
}

void checkVessel(const JsonPlace& place, const SceneDescription& scene, std::size_t i) {
  const VesselDescription& vessel = scene.vessels[i];
  if (find(scene.organs, vessel.name) != nullptr) place.at("name").fail("an organ has this name");
  if (isRepeated(scene.vessels, i, &VesselDescription::name)) place.at("name").fail("another vessel has this name");
  checkPath(place.at("path"), vessel.path);
  if (!(vessel.wall < vessel.radius)) place.at("wall").fail("not thinner than the radius");
  checkEnd(place.at("start"), vessel.start, vessel.path.front(), true, scene, i);
  checkEnd(place.at("end"), vessel.end, vessel.path.back(), false, scene, i);
}

void checkFat(const JsonPlace& place, const SceneDescription& scene, std::size_t i) {
  const FatDescription& fat = scene.fat[i];
  if (find(scene.organs, fat.name) != nullptr) place.at("name").fail("an organ has this name");
  if (find(scene.vessels, fat.name) != nullptr) place.at("name").fail("a vessel has this name");
  if (isRepeated(scene.fat, i, &FatDescription::name)) place.at("name").fail("other fat has this name");
  for (std::size_t a = 0; a < fat.attachments.size(); ++a) {
    const JsonPlace one = place.at("attachments").at(a);
    const std::string& to = fat.attachments[a].to;
    if (find(scene.organs, to) == nullptr && find(scene.vessels, to) == nullptr)
      one.at("to").fail("the scene has no organ and no vessel of this name");
    if (isRepeated(fat.attachments, a, &FatAttachmentDescription::to))
      one.fail("a second attachment to \"" + to + "\"");
  }
  const Vec3 normal = (fat.triangle[1] - fat.triangle[0]).cross(fat.triangle[2] - fat.triangle[0]);
  if (place.has("triangle") && !(normal.norm() >= 1e-6))
    place.at("triangle").at("corners").fail("its corners lie on a line, or nearly");
  if (fat.surface.vertex.empty()) return;
  const Box box = bounds(fat.surface.mesh());
  const Vec3 cells = (box.upper - box.lower) / fat.cellSize;
  if (cells.minCoeff() >= minCells && cells.maxCoeff() <= sideCells && cells.prod() <= maxCells) return;
  place.at("cellSize")
      .fail(fmt::format("the surface's box has {:.0f} x {:.0f} x {:.0f} cells of this size; from {} to {} along each "
                        "side and at most {:.0f} in all are allowed",
                        cells[0], cells[1], cells[2], minCells, sideCells, maxCells));
}

void checkProcedure(const JsonPlace& place, const SceneDescription& scene) {
  const ProcedureDescription& procedure = scene.procedure;
  checkKnown(place.at("specimen"), scene.organs, procedure.specimen, "organ");
  if (place.has("bed")) {
    checkKnown(place.at("bed"), scene.connective, procedure.bed, "connective tissue");
    const ConnectiveDescription& bed = *find(scene.connective, procedure.bed);
    if (bed.first != procedure.specimen && bed.second != procedure.specimen)
      place.at("bed").fail("does not hold the specimen");
  }
  if (place.has("fat")) checkKnown(place.at("fat"), scene.fat, procedure.fat, "fat");
  for (std::size_t i = 0; i < procedure.divide.size(); ++i) {
    const JsonPlace vessel = place.at("divide").at(i).at("vessel");
    checkKnown(vessel, scene.vessels, procedure.divide[i].vessel, "vessel");
    if (isRepeated(procedure.divide, i, &DivideDescription::vessel)) vessel.fail("is named a second time");
  }
  for (std::size_t i = 0; i < procedure.spare.size(); ++i) {
    const JsonPlace vessel = place.at("spare").at(i);
    checkKnown(vessel, scene.vessels, procedure.spare[i], "vessel");
    if (std::any_of(procedure.divide.begin(), procedure.divide.end(),
                    [&](const DivideDescription& d) { return d.vessel == procedure.spare[i]; }))
      vessel.fail("this vessel is to be divided");
  }
}

bool statesRoles(const JsonPlace& root) {
  const char* const lists[] = {"organs", "connective", "vessels", "fat"};
  return std::any_of(std::begin(lists), std::end(lists), [&](const char* list) {
    if (!root.has(list)) return false;
    const std::vector<JsonPlace> items = root.at(list).list(0, maxStructures);
    return std::any_of(items.begin(), items.end(), [](const JsonPlace& item) { return item.has("role"); });
  });
}

StructureRole roleOfVessel(const VesselDescription& vessel, bool entersGallbladder) {
  const bool duct = vessel.appearance == "duct";
  if (entersGallbladder) return duct ? StructureRole::cysticDuct : StructureRole::cysticArtery;
  if (duct) return StructureRole::bileDuct;
  return vessel.appearance == "artery" ? StructureRole::artery : StructureRole::other;
}

}  // namespace

void deriveRoles(SceneDescription& scene) {
  for (OrganDescription& organ : scene.organs) {
    organ.role = organ.appearance == "liver"         ? StructureRole::liver
                 : organ.appearance == "gallbladder" ? StructureRole::gallbladder
                                                     : StructureRole::other;
  }
  const auto isGallbladder = [&](const std::string& name) {
    const OrganDescription* organ = find(scene.organs, name);
    return organ != nullptr && organ->role == StructureRole::gallbladder;
  };
  const auto entersGallbladder = [&](const VesselEndDescription& end) {
    return end.kind == EndKind::organ && isGallbladder(end.to);
  };
  for (ConnectiveDescription& tissue : scene.connective) {
    const bool bed = isGallbladder(tissue.first) || isGallbladder(tissue.second);
    tissue.role = bed ? StructureRole::cysticPlate : StructureRole::other;
  }
  for (VesselDescription& vessel : scene.vessels) {
    vessel.role = roleOfVessel(vessel, entersGallbladder(vessel.start) || entersGallbladder(vessel.end));
  }
  for (FatDescription& fat : scene.fat) fat.role = StructureRole::triangleFat;
}

void applySceneRules(const JsonPlace& root, SceneDescription& scene) {
  const auto rule = [](std::initializer_list<std::string_view> fields, auto&& check) {
    if (!JsonFaults::at(fields)) JsonFaults::part(check);
  };
  rule({"/workspace"}, [&] { checkWorkspace(root.at("workspace"), scene); });
  rule({"/camera"}, [&] { orientCamera(root.at("camera"), scene.camera); });
  for (std::size_t h = 0; h < handCount; ++h) {
    rule({"/workspace", std::string("/hands/") + handNames[h]},
         [&] { checkHand(root.at("hands").at(handNames[h]), scene.hands[h], scene.workspace); });
  }
  const std::size_t structures = scene.organs.size() + scene.vessels.size() + scene.fat.size();
  JsonFaults::part([&] {
    if (structures > maxStructures)
      root.fail(fmt::format("{} structures (organs, vessels and bodies of fat); at most {} are allowed", structures,
                            maxStructures));
  });
  const bool surfaces = std::none_of(scene.organs.begin(), scene.organs.end(),
                                     [](const OrganDescription& organ) { return organ.surface.vertex.empty(); });
  if (scene.organs.empty() || !surfaces) return;
  rule({"/organs"}, [&] { checkAnchors(root.at("organs"), scene); });
  rule({"/organs"}, [&] { checkOrgans(root.at("organs"), scene); });
  for (std::size_t i = 0; i < scene.connective.size(); ++i) {
    rule({"/organs", "/connective"}, [&] {
      const JsonPlace place = root.at("connective").at(i);
      if (isRepeated(scene.connective, i, &ConnectiveDescription::name))
        place.at("name").fail("a second connective tissue of this name");
      checkConnective(place, scene.connective[i], scene);
    });
  }
  for (std::size_t i = 0; i < scene.retraction.size(); ++i) {
    rule({"/organs", "/retraction"}, [&] {
      checkKnown(root.at("retraction").at(i).at("organ"), scene.organs, scene.retraction[i].organ, "organ");
    });
  }
  for (std::size_t i = 0; i < scene.vessels.size(); ++i)
    rule({"/organs", "/vessels"}, [&] { checkVessel(root.at("vessels").at(i), scene, i); });
  for (std::size_t i = 0; i < scene.fat.size(); ++i)
    rule({"/organs", "/vessels", "/fat"}, [&] { checkFat(root.at("fat").at(i), scene, i); });
  rule({"/organs", "/connective", "/vessels", "/fat", "/retraction"}, [&] {
    if (!statesRoles(root)) deriveRoles(scene);
  });
  rule({"/organs", "/connective", "/vessels", "/fat", "/retraction", "/procedure"}, [&] {
    if (root.has("procedure")) checkProcedure(root.at("procedure"), scene);
  });
}

}  // namespace calot::recorder
