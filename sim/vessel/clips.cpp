// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/vessel/clips.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "sim/vessel/frames.h"

namespace calot {

namespace {

constexpr double closedFrom = 0.95;
constexpr double enclosedFrom = 0.999;
constexpr double sleeveStiffness = 50.0;  ///< of what a clip covers, in multiples of its own
constexpr double blendRadii = 1.5;        ///< from flat to round

/// Where an element of a branch is parted (m), or a negative number.
double partingOf(const BeamModel::Branch& b, const BeamState& state, std::size_t i) {
  const std::size_t e = b.firstElement + i;
  if (state.parting[e] == Parting::none) return -1.0;
  return b.place[i] + state.partedAt[e] * (b.place[i + 1] - b.place[i]);
}

/// The piece of a branch around a place: from the nearest parting or the end on each side.
struct Piece {
  double from = 0.0;
  double to = 0.0;
  bool partedFrom = false;
  bool partedTo = false;
};

Piece pieceAround(const BeamModel& model, const BeamState& state, std::size_t branch, double place) {
  const BeamModel::Branch& b = model.branches()[branch];
  Piece piece{0.0, b.length(), false, false};
  for (std::size_t i = 0; i < b.elements(); ++i) {
    const double at = partingOf(b, state, i);
    if (at < 0.0) continue;
    if (at <= place) {
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

ClipJudgement judgeClip(const BeamModel& model, const BeamState& state, const ClipAttempt& attempt,
                        const ClipRules& rules) {
  ClipJudgement out;
  const std::size_t branch = attempt.place.branch;
  const BeamModel::Branch& b = model.branches()[branch];
  const double half = 0.5 * attempt.width;
  const double place = attempt.place.place;

  const double wide = pinchedSection(b.section, 1.0).wide;
  const double between = std::min(attempt.depth + wide, attempt.legs) - std::max(attempt.depth - wide, 0.0);
  out.enclosed = std::clamp(between / (2.0 * wide), 0.0, 1.0);
  out.missed = !(out.enclosed > 0.0);
  out.halfOn = !out.missed && out.enclosed < enclosedFrom;

  const Piece piece = pieceAround(model, state, branch, place);
  out.onEdge = place - half < piece.from || place + half > piece.to;
  for (std::size_t c = 0; c < state.clips(); ++c) {
    const double other = state.clipPlace[c];
    if (state.clipBranch[c] != branch || other < piece.from || other > piece.to) continue;
    const double gap = std::abs(other - place) - half - 0.5 * state.clipWidth[c];
    if (!(gap < out.clipGap)) continue;
    out.clipGap = gap;
    out.clip = static_cast<int>(c);
  }
  for (const double junction : model.junctions(branch)) {
    if (junction < piece.from || junction > piece.to) continue;
    out.junctionGap = std::min(out.junctionGap, std::abs(junction - place) - half);
  }
  out.onClip = out.clipGap < 0.0;
  out.nearClip = !out.onClip && out.clipGap < rules.leastGap;
  out.nearJunction = out.junctionGap < rules.leastJunctionGap;
  return out;
}

void setClip(const BeamModel& model, BeamState& state, const ClipAttempt& attempt, double enclosed) {
  assert(enclosed > 0.0);
  state.clipBranch.push_back(static_cast<std::uint32_t>(attempt.place.branch));
  state.clipPlace.push_back(attempt.place.place);
  state.clipWidth.push_back(attempt.width);
  state.clipRoll.push_back(attempt.roll);
  state.clipClosure.push_back(std::clamp(attempt.closure, 0.0, 1.0));
  state.clipEnclosed.push_back(std::clamp(enclosed, 0.0, 1.0));
  state.quietSteps = 0;
  const BeamModel::Branch& b = model.branches()[attempt.place.branch];
  for (std::size_t i = 0; i < b.elements(); ++i) {
    const double length = b.place[i + 1] - b.place[i];
    const double from = std::max(b.place[i], attempt.place.place - 0.5 * attempt.width);
    const double to = std::min(b.place[i + 1], attempt.place.place + 0.5 * attempt.width);
    if (!(to > from)) continue;
    // Covered and free parts are in series.
    const double covered = std::min((to - from) / length, 1.0) * state.clipEnclosed.back();
    const double added = 1.0 / (1.0 - covered + covered / sleeveStiffness) - 1.0;
    const std::size_t e = b.firstElement + i;
    const BeamElement& element = model.elements()[e];
    const auto na = static_cast<std::size_t>(element.a);
    const auto nb = static_cast<std::size_t>(element.b);
    const Mat3 middle = blend(state.orientation[na], state.orientation[nb], 0.5).toRotationMatrix();
    const Vec3 stretch = middle.transpose() * (state.position[nb] - state.position[na]) / element.length;
    const Vec3 bend = middle.transpose() * quarterTangent(state.orientation[na], state.orientation[nb]);
    // Two springs side by side are one, without force at the mean of both.
    const double sum = state.sleeve[e] + added;
    const double share = added / sum;
    state.sleeveStretch[e] += share * (stretch - state.sleeveStretch[e]);
    state.sleeveBend[e] += share * (bend - state.sleeveBend[e]);
    state.sleeve[e] = sum;
  }
}

Pinch pinchAt(const BeamModel& model, const BeamState& state, std::size_t branch, double place) {
  Pinch out;
  const double blendLength = blendRadii * model.branches()[branch].section.outerRadius;
  for (std::size_t c = 0; c < state.clips(); ++c) {
    if (state.clipBranch[c] != branch) continue;
    const double beside = std::abs(place - state.clipPlace[c]) - 0.5 * state.clipWidth[c];
    const double t = std::clamp(1.0 - beside / blendLength, 0.0, 1.0);
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

CutJudgement judgeCut(const BeamModel& model, const BeamState& state, const BeamPlace& cut) {
  CutJudgement out;
  const Piece piece = pieceAround(model, state, cut.branch, cut.place);
  double from = piece.from;
  double to = piece.to;
  bool partedFrom = piece.partedFrom;
  bool partedTo = piece.partedTo;
  for (const double junction : model.junctions(cut.branch)) {
    if (junction <= cut.place && junction > from) {
      from = junction;
      partedFrom = false;
    }
    if (junction > cut.place && junction < to) {
      to = junction;
      partedTo = false;
    }
  }
  for (std::size_t c = 0; c < state.clips(); ++c) {
    const double place = state.clipPlace[c];
    if (state.clipBranch[c] != cut.branch || place < piece.from || place > piece.to) continue;
    const double gap = std::abs(place - cut.place) - 0.5 * state.clipWidth[c];
    if (gap < 0.0) out.throughClip = true;
    if (!closes(state, c) || gap < 0.0) continue;  // a clip that is cut through closes nothing
    if (place < cut.place && place >= from) {
      ++out.before;
      if (gap < out.gapBefore) {
        out.gapBefore = gap;
        out.clipBefore = static_cast<int>(c);
      }
    } else if (place > cut.place && place <= to) {
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
