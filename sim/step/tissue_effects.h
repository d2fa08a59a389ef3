// SPDX-License-Identifier: GPL-3.0-or-later
// Stage 8 of a step: what instruments and tension did to the tissue.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "sim/connective/connective_tissue.h"
#include "sim/scene/model.h"
#include "sim/scene/state.h"
#include "sim/step/bodies.h"
#include "sim/step/contact_block.h"
#include "sim/step/placed_instrument.h"
#include "sim/step/surfaces.h"
#include "sim/vessel/beam_state.h"

namespace calot {

// The way of an energised hook through a step. Internal to this folder.

/// An energised hook's way through a step.
struct HookSweep {
  std::vector<MovingCapsule> electrode;  ///< what carries current; empty: no current
  double pace = 1.0;                     ///< at which it divides tissue, of that of the cutting current
  double charring = 1.0;                 ///< char in the same time, of that by the coagulating current
  std::vector<std::uint8_t> piece;       ///< number of each capsule of the electrode
  std::size_t hand = 0;                  ///< that holds it

  [[nodiscard]] bool energised() const { return !electrode.empty(); }
};

/// Per hand. With both pedals pressed the current is the cutting one.
using HookSweeps = std::array<HookSweep, handCount>;

void sweepHooks(const Model& model, const InstrumentTravels& travels, const State& state, HookSweeps& sweeps);

/// The electrode as a structure's mesh meets it: out of the dimples that it presses (dimpleOf()).
void takeOutOfDimples(const HookSweep& sweep, std::size_t structure, const State& state, HookSweep& out);

/// Touched is what is no farther from the electrode than the scene's `reach`: strands, cells of organs' skins, stations
/// of vessels' walls, the surface of fat. Every share of the step is exact for straight motion (sim/geometry/dwell.h),
/// so that a sweep gives the same dose in steps of any length.
struct HookTouches {
  struct Cell {
    std::uint32_t structure = 0;  ///< an organ's
    std::uint32_t triangle = 0;
    std::uint32_t cell = 0;  ///< of the triangle
    double share = 0.0;      ///< of the step
  };
  struct Station {
    std::uint32_t structure = 0;  ///< a vessel's
    std::uint32_t station = 0;    ///< of its branch
    double share = 0.0;           ///< of the step
  };

  std::vector<std::vector<StrandTouch>> strand;  ///< per connective tissue
  std::vector<Cell> cell;
  std::vector<Station> station;
  std::vector<double> fat;  ///< per body of fat: area touched (m^2)
  double area = 0.0;        ///< of everything touched, in the mean over the step (m^2)

  [[nodiscard]] bool any() const { return area > 0.0; }
  /// Share of the power that each contact point gets: all of it as long as no more than `spot` is touched (m^2).
  [[nodiscard]] double intensity(double spot) const { return area > spot ? spot / area : 1.0; }
};

class HookTouchSearch {
 public:
  explicit HookTouchSearch(const Model& model) : model_(model) {}

  /// @pre surfaces are current, organs and instruments are where the step led them
  void run(const HookSweep& sweep, Bodies& bodies, const Surfaces& surfaces, const State& state, HookTouches& out);

 private:
  void touchConnective(const HookSweep& sweep, double step, const State& state, HookTouches& out) const;
  void touchOrgan(const HookSweep& sweep, std::size_t structure, const Bodies& bodies, const Surfaces& surfaces,
                  const State& state, HookTouches& out);
  void touchVessel(const HookSweep& sweep, std::size_t structure, const Bodies& bodies, const State& state,
                   HookTouches& out) const;
  void touchFat(const HookSweep& sweep, std::size_t structure, const Bodies& bodies, const Surfaces& surfaces,
                const State& state, HookTouches& out);
  /// Triangles of a skin that the sweep may touch, ascending.
  void findTriangles(const HookSweep& sweep, std::size_t structure, const Bodies& bodies, const Surfaces& surfaces,
                     const State& state);

  const Model& model_;
  HookSweep met_;
  Surfaces::Search search_;
  std::vector<std::uint32_t> triangle_;
};

// Damage that more than one stage does: organs opened, vessels parted.

/// Opens an organ that has a wall to be opened, once. @param exposure cautery there (s); 0: torn
void perforateOrgan(const Model& model, std::size_t organ, const Vec3& where, double exposure, State& state,
                    Activity& activity, StepLog& log);

/// Parts a vessel; reports it, what that leaves open, and the clips on either side of a cut.
/// @param kind vesselCut or vesselBurned
void partVessel(const Model& model, std::size_t structure, const BeamPoint& where, EventKind kind, std::size_t hand,
                State& state, Activity& activity, StepLog& log);

/// Reports what a vessel that tore in this step leaves open. @param element that tore
void reportTear(const Model& model, std::size_t tree, std::size_t element, State& state, StepLog& log);

// Clip appliers and scissors on vessels. Internal to this folder.

/// Effects of the jaws of clip appliers and scissors when they close after having been opened. Whatever a hand can do
/// is done and reported; nothing is refused.
class VesselTools {
 public:
  explicit VesselTools(const Model& model) : model_(model) {}
  void run(State& state, Activity& activity, StepLog& log);

 private:
  /// Part of a vessel that runs between jaws.
  struct Crossing {
    std::size_t structure = 0;
    BeamPoint place;
    double depth = 0.0;  ///< of its centre line from the jaws' crotch (m)
    double sine = 1.0;   ///< of the angle between vessel and jaws
    Pose frame;          ///< centre line there
  };

  [[nodiscard]] std::optional<Crossing> vesselBetween(const State& state, std::size_t hand, double length) const;
  bool isGripped(const State& state, std::size_t hand, const Crossing& crossing);
  void closeOne(std::size_t hand, State& state, Activity& activity, StepLog& log);
  void setClipOn(std::size_t hand, const std::optional<Crossing>& crossing, State& state, Activity& activity,
                 StepLog& log) const;

  const Model& model_;
  PlacedInstrument instrument_;
};

// Effects of the energised hook on fat, organs and vessels, and of tension on fat. Internal to this folder.
//
// Every place that is touched (HookTouches) counts the time that it got the full power. There are two counts. The
// wall's exposure decides what opens or parts; the coagulating current adds to it at `coagulationPace`. Char counts the
// time of coagulation; the cutting current adds to it at `cutChar`. Neither depends on the mesh, and neither can
// shrink.

class CauteryEffects {
 public:
  explicit CauteryEffects(const Model& model) : model_(model) {}

  /// Fills `cautery` of the hands and `carved`, `islands` of the fat. @pre surfaces are those after the step
  void run(const HookSweeps& sweeps, const std::array<HookTouches, handCount>& touches, Bodies& bodies,
           const Surfaces& surfaces, State& state, Activity& activity, StepResult& result, StepLog& log);

 private:
  /// Full power of a whole step of touch (s).
  struct Dose {
    double wall = 0.0;
    double charring = 0.0;
  };
  void charOrgans(const HookTouches& touches, const Dose& dose, const Surfaces& surfaces, State& state,
                  Activity& activity, StepLog& log) const;
  void burnVessels(const HookTouches& touches, const Dose& dose, std::size_t hand, State& state, Activity& activity,
                   StepLog& log) const;
  FatStroke carve(const HookSweep& sweep, const Dose& dose, std::size_t fat, Bodies& bodies, State& state,
                  Activity& activity);
  void tearFat(Bodies& bodies, State& state, Activity& activity, StepResult& result, StepLog& log);
  void findTied(std::size_t fat, const Bodies& bodies);
  void release(std::size_t fat, const Bodies& bodies, Activity& activity) const;
  [[nodiscard]] static std::uint32_t firstTouched(const HookTouches& touches, const Bodies& bodies);

  const Model& model_;
  HookSweep met_;
  std::vector<SweptCapsule> blades_;  ///< of the hook, as fat feels them
  std::vector<std::size_t> tied_;     ///< bodies that carried some of the fat before a stroke
};

// Effects of a step on connective tissue. Internal to this folder.

/// Burns the strands that the energised hooks touch; damages and tears those that are pulled too hard.
class ConnectiveEffects {
 public:
  explicit ConnectiveEffects(const Model& model) : model_(model) {}

  /// @pre organs and instruments are where the step leads them
  void run(const HookSweeps& sweeps, const std::array<HookTouches, handCount>& touches, Bodies& bodies, State& state,
           Activity& activity, StepResult& result, StepLog& log);

 private:
  const Model& model_;
  std::vector<std::uint32_t> strands_;
};

/// Strands burn and tear, jaws set clips and cut, the hook carves fat, chars organs and burns vessels, strings of fat
/// tear.
///
/// Reads: poses and surfaces after stage 7, travels. Writes: topology and damage in State (strands, clips, partings,
/// carved fields, char), what is written and disturbed in `activity`, the results of fat, connective tissue and
/// cautery.
class TissueEffects {
 public:
  explicit TissueEffects(const Model& model)
      : model_(model), search_(model), connective_(model), tools_(model), cautery_(model) {}

  /// @pre surfaces are current
  void run(const InstrumentTravels& travels, const Surfaces& surfaces, Bodies& bodies, State& state, Activity& activity,
           StepResult& result, StepLog& log) {
    sweepHooks(model_, travels, state, sweeps_);
    for (std::size_t h = 0; h < handCount; ++h) search_.run(sweeps_[h], bodies, surfaces, state, touches_[h]);
    connective_.run(sweeps_, touches_, bodies, state, activity, result, log);
    tools_.run(state, activity, log);
    cautery_.run(sweeps_, touches_, bodies, surfaces, state, activity, result, log);
  }

 private:
  const Model& model_;
  HookTouchSearch search_;
  ConnectiveEffects connective_;
  VesselTools tools_;
  CauteryEffects cautery_;
  HookSweeps sweeps_;
  std::array<HookTouches, handCount> touches_;
};

}  // namespace calot
