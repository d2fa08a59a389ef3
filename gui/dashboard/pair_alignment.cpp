// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/pair_alignment.h"

#include <algorithm>

namespace calot::gui {

PairAlignment::PairAlignment(std::array<double, 2> seconds, std::array<double, 2> offsets)
    : seconds_(seconds),
      offsets_(offsets),
      begin_(std::min(-offsets[0], -offsets[1])),
      end_(std::max(seconds[0] - offsets[0], seconds[1] - offsets[1])) {}

double PairAlignment::own(std::size_t which, double common) const {
  return std::clamp(common + offsets_[which], 0.0, seconds_[which]);
}

bool PairAlignment::runs(std::size_t which, double common) const {
  const double time = common + offsets_[which];
  return time >= 0.0 && time < seconds_[which];
}

std::optional<double> firstOf(const AttemptTrack& track, Phase phase) {
  const auto at =
      std::find_if(track.phases.begin(), track.phases.end(), [&](const TrackPhase& p) { return p.phase == phase; });
  if (at == track.phases.end()) return std::nullopt;
  return at->begin;
}

std::vector<Phase> commonPhases(const AttemptTrack& a, const AttemptTrack& b) {
  std::vector<Phase> phases;
  for (const Phase phase : {Phase::identification, Phase::clipping, Phase::cutting, Phase::dissection}) {
    if (firstOf(a, phase) && firstOf(b, phase)) phases.push_back(phase);
  }
  return phases;
}

}  // namespace calot::gui
