// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/step/stages.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "sim/math/floating_point.h"
#include "sim/math/linear.h"
#include "sim/step/contact_block.h"

namespace calot {

namespace {

/// A capsule that only just touches has flattened so far, in its radii. Larger: tilted bars are firmer at first touch.
/// Assumed.
constexpr double leastDepth = 0.1;
/// Radius of organs where shafts lie across them (m). Larger: long shafts are firmer. Assumed: that of a gallbladder.
constexpr double crossedRadius = 0.02;

/// Radius of a round end whose area is that of a capsule's side, as long as what touches of it: pressed in by `depth`,
/// an axis at the angle theta to the skin touches over some 2 depth (cot(theta) - 1) beside its end, but not beyond the
/// other, nor where a round organ has turned away from it.
double pressedSize(const Capsule& capsule, const Vec3& normal, double depth) {
  const Vec3 axis = capsule.p1 - capsule.p0;
  const double length = axis.norm();
  const double up = std::abs(axis.dot(normal));
  const double flat = std::sqrt(notNegative(length * length - up * up));
  if (!(flat > up)) return capsule.radius;
  const double in = std::max(depth, leastDepth * capsule.radius);
  const double ofEnds = (flat - up) * 2.0 * in / (2.0 * in + up);
  const double touching = std::min(ofEnds, std::sqrt(8.0 * in * crossedRadius));
  return std::sqrt(capsule.radius * (capsule.radius + 2.0 / std::numbers::pi * touching));
}

/// A place in a triangle. @param at of a node (m)
template <class At>
Vec3 pointAt(const At& at, const std::array<int, 3>& node, const Vec3& weight) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < 3; ++k) sum += weight[static_cast<int>(k)] * at(node[k]);
  return sum;
}

/// The skin's normal at a place in a triangle, as it varies between those at the corners (Phong 1975); zero where these
/// cancel. @param at of a node (m)
template <class At>
Vec3 smoothNormal(const ContactSurface& mesh, const At& at, const std::array<int, 3>& node, const Vec3& weight) {
  Vec3 sum = Vec3::Zero();
  ContactSurface::Fan fan;
  for (int k = 0; k < 3; ++k) {
    Vec3 corner = Vec3::Zero();
    for (const std::uint32_t t : mesh.trianglesAround(node[static_cast<std::size_t>(k)], fan)) {
      const Index3& c = mesh.triangles()[t];
      const Vec3 a = at(c[0]);
      corner += (at(c[1]) - a).cross(at(c[2]) - a);
    }
    if (corner.squaredNorm() > 0.0) sum += weight[k] * corner.normalized();
  }
  return sum.norm() > 0.1 ? Vec3(sum.normalized()) : Vec3(Vec3::Zero());
}

}  // namespace

void ContactDetection::addInstrumentBlock(const Surfaces& surfaces, const State& state, std::size_t hand,
                                          std::size_t structure, const SurfaceContact& contact,
                                          std::vector<ContactBlock>& blocks) const {
  const StructureModel& touched = model_.structures()[structure];
  const Pose tool = simulatedPose(state.hand[hand].instrument);
  ContactBlock block;
  block.kind = touched.friction > 0.0 ? BlockKind::frictional : BlockKind::unilateral;
  block.limit = touched.friction;
  ToolOnTissue touch;
  touch.tool.hand = hand;
  touch.tissue = {touched.body, surfaces.skin(structure).influence(contact.node, contact.weight)};
  touch.structure = structure;
  block.key = contact.key | static_cast<std::uint64_t>(structure) << structureShift;
  // Slip along and across the shaft, as far as the surface allows.
  const Mat3 frame = alongAxis(contact.normal, tool.orientation.toRotationMatrix().col(2)).toRotationMatrix();
  block.direction = {contact.normal, frame.col(0), frame.col(1)};
  block.gap = {contact.gap, 0.0, 0.0};
  const Vec3 onAxis = contact.onAxis - dimpleOf(state.hand[hand].touches, structure, contact.key >> 56U);
  for (std::size_t k = 0; k < block.rows(); ++k) {
    touch.tool.row[k] = toolRow(model_.scene().hands[hand].port, tool, onAxis, block.direction[k]);
  }
  if (touched.soft != nullptr && model_.scene().solver.dimples) {
    const Skin& skin = surfaces.skin(structure);
    const auto now = [&](int node) { return surfaces.points(structure)[static_cast<std::size_t>(node)]; };
    Press& press = touch.press.emplace();
    press.piece = contact.key >> 56U;
    const Capsule& capsule = instrument_[hand].capsule[press.piece];
    press.radius = capsule.radius;
    press.foot = pointAt(now, contact.node, contact.weight);
    press.smooth = smoothNormal(skin.surface(), now, contact.node, contact.weight);
    if (press.smooth.isZero()) press.smooth = contact.normal;
    press.size = pressedSize(capsule, press.smooth, dimpleOf(state.hand[hand].touches, structure, press.piece).norm());
    const SolidSolver::Impulse centre = touch.tissue.place;
    touch.tissue.place = pressedPatch(skin, contact.node, contact.weight, press.radius);
    press.spread = meshSpread(touched, centre, touch.tissue.place);
  }
  block.of = std::move(touch);
  blocks.push_back(std::move(block));
}

void ContactDetection::findInstrumentContacts(const Surfaces& surfaces, const Bodies& bodies,
                                              const InstrumentTravels& travels, const State& state,
                                              std::vector<ContactBlock>& blocks) {
  const std::size_t structures = surfaces.size();
  for (std::size_t h = 0; h < handCount; ++h) instrument_[h].place(model_.scene().hands[h], state.hand[h].instrument);
  touching_.resize(handCount * structures);
  executor_.run(touching_.size(), [&](std::size_t task) {
    const FloatingPointScope scope;
    const std::size_t pair = touching_.size() - 1 - task;  // fat, which has most triangles, first
    const std::size_t h = pair / structures, s = pair % structures;
    double speed = 0.0;
    for (const Vec3& v : bodies[model_.structures()[s].body].velocity(state)) speed = std::max(speed, v.squaredNorm());
    const double far = travels[h].reach + std::min(std::sqrt(speed) * bodies.step(), maxSlide);
    instrumentContacts(model_, surfaces, state, h, instrument_[h], s, far, touching_[pair].search,
                       touching_[pair].found);
  });
  for (std::size_t pair = 0; pair < touching_.size(); ++pair) {
    for (const SurfaceContact& contact : touching_[pair].found)
      addInstrumentBlock(surfaces, state, pair / structures, pair % structures, contact, blocks);
  }
}

/// An instrument on the other: the left one is pushed along the normal, the right one against it.
void ContactDetection::findClashes(const InstrumentTravels& travels, std::vector<ContactBlock>& blocks) {
  clashPoints(instrument_[0], instrument_[1], travels[0].reach + travels[1].reach, clash_);
  for (const ClashPoint& point : clash_) {
    ContactBlock block;
    block.kind = BlockKind::frictional;
    block.limit = instrumentFriction;
    ToolOnTool clash{{.hand = 0}, {.hand = 1}, 0.5 * (point.onA + point.onB)};
    block.key = point.key;
    const Mat3 frame =
        alongAxis(point.normal, instrument_[0].pose.orientation.toRotationMatrix().col(2)).toRotationMatrix();
    block.direction = {point.normal, frame.col(0), frame.col(1)};
    block.gap = {point.gap, 0.0, 0.0};
    for (std::size_t k = 0; k < block.rows(); ++k) {
      clash.left.row[k] = toolRow(instrument_[0].port, instrument_[0].pose, point.onA, block.direction[k]);
      clash.right.row[k] = -toolRow(instrument_[1].port, instrument_[1].pose, point.onB, block.direction[k]);
    }
    block.of = clash;
    blocks.push_back(block);
  }
}

double ContactDetection::findTissueContacts(const Surfaces& surfaces, const Bodies& bodies, const State& state,
                                            const Activity& activity, std::vector<ContactBlock>& blocks) {
  double depth = tissue_.run(surfaces, state, activity.awake, blocks);
  travel_.follow(surfaces, bodies, state, activity.awake);
  depth = std::max(depth, vessels_.run(surfaces, travel_, state, bodies.step(), activity.awake, blocks));
  return std::max(depth, fat_.run(surfaces, bodies, travel_, state, activity.awake, blocks));
}

double ContactDetection::run(const Surfaces& surfaces, Bodies& bodies, const InstrumentTravels& travels,
                             const State& state, Activity& activity, ContactSystem& contact) {
  contact.blocks.clear();
  findInstrumentContacts(surfaces, bodies, travels, state, contact.blocks);
  grasping_.addBlocks(surfaces, state, contact.blocks);
  findClashes(travels, contact.blocks);
  wakeBodies(model_, bodies, travels, contact.blocks, state, activity);
  double depth = 0.0;
  const std::size_t solids = bodies.joined().size();
  executor_.run(1 + solids, [&](std::size_t task) {
    const FloatingPointScope scope;
    if (task == 0) {
      depth = findTissueContacts(surfaces, bodies, state, activity, contact.blocks);
      return;
    }
    const std::size_t body = bodies.joined().bodyOf(solids - task);  // fat, the largest, first
    if (activity.awake[body]) bodies.joined().solid(body).linearise(state);
  });
  // A contact that sleeps on both sides needs no force.
  std::erase_if(contact.blocks, [&](const ContactBlock& block) {
    const auto asleep = [&](const PushedBody* pushed) { return pushed == nullptr || !activity.awake[pushed->body]; };
    return block.as<ToolOnTool>() == nullptr && asleep(block.against()) && asleep(block.along());
  });
  return depth;
}

namespace {

/// Radius of the ring, in those of the capsule, and how many of its points the contact point counts as. A larger ring
/// or a lighter centre: sheets as thin as the tool are pierced by fast ones; the opposite: deep presses are too soft on
/// fine meshes and too firm beside a coarse one's vertices. Measured (docs/explanation/accuracy.md).
constexpr double ringRadius = 1.4;
constexpr double centrePoints = 2.0;
/// Directions of the ring's points: the corners of a regular hexagon. Fewer: their places in the cells show.
constexpr std::array<std::array<double, 2>, 6> ringPoint{{{1.0, 0.0},
                                                          {0.5, 0.8660254037844386},
                                                          {-0.5, 0.8660254037844386},
                                                          {-1.0, 0.0},
                                                          {-0.5, -0.8660254037844386},
                                                          {0.5, -0.8660254037844386}}};
constexpr int maxWalk = 16;  ///< triangles between a contact point and one of its ring; beyond, it stays behind

struct SkinPoint {
  std::size_t triangle = 0;
  Vec3 weight = Vec3::Zero();
};

std::size_t triangleOf(const ContactSurface& mesh, const std::array<int, 3>& node) {
  ContactSurface::Fan fan;
  const std::span<const std::uint32_t> around = mesh.trianglesAround(node[0], fan);
  const auto same = [&](std::uint32_t t) {
    const Index3& at = mesh.triangles()[t];
    return at[0] == node[0] && at[1] == node[1] && at[2] == node[2];
  };
  const auto found = std::find_if(around.begin(), around.end(), same);
  return found == around.end() ? around[0] : *found;
}

/// The skin's point below or above another, from triangle to triangle; on the last one's border where the skin turns
/// away from it.
SkinPoint walkTo(const Vec3& target, const Skin& skin, const SkinPoint& start) {
  const ContactSurface& mesh = skin.surface();
  SkinPoint at = start;
  std::size_t before = at.triangle;
  for (int step = 0;; ++step) {
    const Index3& t = mesh.triangles()[at.triangle];
    const Vec3 a = skin.rest(t[0]);
    const Vec3 ab = skin.rest(t[1]) - a;
    const Vec3 ac = skin.rest(t[2]) - a;
    const Vec3 normal = ab.cross(ac);
    const double area = normal.squaredNorm();
    if (!(area > 0.0)) return start;
    const Vec3 way = target - a;
    const double b = way.cross(ac).dot(normal) / area;
    const double c = ab.cross(way).dot(normal) / area;
    at.weight = Vec3(1.0 - b - c, b, c);
    int least = 0;
    at.weight.minCoeff(&least);
    if (at.weight[least] >= 0.0) return at;
    const int next = mesh.neighbourTriangle(at.triangle, (least + 1) % 3);
    if (next < 0 || static_cast<std::size_t>(next) == before || step == maxWalk) break;
    before = at.triangle;
    at.triangle = static_cast<std::size_t>(next);
  }
  at.weight = notNegative(at.weight);
  at.weight /= at.weight.sum();
  return at;
}

/// Two directions along a plane that turn little where its normal does: the smallest rotation from +y to the normal
/// takes x and z there. They turn fast near -y.
std::array<Vec3, 2> alongPlane(const Vec3& n) {
  const double a = 1.0 / std::max(1.0 + n[1], 1e-6);
  return {Vec3(1.0 - n[0] * n[0] * a, -n[0], -n[0] * n[2] * a), Vec3(-n[0] * n[2] * a, -n[2], 1.0 - n[2] * n[2] * a)};
}

/// Adds a place's share to another. @return false: it has no room, nothing was added
bool addPlace(SolidSolver::Impulse& place, const SolidSolver::Impulse& more) {
  const auto end = place.node.begin() + static_cast<std::ptrdiff_t>(place.count);
  std::size_t room = SolidSolver::Impulse::maxNodes - place.count;
  for (std::size_t k = 0; k < more.count; ++k) {
    if (std::find(place.node.begin(), end, more.node[k]) != end) continue;
    if (room == 0) return false;
    --room;
  }
  for (std::size_t k = 0; k < more.count; ++k) addShare(place, more.node[k], more.weight[k]);
  return true;
}

}  // namespace

SolidSolver::Impulse pressedPatch(const Skin& skin, const std::array<int, 3>& node, const Vec3& weight, double radius) {
  const auto rest = [&](int n) { return skin.rest(n); };
  const Vec3 centre = pointAt(rest, node, weight);
  const std::array<Vec3, 2> along = alongPlane(smoothNormal(skin.surface(), rest, node, weight));
  const SkinPoint start{triangleOf(skin.surface(), node), weight};
  SolidSolver::Impulse patch = skin.influence(node, weight);
  for (std::size_t k = 0; k < patch.count; ++k) patch.weight[k] *= centrePoints;
  double points = centrePoints;
  for (const std::array<double, 2>& p : ringPoint) {
    const Vec3 target = centre + ringRadius * radius * (p[0] * along[0] + p[1] * along[1]);
    const SkinPoint at = walkTo(target, skin, start);
    const Index3& t = skin.surface().triangles()[at.triangle];
    if (addPlace(patch, skin.influence({t[0], t[1], t[2]}, at.weight))) points += 1.0;
  }
  for (std::size_t k = 0; k < patch.count; ++k) patch.weight[k] /= points;
  return patch;
}

}  // namespace calot
