// SPDX-License-Identifier: GPL-3.0-or-later
// The part of a Model that is built from fat: its field and cubes, and what ties it to organs and vessels.
#include <algorithm>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "sim/geometry/closest_point.h"
#include "sim/geometry/surface_distance.h"
#include "sim/scene/model.h"

namespace calot {

namespace {

/// Distance of a point from a branch's wall at rest (m).
double distanceFrom(const BeamModel& beams, std::size_t branch, const Vec3& p) {
  const BeamModel::Branch& b = beams.branches()[branch];
  double least = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i + 1 < b.node.size(); ++i) {
    const Vec3& from = beams.rest()[static_cast<std::size_t>(b.node[i])];
    const Vec3& to = beams.rest()[static_cast<std::size_t>(b.node[i + 1])];
    least = std::min(least, (from + closestOnSegment(p, from, to) * (to - from) - p).norm());
  }
  return least - b.section.outerRadius;
}

/// Does a point lie over or under the triangle, no farther from its plane than `depth`?
bool isOverTriangle(const std::array<Vec3, 3>& corner, double depth, const Vec3& p) {
  const Vec3 normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]).normalized();
  const Vec3 foot = p - (p - corner[0]).dot(normal) * normal;
  if ((p - foot).squaredNorm() > depth * depth) return false;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3& from = corner[k];
    const Vec3& to = corner[(k + 1) % 3];
    if ((to - from).cross(foot - from).dot(normal) < 0.0) return false;
  }
  return true;
}

}  // namespace

/// @return what is wrong with it, or nothing
std::string Model::addFat(const SceneDescription& scene, const FatDescription& description) {
  const std::string what = "fat '" + description.name + "': ";
  std::vector<std::unique_ptr<SurfaceDistance>> surfaces;
  std::vector<FatPartner> partners;
  struct Partner {
    bool vessel = false;
    std::size_t index = 0;  // organ; vessel tree
    std::size_t branch = 0;
  };
  std::vector<Partner> known;
  for (const FatAttachmentDescription& attachment : description.attachments) {
    FatPartner partner{attachment.to, {}, attachment.distance, attachment.stiffness, attachment.damping};
    Partner& to = known.emplace_back();
    bool found = false;
    for (std::size_t o = 0; o < organs_.size() && !found; ++o) {
      if (organs_[o].name != attachment.to) continue;
      const SurfaceDescription& surface = scene.organs[o].surface;
      surfaces.push_back(std::make_unique<SurfaceDistance>(TriangleMesh{surface.vertex, surface.triangle}));
      partner.distance = [distance = surfaces.back().get()](const Vec3& p) { return distance->signedDistance(p); };
      to = {false, o, 0};
      found = true;
    }
    for (std::size_t t = 0; t < vesselTree_.size() && !found; ++t) {
      for (std::size_t b = 0; b < vesselTree_[t].vessel.size() && !found; ++b) {
        if (scene.vessels[vesselTree_[t].vessel[b]].name != attachment.to) continue;
        partner.distance = [beams = &vesselTree_[t].beams, b](const Vec3& p) { return distanceFrom(*beams, b, p); };
        to = {true, t, b};
        found = true;
      }
    }
    if (!found) return what + "hangs on '" + attachment.to + "', which is no organ and no vessel of the scene";
    partners.push_back(std::move(partner));
  }
  std::vector<FatRegion> regions;
  if (description.triangleDepth > 0.0) {
    regions.push_back({"to clear", [&](const Vec3& p) {
                         return isOverTriangle(description.triangle, description.triangleDepth, p);
                       }});
  }
  // What hides a vessel that is to be divided.
  constexpr double coverDepth = 0.0015;  // m
  for (const DivideDescription& divide : scene.procedure.divide) {
    if (scene.procedure.fat != description.name) break;
    for (const VesselTree& tree : vesselTree_) {
      for (std::size_t b = 0; b < tree.vessel.size(); ++b) {
        if (scene.vessels[tree.vessel[b]].name != divide.vessel) continue;
        regions.push_back({divide.vessel, [beams = &tree.beams, b](const Vec3& p) {
                             return distanceFrom(*beams, b, p) <= coverDepth;
                           }});
      }
    }
  }
  const MaterialDescription& m = description.material;
  FatSettings settings;
  settings.cell = description.cellSize;
  settings.cellsPerCube = static_cast<int>(description.cellsPerCube);
  settings.material = {lameConstants(m.youngModulus, m.poissonRatio), m.density, m.massDamping, m.stiffnessDamping};
  std::string error;
  std::unique_ptr<const FatModel> fat =
      FatModel::make({description.surface.vertex, description.surface.triangle}, settings, partners, regions, error);
  if (fat == nullptr) return what + error;
  const std::size_t body = organs_.size() + vesselTree_.size() + fat_.size();
  for (std::size_t p = 0; p < known.size(); ++p) {
    const std::span<const FatTie> ties = fat->ties(p);
    std::vector<Vec3> points;
    points.reserve(ties.size());
    for (const FatTie& tie : ties) points.push_back(tie.rest);
    std::vector<MaterialPoint> places;
    if (!known[p].vessel && !points.empty()) places = placesOnOrgan(known[p].index, points);
    for (std::size_t i = 0; i < ties.size(); ++i) {
      Tie tie;
      tie.place[1] = ties[i].point;
      tie.stiffness = ties[i].stiffness;
      tie.damping = ties[i].damping;
      tie.fat = fat_.size();
      tie.fatTie = fat->firstTie(p) + i;
      if (known[p].vessel) {
        const BeamModel& beams = vesselTree_[known[p].index].beams;
        const std::vector<int>& nodes = beams.branches()[known[p].branch].node;
        const auto away = [&](int n) {
          return (beams.rest()[static_cast<std::size_t>(n)] - ties[i].rest).squaredNorm();
        };
        const int nearest =
            *std::min_element(nodes.begin(), nodes.end(), [&](int a, int b) { return away(a) < away(b); });
        const auto n = static_cast<std::size_t>(nearest);
        tie.body = {organs_.size() + known[p].index, body};
        tie.place[0].node[0] = nearest;
        tie.place[0].weight[0] = 1.0;
        tie.place[0].count = 1;
        tie.offset = beams.restOrientation()[n].conjugate() * (ties[i].rest - beams.rest()[n]);
      } else {
        tie.body = {known[p].index, body};
        tie.place[0] = places[i];
      }
      tie_.push_back(tie);
    }
  }
  fat_.push_back(std::move(fat));
  return {};
}

}  // namespace calot
