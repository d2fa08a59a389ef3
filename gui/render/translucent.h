// SPDX-License-Identifier: GPL-3.0-or-later
// What is blended over the surfaces of a picture: connective tissue, and smoke of the hook, which is derived from
// events, not part of State, and drawn as puffs that drift and fade.
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "sim/scene/samples.h"
#include "sim/scene/scene_view.h"
#include "sim/scene/step_result.h"

namespace calot::gui {

/// A vertex of connective tissue, in the camera's frame C (x right, y down, z forward).
struct SheetVertex {
  float position[3];  ///< m
  float normal[3];    ///< unit, of the sheet; either side
  float along[3];     ///< unit, direction of the fibres
  float look[4];      ///< place in the fibre texture (s, t); opacity; share burnt
  float erosion;      ///< share of the fibre texture that is gone: 0 whole, 1 nothing; below 0: matted
};

/// All connective tissue of one picture, back to front for blending.
struct SheetList {
  std::vector<SheetVertex> vertex;
  std::vector<std::uint32_t> index;  ///< of triangles
};

/// Sheets where both strands of a pair are attached, tufts at both ends of torn strands, dark stumps at both ends of
/// burned ones. Strands sag slightly, by an amount that depends on their index alone, as does the part of the fibre
/// texture that a sheet shows. Order: by depth of a piece's centre, then by index.
/// @pre checkView(view) has passed
[[nodiscard]] SheetList makeSheetList(const SceneView& view);

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
  std::deque<Puff> puff_;  ///< their ages at time 0: those not yet there are below it
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
