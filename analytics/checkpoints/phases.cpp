// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/checkpoints/phases.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string_view>

namespace calot::analytics {
namespace {

template <class T>
std::vector<T> part(const std::vector<T>& all, std::int64_t from, std::int64_t to) {
  if (all.empty()) return {};
  return {all.begin() + from, all.begin() + to};
}

/// The points k of `segment` with begin <= k < end, appended to `motion`.
void append(const MotionSegment& segment, std::int64_t begin, std::int64_t end, Motion& motion) {
  const auto size = static_cast<std::int64_t>(segment.filtered.size());
  const std::int64_t from = std::max<std::int64_t>(begin - segment.first, 0);
  const std::int64_t to = std::min(end - segment.first, size);
  if (to <= from) return;
  motion.segments.push_back({segment.first + from, part(segment.raw, from, to), part(segment.filtered, from, to),
                             part(segment.orientation, from, to), part(segment.speed, from, to),
                             segment.continues && from == 0});
}

}  // namespace

std::size_t windowOf(Phase phase) {
  return static_cast<std::size_t>(std::find(windowPhases.begin(), windowPhases.end(), phase) - windowPhases.begin());
}

const char* nameOf(Phase phase) {
  constexpr const char* names[]{"identification", "clipping", "cutting", "dissection", "none"};
  return names[windowOf(phase)];
}

CheckpointDefinition phaseDefinition(const CheckpointDefinition& whole, const char* pieces, std::uint32_t version) {
  constexpr std::string_view attempt = "whole attempt";
  assert(whole.window.starts_with(attempt));
  CheckpointDefinition d = whole;
  d.name = "phase-" + whole.name;
  d.title = whole.title + " in the phase";
  d.window = "each phase of the procedure, as often as it recurs" + whole.window.substr(attempt.size());
  d.aggregation = whole.aggregation == Aggregation::hand ? Aggregation::handAndPhase : Aggregation::phase;
  d.origins = {Origin::resimulated, Origin::observables};
  d.version = judgedVersion(version);
  d.definition = fmt::format("as {}, of the {} in the phase", whole.name, pieces);
  d.paperReading.clear();
  return d;
}

std::string handAndPhase(std::size_t hand, Phase phase) { return fmt::format("{} {}", handNames[hand], nameOf(phase)); }

void PhaseTrack::add(Phase phase, std::uint64_t ticks) {
  if (spans_.empty() || spans_.back().phase != phase) {
    const std::uint64_t begin = spans_.empty() ? 0 : spans_.back().end;
    spans_.push_back({phase, begin, begin});
  }
  spans_.back().end += ticks;
}

std::vector<PhaseMotion> PhaseTrack::cut(const std::array<Motion, handCount>& motion, double tickSeconds) const {
  const double ticksPerPoint = 1.0 / (motionRate * tickSeconds);
  const auto firstPoint = [&](std::uint64_t tick) {
    return static_cast<std::int64_t>(std::ceil(static_cast<double>(tick) / ticksPerPoint));
  };
  std::vector<PhaseMotion> phases;
  for (const Phase phase : windowPhases) {
    PhaseMotion part;
    part.phase = phase;
    std::uint64_t ticks = 0;
    TimeSpans window;
    for (const Span& span : spans_) {
      if (span.phase != phase) continue;
      ticks += span.end - span.begin;
      window.push_back({static_cast<double>(span.begin) * tickSeconds, static_cast<double>(span.end) * tickSeconds});
      for (std::size_t h = 0; h < motion.size(); ++h) {
        for (const MotionSegment& segment : motion[h].segments)
          append(segment, firstPoint(span.begin), firstPoint(span.end), part.motion[h]);
      }
    }
    part.seconds = static_cast<double>(ticks) * tickSeconds;
    for (std::size_t h = 0; h < motion.size(); ++h) {
      Motion& hand = part.motion[h];
      hand.mounted = motion[h].mounted;
      hand.coverage = coverageWithin(motion[h].coverage, window);
      hand.interval = motion[h].interval;
      hand.rate = motion[h].rate;
      hand.noise = motion[h].noise;
      hand.cutoff = motion[h].cutoff;
      hand.movementSpeed = motion[h].movementSpeed;
    }
    phases.push_back(std::move(part));
  }
  return phases;
}

}  // namespace calot::analytics
