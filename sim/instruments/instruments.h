// SPDX-License-Identifier: GPL-3.0-or-later
// Definitions of the instruments. Each has its definition in a file of its own here; the step, scene files,
// recordings, pictures and the trainer take from it what they need.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "sim/scene/samples.h"

namespace calot {

class ShapeBuilder;

/// Effect of an instrument on tissue, besides pushing it.
enum class InstrumentAction : std::uint8_t {
  none,
  grasp,  ///< closing jaws hold the tissue between them
  burn,   ///< its electrode burns, chars and carves while a pedal gives it current
  clip,   ///< closing jaws, or the fire button, set one of the hand's clips
  cut,    ///< closing blades part a vessel
};

/// Jaw angles at which an instrument acts. `opened` is above `closed`.
struct JawAngles {
  /// Jaws opened wider than this let go, and act when they close next (rad). Smaller: a twitch lets go; larger: hands
  /// must open far. Assumed. What has no jaws keeps account of the angle, too.
  double opened = 0.35;
  /// Jaws closed further than this have closed on what is between them (rad). Smaller: hands must press hard; larger:
  /// tissue is caught in passing. Assumed.
  double closed = 0.25;
};

/// Lengths are those of a 5 mm instrument, and scale with the shaft's radius where nothing else is said.
struct InstrumentDefinition {
  InstrumentKind kind = InstrumentKind::none;
  const char* name;  ///< in scene files: small letters and hyphens, "clip-applier". Never reused
  const char* word;  ///< for people: "clip applier"
  InstrumentAction action = InstrumentAction::none;
  JawAngles jaw = {};
  double jawLength = 0.0;    ///< from hinge to tips (m); 0: no jaws
  double jawWidth = 0.0;     ///< along the hinge's line (m)
  double teethLength = 0.0;  ///< of action `grasp`: toothed part of the jaws, from their tips (m)
  double bladeLength = 0.0;  ///< of action `cut`: what cuts of the blades, from their tips (m); not scaled
  /// Adds the capsules that make the shape, in an order that does not depend on jaw angle and insertion. Null for
  /// nothing mounted.
  void (*shape)(ShapeBuilder& shape) = nullptr;
};

namespace instrument {
extern const InstrumentDefinition none;  ///< nothing is mounted
#define CALOT_INSTRUMENT_DECLARED(name, number) extern const InstrumentDefinition name;
CALOT_INSTRUMENTS(CALOT_INSTRUMENT_DECLARED)
#undef CALOT_INSTRUMENT_DECLARED
}  // namespace instrument

/// All that can be mounted, in the list's order.
std::span<const InstrumentDefinition* const> instruments();

/// Total: a number that no instrument has counts as nothing mounted.
const InstrumentDefinition& instrumentOf(InstrumentKind kind);

/// Instrument by its name in scene files; null if unknown.
const InstrumentDefinition* findInstrument(std::string_view name);

/// True for the number of an instrument, and for 0 (none).
bool isInstrumentNumber(unsigned number);

}  // namespace calot
