// SPDX-License-Identifier: GPL-3.0-or-later
// Fat as a performer sees it: on the vessels, and in the triangle between them.
#include "recorder/sources/operation_mind.h"

#include <algorithm>
#include <cmath>

#include "recorder/sources/pointing.h"

namespace calot::recorder {
namespace {

constexpr double gripFrom = 0.026;      // of the specimen's neck: the place to hold is no nearer (m)
constexpr double gripTo = 0.042;        // and no farther
constexpr double fatClearance = 0.006;  // of the place to hold (m)
constexpr double around = 0.0012;       // of a station: its vessel's skin this near to it shows where it is (m)

bool underFat(const SceneDescription& scene, const Vec3& p) {
  for (const FatDescription& fat : scene.fat) {
    for (const Vec3& v : fat.surface.vertex) {
      if ((v - p).norm() < fatClearance) return true;
    }
  }
  return false;
}

/// Name of the first tissue of that role, or nothing.
template <class Tissue>
std::string nameWithRole(const std::vector<Tissue>& all, StructureRole role) {
  const auto found = std::find_if(all.begin(), all.end(), [&](const Tissue& one) { return one.role == role; });
  return found == all.end() ? std::string() : found->name;
}

}  // namespace

const SurfaceView* PerformerSight::surfaceNamed(const SceneView& view, const std::string& name) {
  for (const SurfaceView& s : view.surface) {
    if (s.organ == name) return &s;
  }
  return nullptr;
}

std::vector<Vec3> PerformerSight::stationsOf(const std::vector<Vec3>& path) {
  std::vector<Vec3> out;
  double left = 0.0;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const Vec3 along = path[i + 1] - path[i];
    const double length = along.norm();
    double at = left;
    for (; at <= length; at += spacing) out.emplace_back(path[i] + (at / length) * along);
    left = at - length;
  }
  return out;
}

PerformerSight::PerformerSight(const SceneDescription& scene, std::size_t worker)
    : organs_(scene.organs.size()), specimen_(organs_), worker_(worker), eye_(scene.camera.position) {
  for (std::size_t h = 0; h < handCount; ++h) port_[h] = scene.hands[h].port;
  bed_ =
      !scene.procedure.bed.empty() ? scene.procedure.bed : nameWithRole(scene.connective, StructureRole::cysticPlate);
  planVessels(scene);
  specimenName_ = scene.procedure.specimen;
  if (specimenName_.empty() && !(bed_.empty() && vessel_.empty()))
    specimenName_ = nameWithRole(scene.organs, StructureRole::gallbladder);
  fat_ = nameWithRole(scene.fat, StructureRole::triangleFat);
  planColumns(scene);
  planSpared(scene);
  // A scene of fat alone is for clearing.
  divides_ = !vessel_.empty() && (fat_.empty() || !bed_.empty());
  for (std::size_t o = 0; o < organs_; ++o) {
    if (scene.organs[o].name == specimenName_) specimen_ = o;
  }
  if (hasSpecimen()) findSpecimen(scene);
}

/// The structures that the procedure divides; without a procedure, the cystic vessels.
void PerformerSight::planVessels(const SceneDescription& scene) {
  std::vector<DivideDescription> divide = scene.procedure.divide;
  for (const VesselDescription& v : scene.vessels) {
    if (scene.procedure.specimen.empty() && isCystic(v.role)) divide.push_back({v.name});
  }
  for (const DivideDescription& d : divide) {
    for (std::size_t i = 0; i < scene.vessels.size(); ++i) {
      if (scene.vessels[i].name != d.vessel) continue;
      VesselPlan plan;
      plan.name = d.vessel;
      plan.radius = scene.vessels[i].radius;
      plan.index = i;
      plan.rest = stationsOf(scene.vessels[i].path);
      if (!d.patientAtStart) std::reverse(plan.rest.begin(), plan.rest.end());
      plan.patientClips = d.patient;
      plan.specimenClips = d.specimen;
      vessel_.push_back(plan);
    }
  }
}

/// The neck is deepest in the body; the place to hold lies near it, faces the eye and the shaft that comes for it.
void PerformerSight::findSpecimen(const SceneDescription& scene) {
  const SurfaceDescription& skin = scene.organs[specimen_].surface;
  neck_ = skin.vertex[0];
  for (std::size_t i = 0; i < skin.vertex.size(); ++i) {
    if (!(skin.vertex[i].y() < neck_.y())) continue;
    neck_ = skin.vertex[i];
    neckVertex_ = i;
  }
  std::vector<Vec3> normal(skin.vertex.size(), Vec3::Zero());
  for (const Index3& t : skin.triangle) {
    const auto at = [&](int k) -> const Vec3& { return skin.vertex[static_cast<std::size_t>(t[k])]; };
    const Vec3 area = (at(1) - at(0)).cross(at(2) - at(0));
    for (int k = 0; k < 3; ++k) normal[static_cast<std::size_t>(t[k])] += area;
  }
  double best = -1e300;
  for (std::size_t i = 0; i < skin.vertex.size(); ++i) {
    const Vec3& p = skin.vertex[i];
    const double from = (p - neck_).norm();
    if (from < gripFrom || from > gripTo || !(normal[i].norm() > 0.0) || underFat(scene, p)) continue;
    const Vec3 n = normal[i] / normal[i].norm();
    const Vec3 toEye = (eye_ - p) / (eye_ - p).norm();
    const double score = n.dot(toEye) - n.dot(shaftDirection(port_[1 - worker_], p));
    if (!(score > best)) continue;
    best = score;
    gripVertex_ = i;
  }
}

void PerformerSight::seeVessel(const SceneView& view, const VesselPlan& plan, SeenVessel& seen) const {
  const SurfaceView* skin = surfaceNamed(view, plan.name);
  seen.centre = plan.rest;
  if (skin != nullptr) {
    // The tissue around a station at rest locates it now.
    for (std::size_t s = 0; s < plan.rest.size(); ++s) {
      Vec3 moved = Vec3::Zero();
      double count = 0.0;
      for (std::size_t v = 0; v < skin->rest.size(); ++v) {
        if ((skin->rest[v] - plan.rest[s]).norm() > plan.radius + around) continue;
        moved += skin->position[v];
        count += 1.0;
      }
      if (count > 0.0) seen.centre[s] = moved / count;
    }
  }
  for (std::size_t s = 0; s < plan.rest.size(); ++s) {
    const std::size_t before = s > 0 ? s - 1 : 0;
    const std::size_t after = std::min(s + 1, plan.rest.size() - 1);
    const Vec3 t = seen.centre[after] - seen.centre[before];
    seen.along.emplace_back(t.norm() > 1e-9 ? Vec3(t / t.norm()) : Vec3(Vec3::UnitX()));
  }
  for (const ClipView& clip : view.clip) {
    double nearest = 0.004;
    double place = -1.0;
    for (std::size_t s = 0; s < seen.centre.size(); ++s) {
      const double d = (clip.pose.position - seen.centre[s]).norm();
      if (!(d < nearest)) continue;
      nearest = d;
      place = spacing * static_cast<double>(s) + (clip.pose.position - seen.centre[s]).dot(seen.along[s]);
    }
    if (place >= 0.0) seen.clip.push_back(place);
  }
  std::sort(seen.clip.begin(), seen.clip.end());
}

Sight PerformerSight::look(const StepRecord& record) const {
  const SceneView view = record.view();
  Sight sight;
  for (const VesselPlan& plan : vessel_) {
    SeenVessel seen;
    seeVessel(view, plan, seen);
    seeFat(view, plan, seen);
    seen.partings = record.result.vessel[plan.index].partings;
    sight.vessel.push_back(seen);
  }
  for (const VesselPlan& plan : spared_) {
    SeenVessel seen;
    seeVessel(view, plan, seen);
    for (const Vec3& centre : seen.centre) sight.spared.emplace_back(centre, plan.radius);
  }
  seeColumns(view, sight);
  for (const ConnectiveView& tissue : view.connective) {
    if (tissue.name != bed_) continue;
    for (std::size_t s = 0; s < tissue.strand.size(); ++s) {
      sight.strand.push_back({tissue.strand[s], tissue.condition[s] == StrandCondition::attached});
    }
  }
  for (std::size_t h = 0; h < handCount; ++h) {
    const HandResult& hand = record.result.hand[h];
    sight.hand[h] = {hand.grasping != 0, hand.clips};
  }
  for (const FatResult& fat : record.result.fat) sight.held = sight.held || fat.holdsSpecimen;
  if (hasSpecimen()) {
    if (const SurfaceView* skin = surfaceNamed(view, specimenName_)) sight.grip = skin->position[gripVertex_];
    if (sight.held) seeTethers(view, sight);
  }
  return sight;
}

namespace {

constexpr double columnWay = 0.0025;   // from one column of the triangle to the next (m)
constexpr double columnHalf = 0.0014;  // half its width (m)
constexpr double margin = 0.04;        // so far from the triangle's edges, as a share of it
constexpr double fatAside = 0.0020;    // so far beside a vessel fat is looked at, from its surface (m)
constexpr double fatOver = 0.0005;     // what is over a vessel reaches so far beside it (m)
constexpr double nothing = -1.0;       // height of fat where there is none (m)
constexpr double drawnOut = 0.015;     // the specimen has moved so far that what holds it shows (m)
constexpr double tetherWidth = 0.006;  // what hangs nearer to one another is one (m)

}  // namespace

/// Rows and columns within the triangle.
void PerformerSight::planColumns(const SceneDescription& scene) {
  for (const FatDescription& fat : scene.fat) {
    if (fat.name != fat_ || !(fat.triangleDepth > 0.0)) continue;
    triangleDepth_ = fat.triangleDepth;
    const Vec3 u = fat.triangle[1] - fat.triangle[0];
    const Vec3 v = fat.triangle[2] - fat.triangle[0];
    const double du = columnWay / u.norm(), dv = columnWay / v.norm();
    std::size_t row = 0;
    for (double b = 0.0; b <= 1.0 - 2.0 * margin; b += dv, ++row) {
      for (double a = margin; a + b <= 1.0 - margin; a += du) {
        column_.push_back({fat.triangle[0] + a * u + b * v, row});
      }
    }
  }
}

void PerformerSight::planSpared(const SceneDescription& scene) {
  for (const VesselDescription& v : scene.vessels) {
    const std::vector<std::string>& spare = scene.procedure.spare;
    if (std::find(spare.begin(), spare.end(), v.name) == spare.end()) continue;
    VesselPlan& plan = spared_.emplace_back();
    plan.name = v.name;
    plan.radius = v.radius;
    plan.rest = stationsOf(v.path);
  }
}

void PerformerSight::seeColumns(const SceneView& view, Sight& sight) const {
  const SurfaceView* fat = column_.empty() ? nullptr : surfaceNamed(view, fat_);
  if (fat == nullptr) return;
  Box box;
  for (const ColumnPlan& c : column_) box.include(c.place);
  box.grow(triangleDepth_);
  std::vector<double> count(column_.size(), 0.0);
  std::vector<Vec3> moved(column_.size(), Vec3::Zero());
  sight.column.assign(column_.size(), {});
  for (std::size_t i = 0; i < fat->rest.size(); ++i) {
    const Vec3& p = fat->rest[i];
    if ((p.array() < box.lower.array()).any() || (p.array() > box.upper.array()).any()) continue;
    for (std::size_t c = 0; c < column_.size(); ++c) {
      const Vec3 d = p - column_[c].place;
      if (d.squaredNorm() > triangleDepth_ * triangleDepth_) continue;
      const double height = -d.dot(shaftDirection(port_[worker_], column_[c].place));
      if (d.squaredNorm() - height * height > columnHalf * columnHalf) continue;
      SeenColumn& seen = sight.column[c];
      seen.top = count[c] > 0.0 ? std::max(seen.top, height) : height;
      seen.bottom = count[c] > 0.0 ? std::min(seen.bottom, height) : height;
      moved[c] += fat->position[i] - p;
      count[c] += 1.0;
    }
  }
  for (std::size_t c = 0; c < column_.size(); ++c) {
    sight.column[c].place = column_[c].place;
    if (count[c] > 0.0) sight.column[c].place += moved[c] / count[c];
  }
}

void PerformerSight::seeFat(const SceneView& view, const VesselPlan& plan, SeenVessel& seen) const {
  seen.fat.assign(plan.rest.size(), {nothing, nothing, nothing});
  const SurfaceView* fat = fat_.empty() ? nullptr : surfaceNamed(view, fat_);
  if (fat == nullptr) return;
  Box box;
  for (const Vec3& c : seen.centre) box.include(c);
  box.grow(0.02);
  for (const Vec3& p : fat->position) {
    if ((p.array() < box.lower.array()).any() || (p.array() > box.upper.array()).any()) continue;
    for (std::size_t s = 0; s < seen.centre.size(); ++s) {
      const Vec3 d = p - seen.centre[s];
      if (std::abs(d.dot(seen.along[s])) > spacing) continue;
      const Vec3 shaft = shaftDirection(port_[worker_], seen.centre[s]);
      Vec3 side = shaft.cross(seen.along[s]);
      side /= std::max(side.norm(), 1e-9);
      const double aside = d.dot(side);
      if (std::abs(aside) > plan.radius + fatAside) continue;
      const std::size_t bin = std::abs(aside) <= plan.radius + fatOver ? 0 : (aside < 0.0 ? 1 : 2);
      seen.fat[s][bin] = std::max(seen.fat[s][bin], -d.dot(shaft));
    }
  }
}

/// The surface of fat goes along with what carries it: where it moved half as far as the specimen, it is drawn out
/// between both.
void PerformerSight::seeTethers(const SceneView& view, Sight& sight) const {
  const SurfaceView* fat = fat_.empty() ? nullptr : surfaceNamed(view, fat_);
  const SurfaceView* specimen = surfaceNamed(view, specimenName_);
  if (fat == nullptr || specimen == nullptr) return;
  const Vec3 way = specimen->position[neckVertex_] - specimen->rest[neckVertex_];
  if (!(way.norm() > drawnOut)) return;
  const auto share = [&](int v) {
    const auto i = static_cast<std::size_t>(v);
    return (fat->position[i] - fat->rest[i]).dot(way) / way.squaredNorm() - 0.5;
  };
  struct Drawn {
    double height = 0.0;  // towards the port
    Vec3 place = Vec3::Zero();
  };
  std::vector<Drawn> drawn;
  for (const Index3& t : fat->triangle) {
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      const double from = share(a), to = share(b);
      if (a > b || (from < 0.0) == (to < 0.0)) continue;
      const Vec3& p = fat->position[static_cast<std::size_t>(a)];
      const Vec3 place = p + from / (from - to) * (fat->position[static_cast<std::size_t>(b)] - p);
      drawn.push_back({-(place - port_[worker_]).norm(), place});
    }
  }
  std::sort(drawn.begin(), drawn.end(), [](const Drawn& a, const Drawn& b) {
    if (a.height != b.height) return a.height > b.height;
    return std::lexicographical_compare(a.place.data(), a.place.data() + 3, b.place.data(), b.place.data() + 3);
  });
  for (const Drawn& d : drawn) {
    const auto same = std::find_if(sight.tether.begin(), sight.tether.end(), [&](const SeenTether& tether) {
      const Vec3 away = d.place - tether.place;
      const Vec3 shaft = shaftDirection(port_[worker_], tether.place);
      return (away - away.dot(shaft) * shaft).norm() < tetherWidth;
    });
    if (same == sight.tether.end()) {
      sight.tether.push_back({d.place, 0.0});
      continue;
    }
    same->depth = std::max(same->depth, (d.place - same->place).dot(shaftDirection(port_[worker_], same->place)));
  }
}

}  // namespace calot::recorder
