// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/step/tissue_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include "sim/contact/capsule_contact.h"
#include "sim/contact/surface_patches.h"
#include "sim/geometry/closest_point.h"
#include "sim/math/elementary.h"
#include "sim/math/linear.h"
#include "sim/step/stages.h"

namespace calot {

namespace {

/// By which searches reach farther than contact, so that the next ones can be left out (m). Larger: each search finds
/// more triangles; smaller: searches are repeated after less motion. Measured on the whole operation.
constexpr double fatSearchMargin = 0.002;
constexpr double fatRounding = 1e-9;  ///< of a motion (m)
/// Rows of one body of fat, the deepest: more are pressed together than its neighbours can respond to. Larger costs
/// time (rows cubed); smaller lets crumpled fat sink in. Assumed.
constexpr std::size_t maxFatContacts = 128;
/// A cube with less of its fat than this touches nothing: it weighs next to nothing and trembles. Assumed.
constexpr double minFill = 0.25;

Box boundsOf(const Surfaces& surfaces, const TissueTravel& travel, std::size_t structure,
             std::optional<std::size_t> vessel) {
  Box all;
  if (!vessel) {
    for (const Box& patch : surfaces.bounds(structure)) {
      all.include(patch.lower);
      all.include(patch.upper);
    }
    return all;
  }
  for (const VesselCapsule& c : travel.vessels()[*vessel].now) {
    all.include(c.p0);
    all.include(c.p1);
  }
  return all;
}

/// Mean vectors along the edges of a cube (m).
Mat3 edgesOf(const Index8& corner, std::span<const Vec3> position) {
  Mat3 edges = Mat3::Zero();
  for (std::size_t c = 0; c < 8; ++c) {
    const Vec3& p = position[static_cast<std::size_t>(corner[c])];
    for (int a = 0; a < 3; ++a) edges.col(a) += ((c >> a & 1U) != 0 ? 0.25 : -0.25) * p;
  }
  return edges;
}

Vec3 meanOf(const Index8& corner, std::span<const Vec3> values) {
  Vec3 sum = Vec3::Zero();
  for (const int n : corner) sum += values[static_cast<std::size_t>(n)];
  return 0.125 * sum;
}

/// Radius of a ball of this volume.
double ballRadius(double volume) { return cubeRoot(0.75 / std::numbers::pi * volume); }

/// Is there fat in such a cube?
bool has(const FatBody& body, const Index3& hexahedron) {
  const int cube = body.model().cubeAt(hexahedron);
  return cube >= 0 && !(body.fill()[static_cast<std::size_t>(cube)] < minFill);
}

/// Has a cube a side at which nothing lies?
bool isExposed(const FatBody& body, std::size_t cube) {
  const Index3& h = body.model().hexahedronOfCube(static_cast<int>(cube));
  for (int a = 0; a < 3; ++a) {
    for (const int way : {-1, 1}) {
      Index3 beside = h;
      beside[a] += way;
      if (!has(body, beside)) return true;
    }
  }
  return false;
}

}  // namespace

FatContacts::FatContacts(const Model& model, const TissueTravel& travel) : model_(model) {
  if (model.fat().empty()) return;
  for (std::size_t o = 0; o < model.organs().size(); ++o) target_.push_back({o, o, {}, 0.0});
  for (std::size_t v = 0; v < travel.vessels().size(); ++v) {
    const TissueTravel::Vessel& vessel = travel.vessels()[v];
    target_.push_back({vessel.structure, vessel.body, v, vessel.radius});
  }
  for (std::size_t s = 0; s < model.structures().size(); ++s) {
    const StructureModel& structure = model.structures()[s];
    if (structure.kind != tissueId<FatTissue>) continue;
    Fat& fat = fat_.emplace_back();
    fat.index = structure.index;
    fat.structure = s;
    fat.body = structure.body;
    tie(fat);
  }
  invalidate();
}

/// Ties of each cube.
void FatContacts::tie(Fat& fat) {
  const FatModel& fixed = *model_.fat()[fat.index];
  const std::size_t cubes = fixed.solid().cubes().size();
  for (const Target& target : target_) {
    Pair& pair = fat.pair.emplace_back();
    pair.ties.resize(cubes);
    pair.restDistance.assign(cubes, std::numeric_limits<double>::quiet_NaN());
    const std::vector<int>* const nodes = !target.vessel
                                              ? nullptr
                                              : &model_.vesselTrees()[model_.structures()[target.structure].index]
                                                     .beams.branches()[model_.structures()[target.structure].branch]
                                                     .node;
    for (const Tie& tie : model_.ties()) {
      if (tie.fat != fat.index || tie.body[0] != target.body) continue;
      if (nodes != nullptr) {
        const auto& at = tie.place[0].node;
        if (std::none_of(at.begin(), at.begin() + static_cast<std::ptrdiff_t>(tie.place[0].count),
                         [&](int n) { return std::find(nodes->begin(), nodes->end(), n) != nodes->end(); })) {
          continue;
        }
      }
      pair.ties[static_cast<std::size_t>(fixed.allTies()[tie.fatTie].cube)].push_back(tie.fatTie);
    }
  }
}

void FatContacts::invalidate() {
  for (Fat& fat : fat_) {
    fat.known = false;
    for (Pair& pair : fat.pair) pair.clearance.clear();
  }
}

/// Positions of the cubes, their motion since the last run, and the pairs that may touch.
void FatContacts::follow(const FatBody& body, const State& state, bool awake, Fat& fat) {
  const std::vector<Index8>& cubes = body.model().solid().cubes();
  const SolidState& solid = state.fat[fat.index].solid;
  const bool known = fat.middle.size() == cubes.size() && fat.known;
  if (known && !awake && !fat.wasAwake) {
    fat.motion.assign(cubes.size(), 0.0);
    fat.speed.assign(cubes.size(), 0.0);
    return;
  }
  fat.known = true;
  fat.wasAwake = awake;
  fat.middle.resize(cubes.size(), Vec3::Zero());
  fat.motion.assign(cubes.size(), 0.0);
  fat.speed.assign(cubes.size(), 0.0);
  fat.size.assign(cubes.size(), 0.0);
  for (std::size_t c = 0; c < cubes.size(); ++c) {
    if (body.fill()[c] < minFill) continue;
    const Vec3 middle = meanOf(cubes[c], solid.position);
    fat.motion[c] = known ? (middle - fat.middle[c]).norm() : 0.0;
    fat.middle[c] = middle;
    if (!isExposed(body, c)) continue;
    fat.size[c] = ballRadius(body.fill()[c]);
    if (awake) fat.speed[c] = meanOf(cubes[c], solid.velocity).norm();
  }
}

FatContacts::Nearest FatContacts::nearestOn(const Surfaces& surfaces, const TissueTravel& travel, const State& state,
                                            const Target& target, const Vec3& from, double limit) {
  Nearest out;
  out.distance = limit;
  if (!target.vessel) {
    const std::span<const std::uint32_t> patches = surfaces.patchesNear(target.structure, from, from, limit, search_);
    if (patches.empty()) return out;
    ++searches_;
    const ContactSurface& mesh = surfaces.mesh(target.structure);
    const NearestPoint nearest = nearestPoint(mesh, surfaces.points(target.structure), patches, from, limit);
    if (!nearest.found) return out;
    const Index3& corner = mesh.triangles()[nearest.triangle];
    out.found = true;
    out.distance = (nearest.inside ? -1.0 : 1.0) * std::sqrt(nearest.point.squaredDistance);
    out.point = nearest.point.point;
    out.place = surfaces.skin(target.structure).influence({corner[0], corner[1], corner[2]}, nearest.point.barycentric);
    for (const int n : corner) out.inverted = out.inverted || isInverted(model_, state, target.structure, n);
    return out;
  }
  ++searches_;
  for (const VesselCapsule& capsule : travel.vessels()[*target.vessel].now) {
    const double s = closestOnSegment(from, capsule.p0, capsule.p1);
    const Vec3 point = capsule.p0 + s * (capsule.p1 - capsule.p0);
    const double distance = (from - point).norm();
    if (!(distance < out.distance)) continue;
    out.found = true;
    out.distance = distance;
    out.point = point;
    out.place = capsule.place(s);
  }
  return out;
}

/// Distance of a cube's centre from a target's surface or axis, both in the reference configuration (m).
double FatContacts::restDistance(const TissueTravel& travel, const Target& target, const Fat& fat, std::size_t cube,
                                 Pair& pair) {
  double& distance = pair.restDistance[cube];
  if (!std::isnan(distance)) return distance;
  const SolidModel& solid = model_.fat()[fat.index]->solid();
  const Vec3 middle = meanOf(solid.cubes()[cube], solid.rest());
  distance = 1.0;  // anything that is far
  if (target.vessel) {
    for (const VesselCapsule& c : travel.vessels()[*target.vessel].rest) {
      const double s = closestOnSegment(middle, c.p0, c.p1);
      distance = std::min(distance, (middle - (c.p0 + s * (c.p1 - c.p0))).norm());
    }
    return distance;
  }
  const OrganModel& organ = model_.organs()[target.body];
  all_.resize(organ.surface.patches().size());
  std::iota(all_.begin(), all_.end(), 0U);
  const NearestPoint nearest = nearestPoint(organ.surface, organ.skin, all_, middle, distance);
  if (nearest.found) distance = (nearest.inside ? -1.0 : 1.0) * std::sqrt(nearest.point.squaredDistance);
  return distance;
}

double FatContacts::touch(const Surfaces& surfaces, const TissueTravel& travel, const State& state, const FatBody& body,
                          double step, Fat& fat, std::size_t which, std::vector<ContactBlock>& blocks) {
  const Target& target = target_[which];
  Pair& pair = fat.pair[which];
  const FatModel& fixed = body.model();
  const std::vector<Index8>& cubes = fixed.solid().cubes();
  const double speed = target.vessel ? travel.vessels()[*target.vessel].speed : travel.organSpeed(target.body);
  const double restEdge = fixed.lattice().cell() * fixed.cellsPerCube();
  const std::uint64_t number = structurePairNumber(model_, target.structure, fat.structure) << pairShift;
  const Box bounds = boundsOf(surfaces, travel, target.structure, target.vessel);
  double depth = 0.0;
  for (std::size_t c = 0; c < cubes.size(); ++c) {
    if (!(fat.size[c] > 0.0)) continue;
    double& clearance = pair.clearance[c];
    const double reach = 2.0 * allowedOverlap + std::min((fat.speed[c] + speed) * step, maxApproach);
    const double near = fat.size[c] * restEdge + target.radius + reach;
    if (clearance > near) continue;
    const auto held = [&](std::size_t t) { return body.tieShare(t) > 0.0; };
    if (std::any_of(pair.ties[c].begin(), pair.ties[c].end(), held)) continue;
    const Vec3& middle = fat.middle[c];
    const double limit = near + fatSearchMargin;
    clearance = distanceOf(Box{middle, middle}, bounds);
    if (clearance > limit) continue;
    const Nearest nearest = nearestOn(surfaces, travel, state, target, middle, limit);
    clearance = nearest.distance;
    if (!nearest.found || nearest.inverted || !(std::abs(nearest.distance) > fatRounding)) continue;

    const Vec3 normal = (middle - nearest.point) / nearest.distance;
    const Mat3 edges = edgesOf(cubes[c], state.fat[fat.index].solid.position);
    const Vec3 along = edges.transpose() * normal;
    const double stretched = along.norm();
    if (!(edges.determinant() > 0.0) || !(stretched > 0.0)) continue;
    const double extent = fat.size[c] * std::min(stretched, restEdge);
    if (nearest.distance - target.radius - extent >= reach) continue;
    int side = 0;
    along.cwiseAbs().maxCoeff(&side);
    Index3 beside = fixed.hexahedronOfCube(static_cast<int>(c));
    beside[side] += along[side] > 0.0 ? -1 : 1;
    if (has(body, beside)) continue;
    const double rest = restDistance(travel, target, fat, c, pair) - target.radius;
    if (!(rest > 0.0)) continue;
    const double gap = nearest.distance - target.radius - extent - notPositive(rest - fat.size[c] * restEdge);
    if (!(gap < reach)) continue;

    depth = std::max(depth, -gap);
    ContactBlock block;
    block.kind = BlockKind::unilateral;
    TissueOnTissue touching{{fat.body, {}}, {target.body, nearest.place}, tissueSoftness};
    block.direction[0] = normal;
    const Vec3 local = notNegative(Vec3(Vec3::Constant(0.5) - fat.size[c] / stretched * along)).cwiseMin(1.0);
    const Index3& h = fixed.hexahedronOfCube(static_cast<int>(c));
    const std::array<double, 8> share =
        fixed.shares(static_cast<int>(c), static_cast<double>(fixed.cellsPerCube()) * (h.cast<double>() + local));
    for (std::size_t k = 0; k < 8; ++k) addShare(touching.along.place, cubes[c][k], share[k]);
    block.gap[0] = std::max(gap + allowedOverlap, -maxRecovery);
    block.key = number | c;
    gap_.push_back(gap);
    block.of = std::move(touching);
    blocks.push_back(std::move(block));
  }
  return depth;
}

/// Distances less motion since.
void FatContacts::wear(const Fat& fat, double motion, std::vector<double>& clearance) {
  clearance.resize(fat.motion.size(), -1.0);
  for (std::size_t c = 0; c < clearance.size(); ++c) {
    const double both = fat.motion[c] + motion;
    if (both > 0.0) clearance[c] = std::max(clearance[c] - both - fatRounding, -1.0);
  }
}

double FatContacts::run(const Surfaces& surfaces, const Bodies& bodies, const TissueTravel& travel, const State& state,
                        const std::vector<bool>& awake, std::vector<ContactBlock>& blocks) {
  searches_ = 0;
  double depth = 0.0;
  for (Fat& fat : fat_) {
    const FatBody& body = bodies.fat(fat.index).fat();
    follow(body, state, awake[fat.body], fat);
    const std::size_t first = blocks.size();
    gap_.clear();
    for (std::size_t t = 0; t < target_.size(); ++t) {
      const Target& target = target_[t];
      wear(fat, !target.vessel ? travel.organMotion(target.body) : travel.vessels()[*target.vessel].motion,
           fat.pair[t].clearance);
      if (!awake[fat.body] && !awake[target.body]) continue;
      depth = std::max(depth, touch(surfaces, travel, state, body, bodies.step(), fat, t, blocks));
    }
    keepDeepest(first, maxFatContacts, gap_, blocks);
  }
  return depth;
}

}  // namespace calot
