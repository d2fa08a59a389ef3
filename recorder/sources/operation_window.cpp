// SPDX-License-Identifier: GPL-3.0-or-later
// Clearing the triangle between the vessels: strokes through the whole thickness of its fat, row by row.
#include <algorithm>
#include <array>
#include <cmath>

#include "recorder/sources/operation_mind.h"
#include "sim/math/linear.h"

namespace calot::recorder {
namespace {

constexpr double toeEnd = 0.0046;               // from the hook's heel (m)
constexpr double windowWire = 0.0006;           // its radius (m)
constexpr double windowWireLength = 0.009;      // of it along the shaft, that burns (m)
constexpr double windowClearance = 0.002;       // above the fat, on the way from one stroke to the next (m)
constexpr double thin = 0.0010;                 // fat thinner than this is not gone for (m)
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

void WorkingMind::window(Sight sight) {
  const PerformerProfile::Operation& operation = tools_.profile.operation;
  const std::vector<PerformerSight::ColumnPlan>& plan = tools_.anatomy.columns();
  columnTried_.resize(plan.size(), 0);
  std::vector<std::pair<Vec3, double>> vessels = tools_.anatomy.spared();
  for (std::size_t v = 0; v < sight.vessel.size(); ++v) {
    for (const Vec3& centre : sight.vessel[v].centre) vessels.emplace_back(centre, tools_.anatomy.vessels()[v].radius);
  }
  const double off = windowWire + operation.keepOff;
  // What cannot be taken without harm to a vessel does not count.
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
