// SPDX-License-Identifier: GPL-3.0-or-later
// The root attributes, listed once: written, read, and hashed by the same list.
#pragma once

#include <cstdint>
#include <string>

#include "recorder/base/identity.h"
#include "recorder/recording/layout.h"

namespace calot::recorder {

inline constexpr std::array<const char*, 3> operatorKindNames{"human", "kinematics", "performer"};
inline constexpr std::array<const char*, 2> modeNames{"practice", "assessment"};
inline constexpr std::array<const char*, 6> outcomeNames{"running",   "completed", "time_limit",
                                                         "abandoned", "stopped",   "technical_failure"};

/// Lists the root attributes in the order of the chain. Values: std::string, std::uint32_t, std::uint64_t,
/// std::int64_t, double; `choice` is a string from a list.
template <class Header, class Visitor>
void visitAttributes(Header& h, Visitor& visit) {
  visit.constant("format", std::string(formatName));
  visit("format_version", h.formatVersion);
  visit("attempt_uuid", h.attempt);
  visit("parent_uuid", h.parent);
  visit("fork_step", h.forkStep);
  visit("start_utc", h.startUtc);
  visit("software", h.software);
  visit("build", h.build);
  visit("simulation_version", h.simulationVersion);
  visit("step_result_version", h.stepResultVersion);
  visit("participant", h.participant);
  visit.choice("operator_kind", h.provenance.kind, operatorKindNames);
  visit("performer_profile", h.provenance.profile);
  visit("performer_version", h.provenance.profileVersion);
  visit("source_file", h.provenance.sourceFile);
  visit("source_sha256", h.provenance.sourceSha256);
  visit("device", h.provenance.device);
  visit("calibration", h.provenance.calibration);
  visit("station", h.station);
  visit.choice("mode", h.mode, modeNames);
  visit("purpose", h.purpose);
  visit("handedness", h.handedness);
  visit("seed", h.seed);
  visit("tick_seconds", h.tickSeconds);
  visit("ticks_per_step", h.ticksPerStep);
  visit("scene_name", h.sceneName);
  visit("scene_major", h.sceneMajor);
  visit("scene_minor", h.sceneMinor);
}

}  // namespace calot::recorder
