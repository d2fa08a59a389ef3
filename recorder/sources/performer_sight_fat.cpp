// SPDX-License-Identifier: GPL-3.0-or-later
// Fat as a performer sees it: on the vessels, and in the triangle between them.
#include <algorithm>
#include <cmath>

#include "recorder/sources/performer_sight.h"
#include "recorder/sources/pointing.h"

namespace calot::recorder {
namespace {

constexpr double columnWay = 0.0025;   // from one column of the triangle to the next (m)
constexpr double columnHalf = 0.0014;  // half its width (m)
constexpr double margin = 0.04;        // so far from the triangle's edges, as a share of it
constexpr double fatAside = 0.0020;    // so far beside a vessel fat is looked at, from its surface (m)
constexpr double fatOver = 0.0005;     // what is over a vessel reaches so far beside it (m)
constexpr double nothing = -1.0;       // height of fat where there is none (m)

}  // namespace

/// Rows and columns within the triangle, and what in it is not to be touched.
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
  for (const VesselDescription& v : scene.vessels) {
    const std::vector<std::string>& spare = scene.procedure.spare;
    if (std::find(spare.begin(), spare.end(), v.name) == spare.end()) continue;
    for (const Vec3& p : stationsOf(v.path)) spared_.emplace_back(p, v.radius);
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

}  // namespace calot::recorder
