// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

#include "sim/math/linear.h"

// The one list of instruments. Each has a definition of this name in namespace instrument (sim/instruments) and a
// drawing of this name (gui/render): a missing one does not link. docs/extending/index.md says how to add one.
/// Name in code, and the number that recordings store, which is never reused. In the order of the trainer's keys.
#define CALOT_INSTRUMENTS(ENTRY) \
  ENTRY(grasper, 1)              \
  ENTRY(hook, 2)                 \
  ENTRY(clipApplier, 3)          \
  ENTRY(scissors, 4)             \
  ENTRY(probe, 5)

namespace calot {

enum class Hand : std::uint8_t { left = 0, right = 1 };
inline constexpr int handCount = 2;
inline constexpr std::array<const char*, handCount> handNames{"left", "right"};

/// Instrument mounted on a hand's shaft: none, or one of the list above.
/// `instrumentOf` (sim/instruments/instruments.h) gives all that is known of a kind.
#define CALOT_INSTRUMENT_NUMBER(name, number) name = (number),
enum class InstrumentKind : std::uint8_t { none = 0, CALOT_INSTRUMENTS(CALOT_INSTRUMENT_NUMBER) };
#undef CALOT_INSTRUMENT_NUMBER

/// Bits of InstrumentSample::buttons.
namespace button {
inline constexpr std::uint8_t cutPedal = 1U << 0U;        ///< yellow pedal: cut
inline constexpr std::uint8_t coagulatePedal = 1U << 1U;  ///< blue pedal: coagulation
inline constexpr std::uint8_t fire = 1U << 2U;            ///< closes a clip
inline constexpr std::uint8_t lock = 1U << 3U;            ///< ratchet of a grasper
inline constexpr std::uint8_t retractMore = 1U << 4U;     ///< asks the assistant, as it goes down, for a stage more
inline constexpr std::uint8_t retractLess = 1U << 5U;     ///< or less retraction
}  // namespace button

/// One hand during one tick (1 ms): the device's real pose, in W, before any constraint.
struct InstrumentSample {
  Vec3 position = Vec3::Zero();         ///< p_WI, instrument tip (m)
  Quat orientation = Quat::Identity();  ///< q_WI; I: z along the shaft towards the tip, x across the jaw's hinge
  double jaw = 0.0;                     ///< opening angle of the jaws (rad), 0 closed
  InstrumentKind instrument = InstrumentKind::grasper;
  std::uint8_t buttons = 0;
  bool valid = true;  ///< false: the source had no measurement; the pose of the last valid tick is held
};

/// Endoscope pose in W: x right, y down, z forward (along the view). What the operator saw is an input too.
struct CameraSample {
  Vec3 position = Vec3::Zero();         ///< p_WC (m)
  Quat orientation = Quat::Identity();  ///< q_WC
};

/// All inputs of one tick.
struct TickSamples {
  std::array<InstrumentSample, handCount> hand;
  CameraSample camera;
};

/// Rounds to the grid on which samples are recorded, so that what is logged is what was simulated: positions to
/// 2^-20 m, quaternion components to 2^-16, jaw angles to 2^-16 rad. Not normalised: the core normalises.
TickSamples roundedToGrid(const TickSamples& samples);

}  // namespace calot
