// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/step/tissue_effects.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/geometry/closest_point.h"
#include "sim/geometry/triangle_mesh.h"
#include "sim/step/contact_block.h"
#include "sim/step/placed_instrument.h"

namespace calot {

void sweepHooks(const Model& model, const InstrumentTravels& travels, const State& state, HookSweeps& sweeps) {
  for (std::size_t hand = 0; hand < handCount; ++hand) {
    HookSweep& sweep = sweeps[hand];
    sweep.electrode.clear();
    sweep.piece.clear();
    sweep.hand = hand;
    const HandState& h = state.hand[hand];
    const CauteryDescription& cautery = model.scene().cautery;
    sweep.pace = currentPace(cautery, h);
    if (!(sweep.pace > 0.0)) continue;
    sweep.charring = (h.input.buttons & button::cutPedal) != 0 ? cautery.cutChar : 1.0;
    const HandDescription& description = model.scene().hands[hand];
    const Pose now = simulatedPose(h.instrument);
    const InstrumentShape hook = instrumentShape(h.instrument.kind, h.instrument.jaw, description.shaftRadius,
                                                 (now.position - description.port).norm());
    const InstrumentShape before = placed(hook, travels[hand].before);
    const InstrumentShape after = placed(hook, now);
    for (std::size_t k = 0; k < after.capsules().size(); ++k) {
      const Capsule& from = before.capsules()[k];
      const Capsule& to = after.capsules()[k];
      if (to.part != Capsule::Part::electrode) continue;
      sweep.electrode.push_back({{from.p0, from.p1}, {to.p0, to.p1}, to.radius});
      sweep.piece.push_back(to.piece);
    }
  }
}

void takeOutOfDimples(const HookSweep& sweep, std::size_t structure, const State& state, HookSweep& out) {
  out = sweep;
  for (std::size_t k = 0; k < out.electrode.size(); ++k) {
    const Vec3 dimple = dimpleOf(state.hand[sweep.hand].touches, structure, out.piece[k]);
    for (Vec3& end : out.electrode[k].before) end += dimple;
    for (Vec3& end : out.electrode[k].now) end += dimple;
  }
}

namespace {

/// Tissue that moves further in a step is not looked for where it came from (m). Larger: more triangles are searched
/// after a jerk. Assumed: hands' slowest jerk, 0.5 m/s in 10 ms.
constexpr double maxTissueWay = 0.005;

/// Most of any node in a step (m).
double tissueWay(std::span<const Vec3> velocity, double step) {
  double speed2 = 0.0;
  for (const Vec3& v : velocity) speed2 = std::max(speed2, v.squaredNorm());
  return std::min(std::sqrt(speed2) * step, maxTissueWay);
}

/// Triangles of fat are as large as what the wire touches: their area is sampled in the cells of this division.
constexpr std::uint32_t fatDivision = 2;

/// May a triangle come within `far` of the electrode in this step?
bool mayTouch(const HookSweep& sweep, double far, const Vec3& a, const Vec3& b, const Vec3& c) {
  return std::any_of(sweep.electrode.begin(), sweep.electrode.end(), [&](const MovingCapsule& part) {
    const double moved = std::max((part.now[0] - part.before[0]).norm(), (part.now[1] - part.before[1]).norm());
    const double limit = part.radius + far + moved;
    return closestSegmentTriangle(part.now[0], part.now[1], a, b, c).squaredDistance <= limit * limit;
  });
}

/// Share of the step in which a point is touched by any part of the electrode.
double shareOf(const HookSweep& sweep, const MovingPoint& point, double reach) {
  StepIntervals touched;
  for (const MovingCapsule& part : sweep.electrode) touched.add(near(part, point, reach));
  return touched.length();
}

Vec3 velocityOf(const Skin& skin, std::span<const Vec3> velocity, const Index3& corner, const Vec3& weight) {
  return skin.influence({corner[0], corner[1], corner[2]}, weight).of(velocity);
}

}  // namespace

void HookTouchSearch::findTriangles(const HookSweep& sweep, std::size_t structure, const Bodies& bodies,
                                    const Surfaces& surfaces, const State& state) {
  const double reach = model_.scene().cautery.reach +
                       tissueWay(bodies[model_.structures()[structure].body].velocity(state), bodies.step());
  const ContactSurface& mesh = surfaces.mesh(structure);
  const std::vector<Vec3>& points = surfaces.points(structure);
  triangle_.clear();
  for (const MovingCapsule& part : sweep.electrode) {
    const double moved = std::max((part.now[0] - part.before[0]).norm(), (part.now[1] - part.before[1]).norm());
    const Box box = boundsOf(part, reach);
    for (const std::uint32_t p :
         surfaces.patchesNear(structure, part.now[0], part.now[1], part.radius + reach + moved, search_)) {
      for (std::size_t t = mesh.patches()[p].first; t < mesh.patches()[p].last; ++t) {
        Box own;
        for (int k = 0; k < 3; ++k) own.include(points[static_cast<std::size_t>(mesh.triangles()[t][k])]);
        if (own.overlaps(box)) triangle_.push_back(static_cast<std::uint32_t>(t));
      }
    }
  }
  std::sort(triangle_.begin(), triangle_.end());
  triangle_.erase(std::unique(triangle_.begin(), triangle_.end()), triangle_.end());
}

void HookTouchSearch::touchConnective(const HookSweep& sweep, double step, const State& state, HookTouches& out) const {
  for (std::size_t c = 0; c < model_.connective().size(); ++c) {
    const ConnectiveModel& tie = model_.connective()[c];
    const SolidState& a = state.organ[tie.a];
    const SolidState& b = state.organ[tie.b];
    touchStrands(tie.tissue, state.connective[c], {a.position, a.velocity}, {b.position, b.velocity}, sweep.electrode,
                 model_.scene().cautery.reach, step, out.strand[c]);
    for (const StrandTouch& touch : out.strand[c]) out.area += touch.share * tie.tissue.strands()[touch.strand].area;
  }
}

void HookTouchSearch::touchOrgan(const HookSweep& sweep, std::size_t structure, const Bodies& bodies,
                                 const Surfaces& surfaces, const State& state, HookTouches& out) {
  const StructureModel& s = model_.structures()[structure];
  const OrganModel& organ = model_.organs()[s.index];
  const double reach = model_.scene().cautery.reach;
  findTriangles(sweep, structure, bodies, surfaces, state);
  const std::vector<Vec3>& points = surfaces.points(structure);
  const std::span<const Vec3> velocity = bodies[s.body].velocity(state);
  const double way = tissueWay(velocity, bodies.step());
  for (const std::uint32_t t : triangle_) {
    const Index3& corner = organ.surface.triangles()[t];
    if (!mayTouch(sweep, reach + way, points[static_cast<std::size_t>(corner[0])],
                  points[static_cast<std::size_t>(corner[1])], points[static_cast<std::size_t>(corner[2])])) {
      continue;
    }
    std::array<MovingPoint, 3> at;
    for (int k = 0; k < 3; ++k) {
      const Vec3& now = points[static_cast<std::size_t>(corner[k])];
      const Vec3 moved = bodies.step() * velocityOf(surfaces.skin(structure), velocity, corner, Vec3::Unit(k));
      at[static_cast<std::size_t>(k)] = {now - moved, now};
    }
    const std::uint32_t n = organ.division[t];
    const double area = organ.triangleArea[t] / (n * n);
    forEachTriangleCell(n, [&](std::uint32_t cell, const Vec3& weight) {
      MovingPoint point;
      for (int k = 0; k < 3; ++k) {
        point.before += weight[k] * at[static_cast<std::size_t>(k)].before;
        point.now += weight[k] * at[static_cast<std::size_t>(k)].now;
      }
      const double share = shareOf(sweep, point, reach);
      if (!(share > 0.0)) return;
      out.cell.push_back({static_cast<std::uint32_t>(structure), t, cell, share});
      out.area += share * area;
    });
  }
}

/// A station is touched where the wall on the electrode's side is. The area is that of a strip of wall as wide as what
/// the electrode touches of a plane, at most the vessel's diameter.
void HookTouchSearch::touchVessel(const HookSweep& sweep, std::size_t structure, const Bodies& bodies,
                                  const State& state, HookTouches& out) const {
  const StructureModel& s = model_.structures()[structure];
  const BeamModel& beams = model_.vesselTrees()[s.index].beams;
  const BeamState& vessels = state.vessel[s.index];
  const BeamModel::Branch& branch = beams.branches()[s.branch];
  const double outer = branch.section.outerRadius;
  const double reach = model_.scene().cautery.reach;
  std::size_t station = 0;
  for (std::size_t i = 0; i < branch.elements(); ++i) {
    const std::size_t first = station;
    while (station < branch.stations && branch.arcLengthOf(station) < branch.arcLength[i + 1]) ++station;
    const std::size_t e = branch.firstElement + i;
    if (vessels.parting[e] != Parting::none) continue;
    const auto a = static_cast<std::size_t>(beams.elements()[e].a);
    const auto b = static_cast<std::size_t>(beams.elements()[e].b);
    Box chord;
    for (const std::size_t n : {a, b}) {
      chord.include(vessels.position[n]);
      chord.include(vessels.position[n] - bodies.step() * vessels.velocity[n]);
    }
    chord.grow(outer);
    const bool far = std::none_of(sweep.electrode.begin(), sweep.electrode.end(),
                                  [&](const MovingCapsule& part) { return chord.overlaps(boundsOf(part, reach)); });
    if (far) continue;
    const Vec3 along = vessels.position[b] - vessels.position[a];
    for (std::size_t k = first; k < station; ++k) {
      const double t = (branch.arcLengthOf(k) - branch.arcLength[i]) / (branch.arcLength[i + 1] - branch.arcLength[i]);
      const Vec3 centre = vessels.position[a] + t * along;
      const Vec3 moved = bodies.step() * ((1.0 - t) * vessels.velocity[a] + t * vessels.velocity[b]);
      StepIntervals touched;
      double width = 0.0;
      for (const MovingCapsule& part : sweep.electrode) {
        const Vec3 c0 = 0.5 * (part.before[0] + part.now[0]);
        const Vec3 c1 = 0.5 * (part.before[1] + part.now[1]);
        const Vec3 middle = centre - 0.5 * moved;
        Vec3 towards = c0 + closestOnSegment(middle, c0, c1) * (c1 - c0) - middle;
        towards -= (towards.dot(along) / along.squaredNorm()) * along;
        const double distance = towards.norm();
        const Vec3 wall = distance > outer ? Vec3(centre + (outer / distance) * towards) : Vec3(centre + towards);
        const StepInterval when = near(part, MovingPoint{wall - moved, wall}, reach);
        touched.add(when);
        if (!when.empty()) width = std::max(width, 2.0 * std::min(outer, part.radius + reach));
      }
      if (touched.empty()) continue;
      out.station.push_back({static_cast<std::uint32_t>(structure), static_cast<std::uint32_t>(k), touched.length()});
      out.area += touched.length() * branch.spacing() * width;
    }
  }
}

void HookTouchSearch::touchFat(const HookSweep& sweep, std::size_t structure, const Bodies& bodies,
                               const Surfaces& surfaces, const State& state, HookTouches& out) {
  const StructureModel& s = model_.structures()[structure];
  findTriangles(sweep, structure, bodies, surfaces, state);
  const std::vector<Vec3>& points = surfaces.points(structure);
  const std::span<const Vec3> velocity = bodies[s.body].velocity(state);
  double area = 0.0;
  for (const std::uint32_t t : triangle_) {
    const Index3& corner = surfaces.mesh(structure).triangles()[t];
    const Vec3& a = points[static_cast<std::size_t>(corner[0])];
    const Vec3& b = points[static_cast<std::size_t>(corner[1])];
    const Vec3& c = points[static_cast<std::size_t>(corner[2])];
    const Vec3 moved =
        bodies.step() * velocityOf(surfaces.skin(structure), velocity, corner, Vec3::Constant(1.0 / 3.0));
    const double part = (b - a).cross(c - a).norm() / (2.0 * fatDivision * fatDivision);
    forEachTriangleCell(fatDivision, [&](std::uint32_t /*cell*/, const Vec3& weight) {
      const Vec3 centre = weight[0] * a + (weight[1] * b + weight[2] * c);
      area += part * shareOf(sweep, {centre - moved, centre}, model_.scene().cautery.reach);
    });
  }
  out.fat[s.index] = area;
  out.area += area;
}

void HookTouchSearch::run(const HookSweep& sweep, Bodies& bodies, const Surfaces& surfaces, const State& state,
                          HookTouches& out) {
  out.strand.resize(model_.connective().size());
  for (std::vector<StrandTouch>& strands : out.strand) strands.clear();
  out.cell.clear();
  out.station.clear();
  out.fat.assign(model_.fat().size(), 0.0);
  out.area = 0.0;
  if (!sweep.energised()) return;
  touchConnective(sweep, bodies.step(), state, out);
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    const TissueId kind = model_.structures()[s].kind;
    if (kind == tissueId<OrganTissue>) {
      takeOutOfDimples(sweep, s, state, met_);
      touchOrgan(met_, s, bodies, surfaces, state, out);
    }
    if (kind == tissueId<VesselTissue>) touchVessel(sweep, s, bodies, state, out);
    if (kind == tissueId<FatTissue>) {
      takeOutOfDimples(sweep, s, state, met_);
      touchFat(met_, s, bodies, surfaces, state, out);
    }
  }
}

}  // namespace calot
