// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/scene/samples.h"

#include <algorithm>
#include <cmath>

namespace calot {
namespace {

constexpr double positionCells = 1048576.0;  // 2^20 a metre
constexpr double angleCells = 65536.0;       // 2^16
constexpr double maxCell = 2147483647.0;

// Half away from zero; the sum with zero turns -0 into 0, so that equal samples have equal bits.
double toGrid(double value, double cells) {
  const double scaled = std::clamp(value * cells, -maxCell, maxCell);
  const double magnitude = std::floor(std::abs(scaled) + 0.5);
  return (scaled < 0.0 ? -magnitude : magnitude) / cells + 0.0;
}

Vec3 toGrid(const Vec3& p) {
  return {toGrid(p.x(), positionCells), toGrid(p.y(), positionCells), toGrid(p.z(), positionCells)};
}

Quat toGrid(const Quat& q) {
  return {toGrid(q.w(), angleCells), toGrid(q.x(), angleCells), toGrid(q.y(), angleCells), toGrid(q.z(), angleCells)};
}

bool isFinite(const Vec3& p) { return std::isfinite(p.x()) && std::isfinite(p.y()) && std::isfinite(p.z()); }

bool isFinite(const Quat& q) {
  return std::isfinite(q.w()) && std::isfinite(q.x()) && std::isfinite(q.y()) && std::isfinite(q.z());
}

}  // namespace

TickSamples roundedToGrid(const TickSamples& samples) {
  TickSamples out = samples;
  for (InstrumentSample& hand : out.hand) {
    if (!isFinite(hand.position) || !isFinite(hand.orientation) || !std::isfinite(hand.jaw)) {
      hand.position.setZero();
      hand.orientation.setIdentity();
      hand.jaw = 0.0;
      hand.valid = false;
      continue;
    }
    hand.position = toGrid(hand.position);
    hand.orientation = toGrid(hand.orientation);
    hand.jaw = toGrid(hand.jaw, angleCells);
  }
  out.camera.position = toGrid(out.camera.position);
  out.camera.orientation = toGrid(out.camera.orientation);
  return out;
}

}  // namespace calot
