// SPDX-License-Identifier: GPL-3.0-or-later
// Freeing the specimen from its bed with the hook.
// Clearing vessels and the triangle between them of fat.
#include <algorithm>
#include <array>
#include <cmath>

#include "recorder/sources/operation_mind.h"
#include "sim/math/linear.h"

namespace calot::recorder {
namespace {

constexpr double wireLength = 0.009;    // of the hook's wire along the shaft, that burns (m)
constexpr double sweepLength = 0.024;   // under current through connective tissue (m)
constexpr std::size_t legs = 4;         // straight pieces of a sweep, so that it follows the bed's curve
constexpr double sweepLead = 0.0015;    // of it before the first strand (m)
constexpr double offPlane = 0.006;      // strands that stand farther off a sweep's plane are not for it (m)
constexpr double wireRadius = 0.0006;   // m
constexpr double laterWorth = 0.4;      // of a strand that is met before its time
constexpr double edge = 0.015;          // so far from the free edge a sweep may begin (m)
constexpr double edgeWorth = 300.0;     // strands that it must meet more for a metre farther in
constexpr double wayWorth = 40.0;       // and for a metre of way to it
constexpr std::size_t mostLooked = 24;  // strokes that are weighed against each other
constexpr double retreat = 0.010;       // along the shaft, out of the bed, on the way to another place (m)
constexpr double straight = 0.025;      // places nearer than this are gone to without that (m)
constexpr double fineLength = 0.006;    // of a stroke at one strand (m)
constexpr double fineSpread = 0.0008;   // between one try at a strand and the next (m)
constexpr std::uint32_t fineAfter = 1;  // sweeps that missed a strand: it is gone at for itself,
constexpr std::ptrdiff_t few = 3;       // where no more than these are left around it
constexpr double fewLeft = 0.5;         // of what may stay on a vessel that counts as bare: the lower third is free
constexpr double lowerShare = 0.37;     // of the strands: the lower third of the bed, and a little more
constexpr std::uint32_t maxStrokes = 400;
constexpr std::uint32_t mostLast = 60;  // strokes, or looks, for the fat that holds at the end
constexpr double lastLook = 0.3;        // it waits for what tears by itself (s)
constexpr double lastHalf = 0.007;      // of a stroke through it (m)

}  // namespace

/// A strand that is to go.
struct WorkingMind::BedStrand {
  std::size_t index = 0;
  double worth = 1.0;                              ///< of meeting it; less where it is only to go later
  Vec3 cutAt = Vec3::Zero(), span = Vec3::Zero();  ///< span: from its end on the specimen to that on the liver
};

/// A stroke of the hook along the bed: its wire along the shaft, its way across it.
struct WorkingMind::BedStroke {
  Vec3 place = Vec3::Zero();  ///< where it meets the first strand
  Vec3 shaft = Vec3::UnitZ(), across = Vec3::UnitX(), through = Vec3::UnitY();
  double deep = 0.0;                   ///< of the hook's heel beyond `place`, along the shaft (m)
  std::array<double, legs + 1> off{};  ///< of its corners from its plane (m)
  std::vector<const BedStrand*> met;   ///< strands that it should cross
  double worth = -1e300;
  std::size_t strand = 0;

  /// Position between the stroke's corners: 0 at the first.
  [[nodiscard]] double cornerOf(const Vec3& d) const {
    return (d.dot(across) + sweepLead) / sweepLength * static_cast<double>(legs);
  }
  [[nodiscard]] double offAt(double corner) const {
    const double c = std::min(notNegative(corner), static_cast<double>(legs));
    const auto k = std::min(static_cast<std::size_t>(c), legs - 1);
    return off[k] + (c - static_cast<double>(k)) * (off[k + 1] - off[k]);
  }
  void follow(const std::vector<const BedStrand*>& near);
  void aim(const std::vector<BedStrand>& wanted);
};

/// Its corners come to lie in the middle of the strands around them.
void WorkingMind::BedStroke::follow(const std::vector<const BedStrand*>& near) {
  std::array<double, legs + 1> sum{}, count{};
  for (const BedStrand* s : near) {
    const Vec3 d = s->cutAt - place;
    const double at = cornerOf(d);
    for (std::size_t c = 0; c <= legs; ++c) {
      const double weight = 1.0 - std::abs(at - static_cast<double>(c));
      if (!(weight > 0.0)) continue;
      sum[c] += weight * d.dot(through);
      count[c] += weight;
    }
  }
  double last = 0.0;
  for (std::size_t c = 0; c <= legs; ++c) {
    if (count[c] > 0.0) last = sum[c] / count[c];
    off[c] = last;
  }
}

/// Finds its way, and what lies in it. The bed is curved: what stands far off the way that the first strand gives, is
/// left to another stroke.
void WorkingMind::BedStroke::aim(const std::vector<BedStrand>& wanted) {
  std::vector<const BedStrand*> near;
  off.fill(0.0);
  for (const double tolerance : {offPlane, 0.5 * offPlane}) {
    near.clear();
    for (const BedStrand& s : wanted) {
      const Vec3 d = s.cutAt - place;
      const double along = d.dot(shaft), at = cornerOf(d);
      if (along > deep || along < deep - wireLength || at < 0.0 || at > static_cast<double>(legs)) continue;
      if (std::abs(d.dot(through) - offAt(at)) < tolerance) near.push_back(&s);
    }
    follow(near);
  }
  met.clear();
  for (const BedStrand* s : near) {
    const Vec3 d = s->cutAt - place;
    const double half = 0.5 * std::abs(through.dot(s->span));
    if (std::abs(d.dot(through) - offAt(cornerOf(d))) < half + wireRadius) met.push_back(s);
  }
}

/// The stroke that crosses most strands near the free edge, on the side of the hook and the neck. Only
/// some candidates are evaluated.
/// @pre one of `wanted` is worth 1
WorkingMind::BedStroke WorkingMind::bestStroke(const std::vector<BedStrand>& wanted) const {
  const PerformerHand& hook = tools_.hand[hand_];
  const auto inwards = [](const BedStrand& s) { return s.cutAt.x() + 0.2 * s.cutAt.y(); };
  double outermost = 1e300;
  for (const BedStrand& s : wanted) {
    if (s.worth == 1.0) outermost = std::min(outermost, inwards(s));
  }
  std::vector<const BedStrand*> first;
  for (const BedStrand& s : wanted) {
    if (s.worth == 1.0 && inwards(s) - outermost < edge) first.push_back(&s);
  }
  const std::size_t every = (first.size() + mostLooked - 1) / mostLooked;
  BedStroke best;
  for (std::size_t f = strokes_ % every; f < first.size(); f += every) {
    const BedStrand& strand = *first[f];
    const Vec3& place = strand.cutAt;
    const double in = inwards(strand) - outermost;
    BedStroke stroke;
    stroke.strand = strand.index;
    stroke.place = place;
    stroke.shaft = hook.shaft(place);
    Vec3 across = stroke.shaft.cross(strand.span);
    if (across.norm() < 1e-9) across = stroke.shaft.cross(Vec3::UnitZ());
    across /= across.norm();
    stroke.across = across.x() < 0.0 ? Vec3(-across) : across;
    stroke.through = stroke.across.cross(stroke.shaft);
    const double way = (place - hook.meant()).norm();
    for (const double deep : {0.002, 0.005, 0.008}) {
      stroke.deep = deep;
      stroke.aim(wanted);
      stroke.worth = -edgeWorth * in - wayWorth * way;
      for (const BedStrand* s : stroke.met) stroke.worth += s->worth / (1.0 + static_cast<double>(tried_[s->index]));
      if (stroke.worth > best.worth) best = stroke;
    }
  }
  return best;
}

void WorkingMind::runStroke(const BedStroke& stroke) {
  const PerformerProfile& profile = tools_.profile;
  newError();
  error_ *= 0.25;
  const std::uint32_t tries = tried_[stroke.strand];
  // Strands that sweeps have missed are cut individually through their middle with shorter, slower strokes, alternating
  // in position and direction.
  const auto worth = [](const BedStrand* s) { return s->worth == 1.0; };
  const bool fine = tries >= fineAfter && std::count_if(stroke.met.begin(), stroke.met.end(), worth) <= few;
  double last = 0.0;
  for (const BedStrand* s : stroke.met) last = std::max(last, (s->cutAt - stroke.place).dot(stroke.across));
  const double length = fine ? fineLength : std::min(sweepLength, sweepLead + last + profile.operation.overrun);
  const double lead = fine ? 0.5 * fineLength : sweepLead;
  const double share = length / sweepLength;
  const std::size_t pieces = fine ? 1 : static_cast<std::size_t>(std::ceil(share * static_cast<double>(legs)));
  const Vec3 across = fine && tries % 2U == 1 ? Vec3(-stroke.across) : stroke.across;
  const double deep = fine ? 0.002 + 0.002 * static_cast<double>(tries % 3U) : stroke.deep;
  const double aside = fineSpread * static_cast<double>(std::min(tries, 3U)) * random_.normal();
  if (fine || stroke.met.empty()) ++tried_[stroke.strand];
  if (!fine) {
    for (const BedStrand* s : stroke.met) ++tried_[s->index];
  }
  const auto corner = [&](std::size_t c) {
    const double along = static_cast<double>(c) / static_cast<double>(pieces);
    const double off = aside + (fine ? 0.0 : stroke.offAt(along * share * static_cast<double>(legs)));
    return Vec3(stroke.place + error_ + deep * stroke.shaft + (length * along - lead) * across + off * stroke.through);
  };
  HandMove move;
  move.aiming = HandMove::Aim::forward;
  move.aim = across;
  // To and fro: it begins at the end that is nearer.
  const Vec3 here = hand().meant();
  const bool back = !fine && (corner(pieces) - here).norm() < (corner(0) - here).norm();
  const Vec3 first = corner(back ? pieces : 0);
  if ((first - here).norm() > straight) {
    const Vec3 beside = back ? Vec3(Vec3::Zero()) : Vec3(0.4 * retreat * across);
    go(here - retreat * hand().shaft(here) - beside, profile.motor.strokeSpeed, 0.0);
    move.to = first - retreat * stroke.shaft - beside;
    move.speed = profile.motor.strokeSpeed;
    hand().add(move);
  }
  move.to = first;
  move.speed = (first - hand().meant()).norm() > retreat ? profile.motor.strokeSpeed : profile.motor.contactSpeed;
  hand().add(move);
  move.steady = true;
  move.speed = (fine ? 0.5 : 1.0) * profile.operation.burnSpeed;
  move.buttons = button::coagulatePedal;
  for (std::size_t c = 1; c <= pieces; ++c) {
    move.to = corner(back ? pieces - c : c);
    if (c == pieces) move.dwell = std::max(0.0, profile.operation.pedalLag * (1.0 + 0.3 * random_.normal()));
    hand().add(move);
  }
}

void WorkingMind::leaveBed(const Sight& sight, bool lowerThird) {
  stage_ = lowerThird ? Stage::clip : Stage::last;
  vessel_ = 0;
  strokes_ = 0;
  lowerThird ? clip(sight) : divideLast(sight);
}

/// The hook divides fat that the other hand draws out, nearest first and across the pull; strings part by themselves.
void WorkingMind::divideLast(const Sight& sight) {
  if (sight.held && tools_.anatomy.divides() && strokes_ < mostLast) {
    if (mount(InstrumentKind::hook, 0.0)) return;
    ++strokes_;
    if (sight.tether.empty()) {
      hand().add({.to = hand().meant(), .dwell = lastLook, .sure = true});
      return;
    }
    newError();
    error_ *= 0.25;
    const SeenTether& tether = sight.tether[(strokes_ - 1) % sight.tether.size()];
    const Vec3 shaft = hand().shaft(tether.place);
    Vec3 side = shaft.cross(tools_.scene.camera.orientation * Vec3::UnitY());
    side /= std::max(side.norm(), 1e-9);
    const Vec3 middle = tether.place + (std::min(tether.depth, wireLength) + sweepLead) * shaft + error_;
    const double sign = strokes_ % 2U == 0 ? -1.0 : 1.0;
    strokeThrough({middle - sign * lastHalf * side, middle + sign * lastHalf * side}, sign * side, retreat);
    return;
  }
  failed_ = failed_ || (sight.held && tools_.anatomy.divides());
  stage_ = Stage::done;
  const Vec3 here = hand().meant();
  go(here - 0.02 * hand().shaft(here), tools_.profile.motor.contactSpeed, 0.0);
  go(tools_.scene.hands[hand_].home, tools_.profile.motor.strokeSpeed, 0.0);
}

void WorkingMind::burn(const Sight& sight, bool lowerThird) {
  std::vector<BedStrand> wanted;
  double all = 0.0, left = 0.0;
  for (std::size_t s = 0; s < sight.strand.size(); ++s) {
    const bool later = lowerThird && share_[s] > lowerShare;
    if (!later) all += 1.0;
    const SeenStrand& strand = sight.strand[s];
    if (!strand.attached) continue;
    if (!later) left += 1.0;
    const Vec3 span = strand.end[1] - strand.end[0];
    wanted.push_back({s, later ? laterWorth : 1.0, strand.end[0] + tools_.profile.operation.plane * span, span});
  }
  // A few strands of the lower third may wait until the rest of the bed is freed.
  if (left == 0.0 || (lowerThird && left < fewLeft * (1.0 - tools_.profile.operation.bareShare) * all)) {
    leaveBed(sight, lowerThird);
    return;
  }
  if (mount(InstrumentKind::hook, 0.0)) return;
  runStroke(bestStroke(wanted));
  ++strokes_;
  if (strokes_ > maxStrokes) {
    failed_ = true;
    stage_ = Stage::done;
  }
}

namespace {

constexpr double hookToe = 0.0023;      // from the hook's heel to the middle of its toe (m)
constexpr double hookWire = 0.0006;     // radius of the hook's wire (m)
constexpr double film = 0.0006;         // of fat on a vessel that counts as none (m)
constexpr double laneLength = 0.014;    // of a stroke along a vessel (m)
constexpr double legLength = 0.006;     // of its straight pieces (m)
constexpr double clearance = 0.002;     // above the fat, on the way from one stroke to the next (m)
constexpr double clearFrom = 0.22;      // of a vessel's length: nearer to where it springs from, others are near
constexpr double comeFrom = 0.0055;     // beside a vessel: there the toe goes down and up that works under it (m)
constexpr std::uint32_t mostTried = 2;  // strokes for one place: what they leave is left
constexpr std::size_t over = 0;         // lanes: over the vessel, the others beside and under it

}  // namespace

/// A stroke along a vessel.
struct WorkingMind::FatStroke {
  std::size_t first = 0, last = 0;  ///< stations
  std::size_t lane = over;
  double height = 0.0;  ///< of the fat that is to go, from the centre line (m)
};

/// The highest fat that is in the way, and the stroke for it. @return share of the stations that are bare
double WorkingMind::highestFat(const SeenVessel& vessel, double radius, FatStroke& stroke) const {
  const auto count = static_cast<double>(vessel.centre.size());
  const auto from = static_cast<std::size_t>(clearFrom * count);
  const double end = (clearFrom + tools_.profile.operation.cleared) * count;
  const std::size_t to = std::min(static_cast<std::size_t>(end), vessel.centre.size() - 1);
  double bare = 0.0;
  std::size_t worst = from;
  stroke.height = 0.0;
  for (std::size_t s = from; s <= to; ++s) {
    bool clean = true;
    for (std::size_t l = 0; l < vessel.fat[s].size(); ++l) {
      const double height = vessel.fat[s][l] - (l == over ? radius + film : 0.0);
      if (height <= 0.0) continue;
      clean = false;
      if (!(height > stroke.height) || fatTried_[l][s] >= mostTried) continue;
      stroke.height = height;
      stroke.lane = l;
      worst = s;
    }
    bare += clean ? 1.0 : 0.0;
  }
  const auto length = static_cast<std::size_t>(laneLength / PerformerSight::spacing);
  const std::size_t begin = worst > length / 2 ? worst - length / 2 : 0;
  stroke.last = std::min(std::max(begin, from) + length, to);
  stroke.first = std::max(from, stroke.last > length ? stroke.last - length : 0);
  if (stroke.height > 0.0) stroke.height = vessel.fat[worst][stroke.lane];
  return bare / static_cast<double>(to - from + 1);
}

void WorkingMind::clear(const Sight& sight) {
  const PerformerProfile::Operation& operation = tools_.profile.operation;
  if (!tools_.anatomy.hasFat() || vessel_ >= sight.vessel.size()) {
    vessel_ = 0;
    strokes_ = 0;
    stage_ = Stage::window;
    window(sight);
    return;
  }
  if (mount(InstrumentKind::hook, 0.0)) return;
  if (searched_ < operation.searches) {
    for (std::uint32_t i = 0; i < operation.series && searched_ < operation.searches; ++i) search(sight);
    return;
  }
  SeenVessel vessel = sight.vessel[vessel_];
  for (std::vector<std::uint32_t>& tried : fatTried_) tried.resize(vessel.centre.size(), 0);
  const double radius = tools_.anatomy.vessels()[vessel_].radius;
  std::uint32_t made = 0;
  for (; made < operation.series; ++made) {
    FatStroke stroke;
    const double bare = highestFat(vessel, radius, stroke);
    if (bare >= operation.bareShare || strokes_ >= operation.strokes || stroke.height <= 0.0) break;
    ++strokes_;
    runStroke(stroke, vessel, radius);
    // It is taken to succeed until the next picture.
    for (std::size_t s = stroke.first; s <= stroke.last; ++s) {
      ++fatTried_[stroke.lane][s];
      double& height = vessel.fat[s][stroke.lane];
      height = stroke.lane == over ? std::min(height, stroke.height - operation.layer) : -1.0;
    }
  }
  if (made > 0) return;
  ++vessel_;
  strokes_ = searched_ = 0;
  for (std::vector<std::uint32_t>& tried : fatTried_) tried.clear();
  clear(sight);
}

/// Over a vessel the toe lies across it, and takes a layer. Beside it the wire takes all that stands there, with the
/// toe under the vessel; the hook goes down and comes up off it.
void WorkingMind::runStroke(const FatStroke& stroke, const SeenVessel& vessel, double radius) {
  const PerformerProfile::Operation& operation = tools_.profile.operation;
  newError();
  error_ *= 0.25;
  const double off = radius + hookWire + operation.keepOff;
  const double height = stroke.lane == over ? std::max(stroke.height - operation.layer, off) : -off;
  const double sign = stroke.lane == 1 ? -1.0 : 1.0;
  double top = height;
  for (std::size_t s = stroke.first; s <= stroke.last; ++s) {
    for (const double fat : vessel.fat[s]) top = std::max(top, fat);
  }
  const auto at = [&](std::size_t s, double aside) {
    const Vec3 shaft = hand().shaft(vessel.centre[s]);
    Vec3 side = shaft.cross(vessel.along[s]);
    side /= side.norm();
    return Vec3(vessel.centre[s] + aside * side - height * shaft + error_);
  };
  const std::size_t stations = stroke.last - stroke.first;
  const auto legs = static_cast<std::size_t>(
      std::max(1.0, std::floor(static_cast<double>(stations) * PerformerSight::spacing / legLength + 0.5)));
  const bool back = strokes_ % 2U == 0;
  std::vector<Vec3> way;
  for (std::size_t k = 0; k <= legs; ++k) {
    const std::size_t s = stroke.first + stations * (back ? legs - k : k) / legs;
    const bool end = k == 0 || k == legs;
    if (stroke.lane != over && k == 0) way.push_back(at(s, sign * (off + comeFrom)));
    way.push_back(at(s, stroke.lane == over ? -hookToe : sign * off));
    if (stroke.lane != over && end && k > 0) way.push_back(at(s, sign * (off + comeFrom)));
  }
  const std::size_t middle = (stroke.first + stroke.last) / 2;
  Vec3 side = hand().shaft(vessel.centre[middle]).cross(vessel.along[middle]);
  side /= side.norm();
  strokeThrough(way, stroke.lane == over ? side : Vec3(-sign * side), top - height + clearance);
}

/// A stroke of the hook under current, from above through all of `way`, and up again.
void WorkingMind::strokeThrough(const std::vector<Vec3>& way, const Vec3& aim, double lift) {
  const PerformerProfile& profile = tools_.profile;
  HandMove move;
  move.aiming = HandMove::Aim::forward;
  move.aim = aim;
  move.to = way.front() - lift * hand().shaft(way.front());
  move.speed = profile.motor.strokeSpeed;
  hand().add(move);
  move.buttons = button::cutPedal;
  move.steady = true;
  move.speed = profile.motor.workSpeed;
  for (const Vec3& corner : way) {
    move.to = corner;
    hand().add(move);
  }
  move.to = way.back() - lift * hand().shaft(way.back());
  move.dwell = std::max(0.0, profile.operation.pedalLag * (1.0 + 0.3 * random_.normal()));
  hand().add(move);
}

}  // namespace calot::recorder
