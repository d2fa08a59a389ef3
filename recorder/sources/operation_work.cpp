// SPDX-License-Identifier: GPL-3.0-or-later
// Works of the operation on vessels: clipping, cutting.
#include <algorithm>
#include <cmath>

#include "recorder/sources/operation_mind.h"
#include "sim/math/linear.h"

namespace calot::recorder {
namespace {

constexpr double clipJaw = 0.55;        // rad
constexpr double clipDepth = 0.0043;    // the vessel comes to lie so far behind the tips (m)
constexpr double bladeJaw = 0.95;       // rad
constexpr double bladeDepth = 0.0078;   // m
constexpr double bladeTrial = 0.0012;   // by how much depths of one try and the next differ (m)
constexpr double clipHover = 0.014;     // m
constexpr double clipSpacing = 0.0033;  // between clips on one side of the cut (m)
constexpr double clipToCut = 0.0033;    // and from the nearest of them to the cut (m)
constexpr double clipApart = 0.0024;    // a clip nearer than this to another one would be too near (m)
constexpr double fromJunction = 0.004;  // and one nearer to where vessels meet, or to the specimen (m)
constexpr std::uint32_t maxTries = 10;

/// Where a vessel is cut, as a share of its length.
constexpr double cutAt = 0.52;

/// The station of a vessel's course that is nearest to an arc length (m).
std::size_t stationAt(double place, std::size_t stations) {
  const double last = static_cast<double>(stations) - 1.0;
  return static_cast<std::size_t>(std::floor(std::min(notNegative(place / PerformerSight::spacing), last) + 0.5));
}

}  // namespace

/// Where the next clip on a side of the cut goes (m from the first station); below zero where there is none to set.
/// Clips that sit badly are made good while there are enough for what is still to be clipped.
double WorkingMind::placeForClip(const Sight& sight, std::size_t side) const {
  const std::vector<PerformerSight::VesselPlan>& plans = tools_.anatomy.vessels();
  const SeenVessel& vessel = sight.vessel[vessel_];
  const double length = PerformerSight::spacing * static_cast<double>(vessel.centre.size() - 1);
  const double cut = cutAt * length;
  const std::uint32_t expected = side == 0 ? plans[vessel_].patientClips : plans[vessel_].specimenClips;
  std::uint32_t there = 0, needed = 0;
  for (const double c : vessel.clip) there += (c < cut) == (side == 0) ? 1U : 0U;
  for (std::size_t v = vessel_ + 1; v < plans.size(); ++v) needed += plans[v].patientClips + plans[v].specimenClips;
  const std::uint32_t left = sight.hand[hand_].clips;
  if (left == 0) return -1.0;
  const std::uint32_t spare = left > needed ? badClips_[side] : 0;
  if (there >= expected + spare) return -1.0;
  // The farthest from the cut first, then towards it; what is to be made good goes farther out still.
  const double out = side == 0 ? -1.0 : 1.0;
  const auto most = static_cast<int>(expected + badClips_[side] + 1);
  for (int k = 0; k < most; ++k) {
    const int fromCut = k < static_cast<int>(expected) ? static_cast<int>(expected) - 1 - k : k;
    const double place = cut + out * (clipToCut + clipSpacing * static_cast<double>(fromCut));
    if (place < fromJunction || place > length - fromJunction) continue;
    if (std::all_of(vessel.clip.begin(), vessel.clip.end(),
                    [&](double c) { return std::abs(c - place) >= clipApart; })) {
      return place;
    }
  }
  return -1.0;
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
  double place = placeForClip(sight, 1);
  clipped_ = place < 0.0 ? 0 : 1;
  if (place < 0.0) place = placeForClip(sight, 0);
  if (place < 0.0 || tries_ >= maxTries) {
    ++vessel_;
    tries_ = 0;
    badClips_ = {0, 0};
    looks_ = 0;
    clip(sight);
    return;
  }
  const std::size_t station = stationAt(place, vessel.centre.size());
  if (bring(vessel.centre[station], vessel.along[station], clipHover, clipDepth, clipJaw)) {
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
  if (vessel.partings > 0 || tries_ >= maxTries) {
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
  const std::size_t station = stationAt(place, vessel.centre.size());
  const double depth = bladeDepth - bladeTrial * static_cast<double>(tries_ % 3U);
  if (bring(vessel.centre[station], vessel.along[station], clipHover, depth, bladeJaw)) {
    closeAndLeave(bladeJaw);
    looks_ = 0;
    ++tries_;
  }
}

}  // namespace calot::recorder
