// SPDX-License-Identifier: GPL-3.0-or-later
// Clearing vessels and the triangle between them of fat.
#include <algorithm>
#include <array>
#include <cmath>

#include "recorder/sources/operation_mind.h"

namespace calot::recorder {
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
  strokes_ = 0;
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
