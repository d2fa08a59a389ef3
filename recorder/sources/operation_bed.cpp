// SPDX-License-Identifier: GPL-3.0-or-later
// Freeing the specimen from its bed with the hook.
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

}  // namespace

/// A strand that is to go.
struct WorkingMind::BedStrand {
  std::size_t index = 0;
  double worth = 1.0;                               ///< of meeting it; those that are only to go later are worth less
  Vec3 middle = Vec3::Zero(), span = Vec3::Zero();  ///< span: from its end on the specimen to that on the liver
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

  /// Where a place lies between the stroke's corners: 0 at the first.
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
    const Vec3 d = s->middle - place;
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
      const Vec3 d = s.middle - place;
      const double along = d.dot(shaft), at = cornerOf(d);
      if (along > deep || along < deep - wireLength || at < 0.0 || at > static_cast<double>(legs)) continue;
      if (std::abs(d.dot(through) - offAt(at)) < tolerance) near.push_back(&s);
    }
    follow(near);
  }
  met.clear();
  for (const BedStrand* s : near) {
    const Vec3 d = s->middle - place;
    const double half = 0.5 * std::abs(through.dot(s->span));
    if (std::abs(d.dot(through) - offAt(cornerOf(d))) < half + wireRadius) met.push_back(s);
  }
}

/// The stroke that crosses most strands near the free edge, on the side of the hook and the neck. Only
/// some candidates are evaluated.
/// @pre one of `wanted` is worth 1
WorkingMind::BedStroke WorkingMind::bestStroke(const std::vector<BedStrand>& wanted) const {
  const PerformerHand& hook = tools_.hand[hand_];
  const auto inwards = [](const BedStrand& s) { return s.middle.x() + 0.2 * s.middle.y(); };
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
    const Vec3& place = strand.middle;
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
  const double length = fine ? fineLength : sweepLength;
  const double lead = fine ? 0.5 * fineLength : sweepLead;
  const std::size_t pieces = fine ? 1 : legs;
  const Vec3 across = fine && tries % 2U == 1 ? Vec3(-stroke.across) : stroke.across;
  const double deep = fine ? 0.002 + 0.002 * static_cast<double>(tries % 3U) : stroke.deep;
  const double aside = fineSpread * static_cast<double>(std::min(tries, 3U)) * random_.normal();
  std::array<double, legs + 1> off = stroke.off;
  if (fine) off.fill(0.0);
  for (double& o : off) o += aside;
  if (fine || stroke.met.empty()) ++tried_[stroke.strand];
  if (!fine) {
    for (const BedStrand* s : stroke.met) ++tried_[s->index];
  }
  const auto corner = [&](std::size_t c) {
    const double ahead = length * static_cast<double>(c) / static_cast<double>(pieces) - lead;
    return Vec3(stroke.place + error_ + deep * stroke.shaft + ahead * across + off[c] * stroke.through);
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
  stage_ = lowerThird ? Stage::clip : Stage::done;
  vessel_ = 0;
  strokes_ = 0;
  if (lowerThird) {
    clip(sight);
    return;
  }
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
    wanted.push_back(
        {s, later ? laterWorth : 1.0, 0.5 * (strand.end[0] + strand.end[1]), strand.end[1] - strand.end[0]});
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

}  // namespace calot::recorder
