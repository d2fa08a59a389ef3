// SPDX-License-Identifier: GPL-3.0-or-later
// Tissue that an energised hook touches in a step, and for what share of it. Internal to this folder.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/connective/connective_tissue.h"
#include "sim/scene/model.h"
#include "sim/scene/state.h"
#include "sim/step/bodies.h"
#include "sim/step/contact_block.h"
#include "sim/step/surfaces.h"

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
  void run(const HookSweep& sweep, Bodies& bodies, Surfaces& surfaces, const State& state, HookTouches& out);

 private:
  void touchConnective(const HookSweep& sweep, double step, const State& state, HookTouches& out) const;
  void touchOrgan(const HookSweep& sweep, std::size_t structure, const Bodies& bodies, Surfaces& surfaces,
                  const State& state, HookTouches& out);
  void touchVessel(const HookSweep& sweep, std::size_t structure, const Bodies& bodies, const State& state,
                   HookTouches& out) const;
  void touchFat(const HookSweep& sweep, std::size_t structure, const Bodies& bodies, Surfaces& surfaces,
                const State& state, HookTouches& out);
  /// Triangles of a skin that the sweep may touch, ascending.
  void findTriangles(const HookSweep& sweep, std::size_t structure, const Bodies& bodies, Surfaces& surfaces,
                     const State& state);

  /// The electrode as an organ's mesh meets it: out of the dimples that it presses (contact_dimples.h).
  void takeOutOfDimples(const HookSweep& sweep, std::size_t structure, const State& state);

  const Model& model_;
  HookSweep met_;
  std::vector<std::uint32_t> triangle_;
};

}  // namespace calot
