// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/vessel/beam_state.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "sim/math/linear.h"

namespace calot {

namespace {

constexpr double closedFrom = 0.95;
constexpr double enclosedFrom = 0.999;
constexpr double sleeveStiffness = 50.0;  ///< of the covered part, in multiples of its own stiffness
constexpr double blendRadii = 1.5;        ///< from flat to round

/// Arc length at which an element of a branch is parted (m), or a negative number.
double partingOf(const BeamModel::Branch& b, const BeamState& state, std::size_t i) {
  const std::size_t e = b.firstElement + i;
  if (state.parting[e] == Parting::none) return -1.0;
  return b.arcLength[i] + state.partedAt[e] * (b.arcLength[i + 1] - b.arcLength[i]);
}

/// The piece of a branch around a point: between the nearest parting or end on each side.
struct Piece {
  double from = 0.0;
  double to = 0.0;
  bool partedFrom = false;
  bool partedTo = false;
};

Piece pieceAround(const BeamModel& model, const BeamState& state, std::size_t branch, double arcLength) {
  const BeamModel::Branch& b = model.branches()[branch];
  Piece piece{0.0, b.length(), false, false};
  for (std::size_t i = 0; i < b.elements(); ++i) {
    const double at = partingOf(b, state, i);
    if (at < 0.0) continue;
    if (at <= arcLength) {
      piece.from = at;
      piece.partedFrom = true;
    } else if (at < piece.to) {
      piece.to = at;
      piece.partedTo = true;
    }
  }
  return piece;
}

}  // namespace

bool closes(const BeamState& state, std::size_t clip) {
  return state.clipClosure[clip] >= closedFrom && state.clipEnclosed[clip] >= enclosedFrom;
}

ClipSeat clipSeat(const BeamModel& model, const BeamState& state, const ClipAttempt& attempt) {
  ClipSeat out;
  const std::size_t branch = attempt.point.branch;
  const BeamModel::Branch& b = model.branches()[branch];
  const double half = 0.5 * attempt.width;
  const double arcLength = attempt.point.arcLength;

  const double wide = pinchedSection(b.section, 1.0).wide;
  const double between = std::min(attempt.depth + wide, attempt.legs) - notNegative(attempt.depth - wide);
  out.enclosed = std::min(notNegative(between / (2.0 * wide)), 1.0);
  out.missed = !(out.enclosed > 0.0);

  const Piece piece = pieceAround(model, state, branch, arcLength);
  out.endGap = std::min(arcLength - half - piece.from, piece.to - (arcLength + half));
  for (std::size_t c = 0; c < state.clips(); ++c) {
    const double other = state.clipPlace[c];
    if (state.clipBranch[c] != branch || other < piece.from || other > piece.to) continue;
    const double gap = std::abs(other - arcLength) - half - 0.5 * state.clipWidth[c];
    if (!(gap < out.clipGap)) continue;
    out.clipGap = gap;
    out.clip = static_cast<int>(c);
  }
  for (const double junction : model.junctions(branch)) {
    if (junction < piece.from || junction > piece.to) continue;
    out.junctionGap = std::min(out.junctionGap, std::abs(junction - arcLength) - half);
  }
  return out;
}

void setClip(const BeamModel& model, BeamState& state, const ClipAttempt& attempt, double enclosed) {
  assert(enclosed > 0.0);
  state.clipBranch.push_back(static_cast<std::uint32_t>(attempt.point.branch));
  state.clipPlace.push_back(attempt.point.arcLength);
  state.clipWidth.push_back(attempt.width);
  state.clipRoll.push_back(attempt.roll);
  state.clipClosure.push_back(std::min(notNegative(attempt.closure), 1.0));
  state.clipEnclosed.push_back(std::min(notNegative(enclosed), 1.0));
  state.quietSteps = 0;
  const BeamModel::Branch& b = model.branches()[attempt.point.branch];
  for (std::size_t i = 0; i < b.elements(); ++i) {
    const double length = b.arcLength[i + 1] - b.arcLength[i];
    const double from = std::max(b.arcLength[i], attempt.point.arcLength - 0.5 * attempt.width);
    const double to = std::min(b.arcLength[i + 1], attempt.point.arcLength + 0.5 * attempt.width);
    if (!(to > from)) continue;
    // Covered and uncovered parts are in series.
    const double covered = std::min((to - from) / length, 1.0) * state.clipEnclosed.back();
    const double added = 1.0 / (1.0 - covered + covered / sleeveStiffness) - 1.0;
    const std::size_t e = b.firstElement + i;
    const BeamElement& element = model.elements()[e];
    const auto na = static_cast<std::size_t>(element.a);
    const auto nb = static_cast<std::size_t>(element.b);
    const Mat3 middle = blend(state.orientation[na], state.orientation[nb], 0.5).toRotationMatrix();
    const Vec3 stretch = middle.transpose() * (state.position[nb] - state.position[na]) / element.length;
    const Vec3 bend = middle.transpose() * quarterTangent(state.orientation[na], state.orientation[nb]);
    // Two springs in parallel act as one, free of force at their weighted mean.
    const double sum = state.sleeve[e] + added;
    const double share = added / sum;
    state.sleeveStretch[e] += share * (stretch - state.sleeveStretch[e]);
    state.sleeveBend[e] += share * (bend - state.sleeveBend[e]);
    state.sleeve[e] = sum;
  }
}

Pinch pinchAt(const BeamModel& model, const BeamState& state, std::size_t branch, double arcLength) {
  Pinch out;
  const double blendLength = blendRadii * model.branches()[branch].section.outerRadius;
  for (std::size_t c = 0; c < state.clips(); ++c) {
    if (state.clipBranch[c] != branch) continue;
    const double beside = std::abs(arcLength - state.clipPlace[c]) - 0.5 * state.clipWidth[c];
    const double t = std::min(notNegative(1.0 - beside / blendLength), 1.0);
    const double amount = state.clipClosure[c] * state.clipEnclosed[c] * (t * t * (3.0 - 2.0 * t));
    if (amount > out.amount) out = {amount, state.clipRoll[c]};
  }
  return out;
}

PinchedSection pinchedSection(const TubeSection& section, double amount) {
  const double r = section.outerRadius;
  const double flat = std::min(section.wall, r);
  return {r + amount * (flat - r), r * (1.0 + amount * (0.5 * std::numbers::pi - 1.0))};
}

CutSides cutSides(const BeamModel& model, const BeamState& state, const BeamPoint& cut) {
  CutSides out;
  const Piece piece = pieceAround(model, state, cut.branch, cut.arcLength);
  double from = piece.from;
  double to = piece.to;
  bool partedFrom = piece.partedFrom;
  bool partedTo = piece.partedTo;
  for (const double junction : model.junctions(cut.branch)) {
    if (junction <= cut.arcLength && junction > from) {
      from = junction;
      partedFrom = false;
    }
    if (junction > cut.arcLength && junction < to) {
      to = junction;
      partedTo = false;
    }
  }
  for (std::size_t c = 0; c < state.clips(); ++c) {
    const double arcLength = state.clipPlace[c];
    if (state.clipBranch[c] != cut.branch || arcLength < piece.from || arcLength > piece.to) continue;
    const double gap = std::abs(arcLength - cut.arcLength) - 0.5 * state.clipWidth[c];
    if (gap < 0.0) out.throughClip = true;
    if (!closes(state, c) || gap < 0.0) continue;  // a clip that is cut through closes nothing
    if (arcLength < cut.arcLength && arcLength >= from) {
      ++out.before;
      if (gap < out.gapBefore) {
        out.gapBefore = gap;
        out.clipBefore = static_cast<int>(c);
      }
    } else if (arcLength > cut.arcLength && arcLength <= to) {
      ++out.after;
      if (gap < out.gapAfter) {
        out.gapAfter = gap;
        out.clipAfter = static_cast<int>(c);
      }
    }
  }
  out.opensBefore = out.before == 0 && !partedFrom;
  out.opensAfter = out.after == 0 && !partedTo;
  return out;
}

}  // namespace calot
