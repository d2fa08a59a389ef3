// SPDX-License-Identifier: GPL-3.0-or-later
// The 1 kHz tick: the only code that makes a force. It solves the reduced complementarity problem that the simulation
// published (Saupin, Duriez and Cotin 2008, "Contact model for haptic medical simulations"), for the hand's newest
// pose.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/math/fields.h"
#include "sim/math/linear.h"

namespace calot {

/// The contact problem of one hand as a step left it, reduced to the instrument's tip: gaps are
///   gap = free + T (p - reference) + W lambda,  force on the tip = T^T lambda,
/// with p the tip's real place, T one row per contact, W the compliance of organs and virtual coupling together.
struct ContactSet {
  std::int64_t step = -1;          ///< the step that made it; -1: before the first
  Vec3 reference = Vec3::Zero();   ///< real tip for which `free` holds (m)
  std::vector<Vec3> direction;     ///< rows of T
  std::vector<double> free;        ///< m
  std::vector<double> compliance;  ///< W, row-major (m/N)
  std::vector<std::uint64_t> key;  ///< which place each row is
  std::vector<double> lambda;      ///< the step's own solution (N), warm start

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("step", self.step);
    visit("reference", self.reference);
    visit("direction", self.direction);
    visit("free", self.free);
    visit("compliance", self.compliance);
    visit("key", self.key);
    visit("lambda", self.lambda);
  }
};

/// What the tick carries from one to the next. Never part of State.
struct HapticState {
  Vec3 tip = Vec3::Zero();     ///< real tip of the newest measurement, held while there is none (m)
  std::int64_t set = -1;       ///< step of the contact set that `lambda` belongs to
  std::vector<double> lambda;  ///< N

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("tip", self.tip);
    visit("set", self.set);
    visit("lambda", self.lambda);
  }
};

/// Do the sizes of a set's rows fit each other? (For what was read from a file.)
bool isConsistent(const ContactSet& set);
/// Can these states meet in a tick?
bool isConsistent(const HapticState& state, const ContactSet& set);

/// What the tick needs to know of a hand.
struct HapticModel {
  double largestForce = 8.0;  ///< what the device can do (N)
  std::uint32_t sweeps = 20;  ///< of the reduced problem
  double tolerance = 1e-7;    ///< m
};

struct HapticForce {
  Vec3 force = Vec3::Zero();   ///< f_W on the hand (N)
  Vec3 torque = Vec3::Zero();  ///< about the tip, in W (N m); contact without friction turns nothing about the shaft
};

/// One tick. Allocates only where a contact set has more rows than any before it (HapticState's capacity).
/// @pre takeSample() took this tick's sample
HapticForce hapticTick(const HapticModel& model, HapticState& state, const ContactSet& set);

}  // namespace calot
