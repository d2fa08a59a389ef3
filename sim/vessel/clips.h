// SPDX-License-Identifier: GPL-3.0-or-later
// Clips on vessels, and the geometry by which setting a clip and cutting a vessel are judged. Nothing here refuses:
// whatever a hand can do can be done; the answers say what it was, and events are the caller's.
//
// Distances are arc lengths at rest along one branch, so pulling on a vessel changes no judgement. Clips on another
// branch are not looked for.
#pragma once

#include <cstddef>

#include "sim/vessel/beam_state.h"

namespace calot {

/// A clip about to close around a vessel.
struct ClipAttempt {
  BeamPlace place;       ///< middle of the clip
  double width = 0.0;    ///< along the vessel (m)
  double legs = 0.0;     ///< from the crotch to the tips of its legs (m)
  double depth = 0.0;    ///< of the centre line between the legs: distance from the crotch (m), negative behind it
  double roll = 0.0;     ///< direction in which it flattens, about z of centreLine() there, from x (rad)
  double closure = 1.0;  ///< 0 open to 1 closed
};

/// Scene data: from how near on is too near (m).
struct ClipRules {
  double leastGap = 0.0;          ///< between the edges of two clips
  double leastJunctionGap = 0.0;  ///< between a clip's edge and a place where vessels meet
};

struct ClipJudgement {
  double enclosed = 0.0;       ///< share of the flattened section (its width is pi r) between the legs, 0 to 1
  bool missed = false;         ///< nothing between the legs
  bool halfOn = false;         ///< something, but not all
  bool onClip = false;         ///< overlaps a clip
  bool nearClip = false;       ///< does not, but is nearer to one than the rules want
  bool nearJunction = false;   ///< nearer to a junction than the rules want, or across it
  bool onEdge = false;         ///< reaches beyond the edge of a parted or an ending vessel
  int clip = -1;               ///< nearest clip on the same piece; -1: none
  double clipGap = 1e300;      ///< to its edge, negative where they overlap (m)
  double junctionGap = 1e300;  ///< to the nearest junction, negative across it (m)
};

ClipJudgement judgeClip(const BeamModel& model, const BeamState& state, const ClipAttempt& attempt,
                        const ClipRules& rules);

/// Sets a clip: it pinches the tube and, over its width, lets it neither stretch nor bend (fifty times as stiff,
/// without force in the shape that the vessel has now). Its own mass is left out. @param enclosed of judgeClip(), above
/// 0
void setClip(const BeamModel& model, BeamState& state, const ClipAttempt& attempt, double enclosed);

/// Does this clip close the lumen? It encloses all of the section and is closed to at least 95 %.
bool closes(const BeamState& state, std::size_t clip);

/// How flat the tube is at a place: 0 round to 1 (walls on each other), and in which direction.
struct Pinch {
  double amount = 0.0;
  double roll = 0.0;  ///< of the clip that pinches most there
};

/// Flat over the width of a clip, round again one and a half radii beside it (smoothstep).
Pinch pinchAt(const BeamModel& model, const BeamState& state, std::size_t branch, double place);

/// Half the thickness and half the width of a section (m): r and r when round; the wall's thickness and pi r / 2 when
/// flat (the girth stays about the same).
struct PinchedSection {
  double thin = 0.0;
  double wide = 0.0;
};
PinchedSection pinchedSection(const TubeSection& section, double amount);

/// What a cut opens and between which clips it lies. "Before" is towards the branch's start, "after" towards its end.
struct CutJudgement {
  int clipBefore = -1;  ///< nearest closing clip on the same piece; -1: none
  int clipAfter = -1;
  std::size_t before = 0;  ///< closing clips between the cut and the next parting, junction or end
  std::size_t after = 0;
  double gapBefore = 1e300;  ///< from the cut to that clip's edge (m)
  double gapAfter = 1e300;
  bool throughClip = false;  ///< within the width of a clip
  bool opensBefore = false;  ///< nothing closes this side: it leaks from the start or the next junction
  bool opensAfter = false;
};

/// Judge before part(): the cut's own place must still be whole.
CutJudgement judgeCut(const BeamModel& model, const BeamState& state, const BeamPlace& cut);

}  // namespace calot
