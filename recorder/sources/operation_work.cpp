// SPDX-License-Identifier: GPL-3.0-or-later
// The four works of the operation: clearing, freeing, clipping, cutting.
#include <algorithm>
#include <array>
#include <cmath>

#include "recorder/sources/operation_mind.h"

namespace calot::recorder {
namespace {

constexpr double toe = 0.0023;         // from the hook's heel to the middle of its toe (m)
constexpr double wire = 0.0006;        // radius of the hook's wire (m)
constexpr double film = 0.0006;        // of fat on a vessel that counts as none (m)
constexpr double wireLength = 0.009;   // of the hook's wire along the shaft, that burns (m)
constexpr double sweepLength = 0.008;  // under current through connective tissue (m)
constexpr double sweepLead = 0.0015;  // of it before the first strand (m)
constexpr double laneLength = 0.012;   // m
constexpr double lowerShare = 0.37;    // of the strands: the lower third of the bed, and a little more
constexpr double clipJaw = 0.55;       // rad
constexpr double clipDepth = 0.0043;   // the vessel comes to lie so far behind the tips (m)
constexpr double bladeJaw = 0.95;      // rad
constexpr double bladeDepth = 0.006;   // m
constexpr double bladeTrial = 0.0012;  // by how much depths of one try and the next differ (m)
constexpr double hover = 0.014;        // m
constexpr double clipSpacing = 0.003;
constexpr std::uint32_t mostTries = 6;

/// Stations between which a vessel is cleared, clipped and cut, as shares of its length.
constexpr double clearFrom = 0.22;
constexpr double clearTo = 0.72;
constexpr double firstClip = 0.30;
constexpr double cutAt = 0.52;
constexpr double lastClip = 0.64;

/// Strands that one sweep meets, and how far their middles stand off the plane of sweep at its start and its end.
struct Band {
  double deep = 0.0, met = -1.0;
  std::array<double, 2> sum{}, count{};

  void add(double across, double off) {
    if (across < -sweepLead || across > sweepLength) return;
    met += 1.0;
    const std::size_t half = across < 0.5 * sweepLength ? 0 : 1;
    sum[half] += off;
    count[half] += 1.0;
  }
  [[nodiscard]] double offset(std::size_t half) const {
    if (count[half] > 0.0) return sum[half] / count[half];
    return count[1 - half] > 0.0 ? sum[1 - half] / count[1 - half] : 0.0;
  }
};

}  // namespace

void WorkingMind::clear(const Sight& sight) {
  const PerformerProfile::Operation& operation = tools_.profile.operation;
  if (!tools_.anatomy.hasFat() || vessel_ >= sight.vessel.size()) {
    vessel_ = 0;
    strokes_ = 0;
    stage_ = Stage::lowerThird;
    burn(sight, true);
    return;
  }
  if (mount(InstrumentKind::hook, 0.0)) return;
  const SeenVessel& vessel = sight.vessel[vessel_];
  const double radius = tools_.anatomy.vessels()[vessel_].radius;
  const auto count = static_cast<double>(vessel.centre.size());
  const auto from = static_cast<std::size_t>(clearFrom * count);
  const auto to = static_cast<std::size_t>(clearTo * count);
  // The highest fat that is in the way.
  std::size_t worst = from, lane = 0;
  double most = 0.0;
  double bare = 0.0, all = 0.0;
  for (std::size_t s = from; s <= to; ++s) {
    bool clean = true;
    for (std::size_t l = 0; l < 3; ++l) {
      const double height = vessel.fat[s][l] - (l == 0 ? radius + film : 0.0);
      if (height <= 0.0) continue;
      clean = false;
      if (!(height > most)) continue;
      most = height;
      worst = s;
      lane = l;
    }
    all += 1.0;
    bare += clean ? 1.0 : 0.0;
  }
  if (bare >= operation.bareShare * all || strokes_ >= operation.strokes) {
    ++vessel_;
    strokes_ = 0;
    clear(sight);
    return;
  }
  ++strokes_;
  newError();
  error_ *= 0.25;
  const Vec3& centre = vessel.centre[worst];
  const Vec3& along = vessel.along[worst];
  const Vec3 shaft = hand().shaft(centre);
  Vec3 side = shaft.cross(along);
  side /= side.norm();
  const Vec3 level = side.cross(shaft);
  const double floor = lane == 0 ? radius + wire + operation.keepOff : -0.0005;
  const double height = std::max(vessel.fat[worst][lane] - operation.layer, floor);
  const double aside = lane == 0 ? 0.0 : (lane == 1 ? -1.0 : 1.0) * (radius + wire + operation.keepOff + 0.0005);
  const double way = (strokes_ % 2U) == 0 ? 1.0 : -1.0;
  const auto at = [&](double s) { return Vec3(centre + aside * side - height * shaft + s * level + error_); };
  const double half = 0.5 * laneLength * way;
  if (lane == 0) {
    sweep(at(-half) - toe * side, at(half) - toe * side, HandMove::Aim::forward, side);
  } else {
    sweep(at(-half) - toe * level, at(half) - toe * level, HandMove::Aim::forward, level);
  }
}

void WorkingMind::burn(const Sight& sight, bool lowerThird) {
  const auto next = [&] {
    stage_ = lowerThird ? Stage::clip : Stage::done;
    vessel_ = 0;
    strokes_ = 0;
  };
  const auto middleOf = [&](std::size_t s) { return Vec3(0.5 * (sight.strand[s].end[0] + sight.strand[s].end[1])); };
  const auto wanted = [&](std::size_t s) {
    return sight.strand[s].attached && (!lowerThird || share_[s] <= lowerShare);
  };
  // From the free edge inwards: the side from which the hook comes, and the neck.
  double best = 1e300;
  std::size_t chosen = sight.strand.size();
  for (std::size_t s = 0; s < sight.strand.size(); ++s) {
    if (!wanted(s)) continue;
    const Vec3 middle = middleOf(s);
    const double key = middle.x() + 0.2 * middle.y() + 0.3 * (middle - hand().meant()).norm();
    if (!(key < best)) continue;
    best = key;
    chosen = s;
  }
  if (chosen == sight.strand.size()) {
    next();
    if (stage_ == Stage::clip) {
      clip(sight);
    } else {
      const Vec3 here = hand().meant();
      go(here - 0.02 * hand().shaft(here), tools_.profile.motor.contactSpeed, 0.0);
      go(tools_.scene.hands[hand_].home, tools_.profile.motor.strokeSpeed, 0.0);
    }
    return;
  }
  if (mount(InstrumentKind::hook, 0.0)) return;
  const PerformerProfile& profile = tools_.profile;
  const Vec3 place = middleOf(chosen);
  const Vec3 shaft = hand().shaft(place);
  Vec3 across = sight.strand[chosen].end[1] - sight.strand[chosen].end[0];
  across = shaft.cross(across);
  if (across.norm() < 1e-9) across = shaft.cross(Vec3::UnitZ());
  across /= across.norm();
  if (across.x() < 0.0) across = -across;
  Vec3 through = across.cross(shaft);
  through /= through.norm();
  // The hook's wire runs along the shaft: as deep as it meets most strands at once. The sweep follows their middles.
  Band band;
  for (const double deep : {0.002, 0.005, 0.008}) {
    Band found;
    found.deep = deep;
    for (std::size_t s = 0; s < sight.strand.size(); ++s) {
      if (!wanted(s)) continue;
      const Vec3 d = middleOf(s) - place;
      const double along = d.dot(shaft);
      if (along < deep && along > deep - wireLength) found.add(d.dot(across), d.dot(through));
    }
    if (found.met > band.met) band = found;
  }
  newError();
  error_ *= 0.25;
  const Vec3 start = place + band.deep * shaft + error_;
  const Vec3 from = start - sweepLead * across + band.offset(0) * through;
  const Vec3 to = start + (sweepLength - sweepLead) * across + band.offset(1) * through;
  HandMove move;
  move.aiming = HandMove::Aim::forward;
  move.aim = across;
  if ((from - hand().meant()).norm() > 0.010) {
    const Vec3 here = hand().meant();
    go(here - 0.010 * hand().shaft(here) - 0.004 * across, profile.motor.contactSpeed, 0.0);
    move.to = from - 0.010 * shaft - 0.004 * across;
    move.speed = profile.motor.strokeSpeed;
    hand().add(move);
  }
  move.to = from;
  move.speed = profile.motor.contactSpeed;
  hand().add(move);
  move.to = to;
  move.steady = true;
  move.speed = profile.operation.burnSpeed;
  move.buttons = button::coagulatePedal;
  move.dwell = std::max(0.0, profile.operation.pedalLag * (1.0 + 0.3 * random_.normal()));
  hand().add(move);
  ++strokes_;
  if (strokes_ > 600) {
    failed_ = true;
    stage_ = Stage::done;
  }
}

void WorkingMind::clip(const Sight& sight) {
  if (!tools_.anatomy.divides() || vessel_ >= sight.vessel.size()) {
    vessel_ = 0;
    tries_ = 0;
    stage_ = tools_.anatomy.divides() ? Stage::cut : Stage::bed;
    if (stage_ == Stage::cut) {
      cut(sight);
    } else {
      burn(sight, false);
    }
    return;
  }
  if (mount(InstrumentKind::clipApplier, clipJaw)) {
    looks_ = 0;
    return;
  }
  const SeenVessel& vessel = sight.vessel[vessel_];
  const double length = PerformerSight::spacing * static_cast<double>(vessel.centre.size() - 1);
  const double cutPlace = cutAt * length;
  std::uint32_t patient = 0, specimen = 0;
  double last = 0.0;
  for (const double c : vessel.clip) {
    if (c < cutPlace) {
      ++patient;
      last = std::max(last, c);
    } else {
      ++specimen;
    }
  }
  const bool more = patient < 2 + badClips_;
  if ((!more && specimen >= 1) || tries_ >= mostTries + 3) {
    ++vessel_;
    tries_ = 0;
    badClips_ = 0;
    looks_ = 0;
    clip(sight);
    return;
  }
  double place = lastClip * length;
  if (specimen >= 1) {
    place = patient == 0 ? firstClip * length : last + clipSpacing;
    if (place > cutPlace - 0.002) place = firstClip * length - clipSpacing;
  }
  const auto station =
      std::min(static_cast<std::size_t>(place / PerformerSight::spacing + 0.5), vessel.centre.size() - 1);
  if (bring(vessel.centre[station], vessel.along[station], hover, clipDepth, clipJaw)) {
    closeAndLeave(clipJaw);
    looks_ = 0;
    ++tries_;
  }
}

void WorkingMind::cut(const Sight& sight) {
  if (vessel_ >= sight.vessel.size()) {
    vessel_ = 0;
    tries_ = 0;
    stage_ = Stage::bed;
    burn(sight, false);
    return;
  }
  if (mount(InstrumentKind::scissors, bladeJaw)) {
    looks_ = 0;
    return;
  }
  const SeenVessel& vessel = sight.vessel[vessel_];
  if (vessel.partings > 0 || tries_ >= mostTries) {
    failed_ = failed_ || vessel.partings == 0;
    ++vessel_;
    tries_ = 0;
    looks_ = 0;
    cut(sight);
    return;
  }
  const double length = PerformerSight::spacing * static_cast<double>(vessel.centre.size() - 1);
  // Between the last clip on the patient's side and the first on the specimen's.
  double from = 0.0, to = length;
  for (const double c : vessel.clip) {
    if (c < cutAt * length) from = std::max(from, c);
    if (c >= cutAt * length) to = std::min(to, c);
  }
  const double place = vessel.clip.empty() ? cutAt * length : 0.5 * (from + to);
  const auto station =
      std::min(static_cast<std::size_t>(place / PerformerSight::spacing + 0.5), vessel.centre.size() - 1);
  const double depth = bladeDepth + bladeTrial * (static_cast<double>(tries_ % 3U) - 0.5);
  if (bring(vessel.centre[station], vessel.along[station], hover, depth, bladeJaw)) {
    closeAndLeave(bladeJaw);
    looks_ = 0;
    ++tries_;
  }
}

}  // namespace calot::recorder
