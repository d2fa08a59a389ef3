// SPDX-License-Identifier: GPL-3.0-or-later
// Clips on vessels: how one sits, and what a cut opens. Nothing here refuses: whatever a hand can do can be done; the
// results describe it, and events are the caller's.
//
// Distances are arc lengths at rest along one branch, so pulling on a vessel changes none of it. Clips on another
// branch are not looked for.
#pragma once

#include <cstddef>

#include "sim/vessel/beam_state.h"

namespace calot {

/// A clip about to close around a vessel.
struct ClipAttempt {
  BeamPoint point;     ///< middle of the clip
  double width = 0.0;  ///< along the vessel (m)
  double legs = 0.0;   ///< from the crotch to the tips of its legs (m)
  double depth =
      0.0;            ///< of the centre line: distance from the crotch towards the tips (m), negative behind the crotch
  double roll = 0.0;  ///< direction in which it flattens, about z of centreLine() there, from x (rad)
  double closure = 1.0;  ///< 0 open to 1 closed
};

/// Seat of a clip, as facts: faults are judged elsewhere.
struct ClipSeat {
  static constexpr double none = 1e300;

  double enclosed = 0.0;      ///< share of the flattened section (its width is pi r) between the legs, 0 to 1
  bool missed = false;        ///< nothing between the legs
  int clip = -1;              ///< nearest clip on the same piece; -1: none
  double clipGap = none;      ///< to its edge, negative where they overlap (m)
  double junctionGap = none;  ///< to the nearest junction on the same piece, negative across it (m)
  double endGap = none;       ///< to the nearest end of the piece, parted or not, negative beyond it (m)
};

ClipSeat clipSeat(const BeamModel& model, const BeamState& state, const ClipAttempt& attempt);

/// Sets a clip: it pinches the tube and, over its width, lets it neither stretch nor bend (fifty times as stiff,
/// without force in the shape that the vessel has now). Its own mass is left out. @param enclosed of clipSeat(), above
/// 0
void setClip(const BeamModel& model, BeamState& state, const ClipAttempt& attempt, double enclosed);

/// True if this clip closes the lumen: it encloses all of the section and is closed to at least 95 %.
bool closes(const BeamState& state, std::size_t clip);

/// Flattening of the tube at a point: 0 round to 1 (walls touching), and its direction.
struct Pinch {
  double amount = 0.0;
  double roll = 0.0;  ///< of the clip that flattens most there
};

/// Flat over the width of a clip, round again one and a half radii beside it (smoothstep).
Pinch pinchAt(const BeamModel& model, const BeamState& state, std::size_t branch, double arcLength);

/// Half the thickness and half the width of a section (m): r and r when round; the wall's thickness and pi r / 2 when
/// flat (the girth stays about the same).
struct PinchedSection {
  double thin = 0.0;
  double wide = 0.0;
};
PinchedSection pinchedSection(const TubeSection& section, double amount);

/// Ends that a cut opens, and the clips between which it lies. "Before" is towards the branch's start, "after" towards
/// its end.
struct CutSides {
  int clipBefore = -1;  ///< nearest closing clip on the same piece; -1: none
  int clipAfter = -1;
  std::size_t before = 0;  ///< closing clips between the cut and the next parting, junction or end
  std::size_t after = 0;
  double gapBefore = 1e300;  ///< from the cut to that clip's edge (m)
  double gapAfter = 1e300;
  bool throughClip = false;  ///< within the width of a clip
  bool opensBefore = false;  ///< no clip closes this side: it leaks from the start or the next junction
  bool opensAfter = false;
};

/// To be asked before part(): the cut's own place must still be whole.
CutSides cutSides(const BeamModel& model, const BeamState& state, const BeamPoint& cut);

}  // namespace calot
