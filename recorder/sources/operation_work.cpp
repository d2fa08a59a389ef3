// SPDX-License-Identifier: GPL-3.0-or-later
// Works of the operation on vessels: clipping, cutting.
// Clearing the triangle between the vessels: strokes through the whole thickness of its fat, row by row.
#include <algorithm>
#include <array>
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

/// Position of a vessel's cut, as a share of its length.
constexpr double cutAt = 0.52;

/// The station of a vessel's course that is nearest to an arc length (m).
std::size_t stationAt(double place, std::size_t stations) {
  const double last = static_cast<double>(stations) - 1.0;
  return static_cast<std::size_t>(std::floor(std::min(notNegative(place / PerformerSight::spacing), last) + 0.5));
}

}  // namespace

/// Position of the next clip on a side of the cut (m from the first station); below zero if there is none to set.
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

/// Brings the jaws to a place of a vessel, closes them there and leaves.
void WorkingMind::closeAt(const SeenVessel& vessel, double place, double depth, double jaw) {
  const std::size_t station = stationAt(place, vessel.centre.size());
  if (!bring(vessel.centre[station], vessel.along[station], clipHover, depth, jaw)) return;
  closeAndLeave(jaw);
  looks_ = 0;
  ++tries_;
}

void WorkingMind::nextVessel() {
  ++vessel_;
  tries_ = 0;
  looks_ = 0;
}

void WorkingMind::clip(const Sight& sight) {
  if (!tools_.anatomy.divides() || vessel_ >= sight.vessel.size()) {
    vessel_ = 0;
    tries_ = 0;
    stage_ = tools_.anatomy.divides() ? Stage::cut : Stage::bed;
    stage_ == Stage::cut ? cut(sight) : burn(sight, false);
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
    nextVessel();
    badClips_ = {0, 0};
    clip(sight);
    return;
  }
  closeAt(vessel, place, clipDepth, clipJaw);
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
    nextVessel();
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
  closeAt(vessel, place, bladeDepth - bladeTrial * static_cast<double>(tries_ % 3U), bladeJaw);
}

namespace {

constexpr double toeEnd = 0.0046;               // from the hook's heel (m)
constexpr double windowWire = 0.0006;           // its radius (m)
constexpr double windowWireLength = 0.009;      // of it along the shaft, that burns (m)
constexpr double windowClearance = 0.002;       // above the fat, on the way from one stroke to the next (m)
constexpr double thin = 0.0010;                 // fat thinner than this is not gone for (m)
constexpr std::size_t searchLength = 14;        // stations of a stroke beside a vessel
constexpr std::size_t shortest = 2;             // columns of a stroke, at least
constexpr std::size_t longest = 8;              // and at most
constexpr std::uint32_t mostTriedOfColumn = 3;  // strokes through one column

/// The lowest that the hook may go at a place with its toe along `toe`, towards the port, so that it keeps off vessels.
double lowestAt(const Vec3& place, const Vec3& shaft, const Vec3& toe, double off,
                const std::vector<std::pair<Vec3, double>>& vessels) {
  double lowest = -1.0;
  for (const auto& [centre, radius] : vessels) {
    const Vec3 d = centre - place;
    const double height = -d.dot(shaft);
    const double along = std::min(notNegative(d.dot(toe)), toeEnd);
    const double aside = (d + height * shaft - along * toe).norm();
    if (aside < radius + off) lowest = std::max(lowest, height + radius + off);
  }
  return lowest;
}

}  // namespace

/// A row's thickest stretch of fat, of those that were gone for least.
bool WorkingMind::thickestRow(const Sight& sight, std::size_t& first, std::size_t& last) const {
  const std::vector<PerformerSight::ColumnPlan>& plan = tools_.anatomy.columns();
  double most = 0.0;
  for (std::size_t from = 0; from < sight.column.size(); ++from) {
    double worth = 0.0;
    for (std::size_t to = from; to < sight.column.size() && to - from < longest && plan[to].row == plan[from].row;
         ++to) {
      const double fat = sight.column[to].fat();
      if (fat < thin || columnTried_[to] >= mostTriedOfColumn) break;
      worth += fat / (1.0 + 3.0 * static_cast<double>(columnTried_[to]));
      if (to - from + 1 < shortest || !(worth > most)) continue;
      most = worth;
      first = from;
      last = to;
    }
  }
  return most > 0.0;
}

std::vector<std::pair<Vec3, double>> WorkingMind::keptOff(const Sight& sight) const {
  std::vector<std::pair<Vec3, double>> vessels = sight.spared;
  for (std::size_t v = 0; v < sight.vessel.size(); ++v) {
    for (const Vec3& centre : sight.vessel[v].centre) vessels.emplace_back(centre, tools_.anatomy.vessels()[v].radius);
  }
  return vessels;
}

/// A stroke through the fat beside a vessel's course, where a hand that has not found the vessel supposes it.
void WorkingMind::search(const Sight& sight) {
  const PerformerProfile::Operation& operation = tools_.profile.operation;
  const SeenVessel& vessel = sight.vessel[vessel_];
  ++searched_;
  newError();
  error_ *= 0.25;
  const double sign = random_.uniform() < 0.5 ? -1.0 : 1.0;
  const double aside = operation.searchSpread * random_.uniform(0.5, 1.5);
  const std::size_t stations = vessel.centre.size();
  const std::size_t length = std::min(searchLength, stations - 1);
  const auto begin = static_cast<std::size_t>(random_.uniform() * static_cast<double>(stations - length));
  const std::vector<std::pair<Vec3, double>> vessels = keptOff(sight);
  std::vector<Vec3> way;
  Vec3 toe = Vec3::Zero();
  double top = 0.0;
  for (std::size_t k = 0; k <= 2; ++k) {
    const std::size_t s = begin + length * k / 2;
    const Vec3 shaft = hand().shaft(vessel.centre[s]);
    toe = sign * shaft.cross(vessel.along[s]);
    toe /= std::max(toe.norm(), 1e-9);
    const Vec3 place = vessel.centre[s] + aside * toe;
    way.emplace_back(place - notNegative(lowestAt(place, shaft, toe, windowWire + operation.keepOff, vessels)) * shaft +
                     error_);
    for (const double fat : vessel.fat[s]) top = std::max(top, fat);
  }
  strokeThrough(way, toe, top + windowClearance);
}

void WorkingMind::window(Sight sight) {
  const PerformerProfile::Operation& operation = tools_.profile.operation;
  const std::vector<PerformerSight::ColumnPlan>& plan = tools_.anatomy.columns();
  columnTried_.resize(plan.size(), 0);
  const std::vector<std::pair<Vec3, double>> vessels = keptOff(sight);
  const double off = windowWire + operation.keepOff;
  // Tissue that cannot be removed without harm to a vessel does not count.
  for (std::size_t c = 0; c < plan.size() && c < sight.column.size(); ++c) {
    SeenColumn& column = sight.column[c];
    const bool next = c + 1 < plan.size() && plan[c + 1].row == plan[c].row;
    const Vec3 along =
        next ? Vec3(plan[c + 1].place - plan[c].place) : Vec3(plan[c].place - plan[c > 0 ? c - 1 : 0].place);
    const Vec3 shaft = hand().shaft(column.place);
    Vec3 side = shaft.cross(along);
    side /= std::max(side.norm(), 1e-9);
    column.bottom = std::max(column.bottom, lowestAt(column.place, shaft, side, off, vessels));
  }
  std::uint32_t made = 0;
  std::size_t first = 0, last = 0;
  for (; made < operation.series && strokes_ < operation.window && thickestRow(sight, first, last); ++made) {
    ++strokes_;
    newError();
    error_ *= 0.25;
    Vec3 along = sight.column[last].place - sight.column[first].place;
    along /= std::max(along.norm(), 1e-9);
    const Vec3 shaft = hand().shaft(sight.column[(first + last) / 2].place);
    Vec3 side = shaft.cross(along);
    side /= std::max(side.norm(), 1e-9);
    std::vector<Vec3> way;
    double top = -1.0, ended = 0.0;
    // Every other column is a corner.
    for (std::size_t k = 0; k <= last - first; ++k) {
      const std::size_t c = strokes_ % 2U == 0 ? last - k : first + k;
      SeenColumn& column = sight.column[c];
      ++columnTried_[c];
      top = std::max(top, column.top);
      const double height = std::max(column.bottom, column.top - windowWireLength);
      if (k % 2U == 0 || k == last - first) {
        way.emplace_back(column.place - height * shaft + error_);
        ended = height;
      }
      column.top = column.bottom;
    }
    strokeThrough(way, side, notNegative(top - ended) + windowClearance);
  }
  if (made > 0) return;
  strokes_ = 0;
  stage_ = Stage::lowerThird;
  burn(sight, true);
}

}  // namespace calot::recorder
