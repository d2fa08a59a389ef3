// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/vessel/tube_surface.h"

#include <algorithm>
#include <cassert>
#include <numbers>

#include "sim/math/elementary.h"
#include "sim/vessel/beam_state.h"

namespace calot {

TubeSurface::TubeSurface(const BeamModel& model, std::size_t branch, const Settings& settings)
    : model_(model), branch_(branch), settings_(settings) {
  assert(settings.sides >= 3 && settings.ringsPerElement >= 1);
  for (std::size_t k = 0; k < settings.sides; ++k) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(settings.sides);
    cosine_.push_back(calot::cosine(angle));
    sine_.push_back(calot::sine(angle));
  }
  const std::size_t elements = model.branches()[branch].elements();
  parting_.assign(elements, Parting::none);
  partedAt_.assign(elements, 0.0);
  build();
}

bool TubeSurface::update(const BeamState& state) {
  const std::size_t first = model_.branches()[branch_].firstElement;
  bool changed = false;
  for (std::size_t i = 0; i < parting_.size(); ++i) {
    if (state.parting[first + i] == parting_[i] && state.partedAt[first + i] == partedAt_[i]) continue;
    changed = true;
    parting_[i] = state.parting[first + i];
    partedAt_[i] = state.partedAt[first + i];
  }
  if (changed) build();
  return changed;
}

BeamPoint TubeSurface::pointOn(std::size_t element, double share) const {
  const BeamModel::Branch& b = model_.branches()[branch_];
  return {branch_, b.firstElement + element, share,
          b.arcLength[element] + share * (b.arcLength[element + 1] - b.arcLength[element])};
}

int TubeSurface::addRing(const Ring& ring) {
  const int index = static_cast<int>(ring_.size());
  ring_.push_back(ring);
  firstVertex_.push_back(static_cast<int>(vertex_.size()));
  const BeamInfluence influence = influenceOf(model_, ring.where, ring.stump);
  for (std::size_t k = 0; k < settings_.sides; ++k) {
    vertex_.push_back({index, static_cast<int>(k)});
    influence_.push_back(influence);
  }
  return index;
}

int TubeSurface::addMiddle(int ring) {
  vertex_.push_back({ring, middle});
  influence_.push_back(influence_[static_cast<std::size_t>(firstVertex_[static_cast<std::size_t>(ring)])]);
  return static_cast<int>(vertex_.size()) - 1;
}

int TubeSurface::vertexOf(int ring, std::size_t side) const {
  return firstVertex_[static_cast<std::size_t>(ring)] + static_cast<int>(side % settings_.sides);
}

void TubeSurface::strip(int from, int to) {
  for (std::size_t k = 0; k < settings_.sides; ++k) {
    triangle_.emplace_back(vertexOf(from, k), vertexOf(from, k + 1), vertexOf(to, k + 1));
    triangle_.emplace_back(vertexOf(from, k), vertexOf(to, k + 1), vertexOf(to, k));
  }
}

void TubeSurface::cap(int centre, int ring, bool atEnd) {
  for (std::size_t k = 0; k < settings_.sides; ++k) {
    const int one = vertexOf(ring, k);
    const int two = vertexOf(ring, k + 1);
    triangle_.emplace_back(centre, atEnd ? one : two, atEnd ? two : one);
  }
}

/// Rings of the whole branch. In a parted element, those on each side are spread evenly over its stump, so that none
/// falls on the parting.
void TubeSurface::layRings() {
  const std::size_t per = settings_.ringsPerElement;
  for (std::size_t i = 0; i < parting_.size(); ++i) {
    const bool parted = parting_[i] != Parting::none;
    const double cut = partedAt_[i];
    std::size_t before = 0;
    while (before + 1 < per && static_cast<double>(before + 1) <= cut * static_cast<double>(per)) ++before;
    for (std::size_t k = 0; k < per; ++k) {
      if (!parted || k == 0) {
        addRing({pointOn(i, static_cast<double>(k) / static_cast<double>(per)), Stump::none});
      } else if (k <= before) {
        addRing({pointOn(i, cut * static_cast<double>(k) / static_cast<double>(before + 1)), Stump::before});
      } else {
        const double t = static_cast<double>(k - before) / static_cast<double>(per - before);
        addRing({pointOn(i, cut + (1.0 - cut) * t), Stump::after});
      }
    }
  }
  addRing({pointOn(parting_.size() - 1, 1.0), Stump::none});
}

void TubeSurface::build() {
  ring_.clear();
  firstVertex_.clear();
  vertex_.clear();
  influence_.clear();
  triangle_.clear();
  layRings();
  const std::size_t per = settings_.ringsPerElement;
  const int last = static_cast<int>(ring_.size()) - 1;
  const int start = addMiddle(0);
  const int end = addMiddle(last);

  struct Gap {
    int from, to;              ///< rings on both sides
    int before, beforeMiddle;  ///< ring and middle of the stump before
    int after, afterMiddle;
  };
  std::vector<Gap> gaps;
  for (std::size_t i = 0; i < parting_.size(); ++i) {
    if (parting_[i] == Parting::none) continue;
    Gap gap{};
    gap.from = static_cast<int>(i * per);
    while (gap.from < static_cast<int>((i + 1) * per) - 1 &&
           ring_[static_cast<std::size_t>(gap.from) + 1].stump == Stump::before) {
      ++gap.from;
    }
    gap.to = gap.from + 1;
    gap.before = addRing({pointOn(i, partedAt_[i]), Stump::before});
    gap.beforeMiddle = addMiddle(gap.before);
    gap.afterMiddle = static_cast<int>(vertex_.size());
    vertex_.push_back({gap.before + 1, middle});
    influence_.push_back(influenceOf(model_, pointOn(i, partedAt_[i]), Stump::after));
    gap.after = addRing({pointOn(i, partedAt_[i]), Stump::after});
    gaps.push_back(gap);
  }
  std::size_t next = 0;
  for (int r = 0; r < last; ++r) {
    const bool parted = next < gaps.size() && gaps[next].from == r;
    strip(r, parted ? gaps[next].before : r + 1);
    if (parted) ++next;
  }
  cap(start, 0, false);
  cap(end, last, true);
  for (const Gap& gap : gaps) {
    strip(gap.after, gap.to);
    cap(gap.beforeMiddle, gap.before, true);
    cap(gap.afterMiddle, gap.after, false);
  }
}

BeamPoint TubeSurface::where(int vertex) const {
  return ring_[static_cast<std::size_t>(vertex_[static_cast<std::size_t>(vertex)].ring)].where;
}

void TubeSurface::positions(const BeamState& state, std::vector<Vec3>& out) const {
  out.resize(vertex_.size());
  int ring = -1;
  Vec3 centre = Vec3::Zero();
  Mat3 frame = Mat3::Identity();
  double direction[2] = {1.0, 0.0};
  PinchedSection section;
  for (std::size_t v = 0; v < vertex_.size(); ++v) {
    if (vertex_[v].ring != ring) {
      ring = vertex_[v].ring;
      const Ring& r = ring_[static_cast<std::size_t>(ring)];
      const Pose pose = centreLine(model_, state, r.where, r.stump);
      centre = pose.position;
      frame = pose.orientation.toRotationMatrix();
      const Pinch pinch = pinchAt(model_, state, branch_, r.where.arcLength);
      section = pinchedSection(model_.branches()[branch_].section, pinch.amount);
      direction[0] = pinch.amount > 0.0 ? calot::cosine(pinch.roll) : 1.0;
      direction[1] = pinch.amount > 0.0 ? calot::sine(pinch.roll) : 0.0;
    }
    if (vertex_[v].side == middle) {
      out[v] = centre;
      continue;
    }
    const double c = cosine_[static_cast<std::size_t>(vertex_[v].side)];
    const double s = sine_[static_cast<std::size_t>(vertex_[v].side)];
    const double thin = section.thin * (c * direction[0] + s * direction[1]);
    const double wide = section.wide * (s * direction[0] - c * direction[1]);
    out[v] = centre + (thin * direction[0] - wide * direction[1]) * frame.col(0) +
             (thin * direction[1] + wide * direction[0]) * frame.col(1);
  }
}

}  // namespace calot
