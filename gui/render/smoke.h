// SPDX-License-Identifier: GPL-3.0-or-later
// Smoke of the hook: derived from events, not part of State, and drawn as puffs that drift and fade.
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "sim/scene/samples.h"
#include "sim/scene/step_result.h"

namespace calot::gui {

/// Lifetime of a puff (s).
inline constexpr double smokeSeconds = 2.5;

/// One puff of smoke.
struct Puff {
  Vec3 p_W = Vec3::Zero();   ///< where it arose (m)
  double age = 0.0;          ///< since then (s)
  double strength = 0.0;     ///< 0 to 1, by the energy that made it
  std::uint32_t number = 0;  ///< seed of its drift
};

/// Collects smoke from the events of consecutive steps; the result depends on these events alone.
class SmokeTrail {
 public:
  /// @param time at the step's end (s), never falling @param events of the step
  void add(double time, std::span<const Event> events);
  /// Puffs visible at a time, oldest first. @param time not before that of the last add()
  [[nodiscard]] std::vector<Puff> at(double time) const;

 private:
  struct Source {
    Vec3 p_W = Vec3::Zero();
    double time = 0.0, strength = 0.0;
    std::uint32_t number = 0;
  };
  std::deque<Source> source_;
};

/// A corner of a puff's square, which faces the camera.
struct SmokeVertex {
  float position[3];  ///< in C (m)
  float corner[2];    ///< -1 or 1 each
  float opacity;      ///< in the middle
  float offset;       ///< into the noise, so that no two puffs look alike
};

struct SmokeList {
  std::vector<SmokeVertex> vertex;   ///< four a puff
  std::vector<std::uint32_t> index;  ///< of triangles, farthest puffs first
};

/// Puffs as the camera sees them: they rise against gravity, slow down, spread, and thin out until smokeSeconds.
[[nodiscard]] SmokeList makeSmokeList(const CameraSample& camera, const Vec3& down, std::span<const Puff> puffs);

}  // namespace calot::gui
