// SPDX-License-Identifier: GPL-3.0-or-later
// Freeing the specimen from its bed with the hook.
#include <algorithm>
#include <array>
#include <cmath>

#include "recorder/sources/operation_mind.h"

namespace calot::recorder {
namespace {

constexpr double wireLength = 0.009;     // of the hook's wire along the shaft, that burns (m)
constexpr double sweepLength = 0.011;    // under current through connective tissue (m)
constexpr double repeatSpread = 0.0008;  // between one try at a strand and the next (m)
constexpr double sweepLead = 0.0015;     // of it before the first strand (m)
constexpr double fewLeft = 0.05;         // of its strands: the lower third counts as free
constexpr double lowerShare = 0.37;      // of the strands: the lower third of the bed, and a little more

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
  double left = 0.0, all = 0.0;
  std::size_t chosen = sight.strand.size();
  for (std::size_t s = 0; s < sight.strand.size(); ++s) {
    all += !lowerThird || share_[s] <= lowerShare ? 1.0 : 0.0;
    if (!wanted(s)) continue;
    left += 1.0;
    const Vec3 middle = middleOf(s);
    const double key = middle.x() + 0.2 * middle.y() + 0.3 * (middle - hand().meant()).norm();
    if (!(key < best)) continue;
    best = key;
    chosen = s;
  }
  // A few strands of the lower third may wait until the rest of the bed is freed.
  if (chosen == sight.strand.size() || (lowerThird && left < fewLeft * all)) {
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
  // What the last sweep missed is gone through its own middle, shorter, now a little to one side and now to the other.
  const bool again = chosen == lastStrand_;
  repeats_ = again ? repeats_ + 1 : 0;
  lastStrand_ = chosen;
  if (again) {
    band = Band();
    band.deep = 0.002 + 0.002 * static_cast<double>(repeats_ % 3U);
    band.add(0.0, repeatSpread * random_.normal());
  }
  const double reach = again ? 0.5 * sweepLength : sweepLength;
  const Vec3 start = place + band.deep * shaft + error_;
  const Vec3 from = start - sweepLead * across + band.offset(0) * through;
  const Vec3 to = start + (reach - sweepLead) * across + band.offset(1) * through;
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

}  // namespace calot::recorder
