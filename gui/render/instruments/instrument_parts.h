// SPDX-License-Identifier: GPL-3.0-or-later
// What the drawings of instruments have in common, and the drawings: one per instrument, in a file of its own here.
// Sizes are those of the contact shapes (sim/instruments). Internal to this folder and instrument_mesh.cpp.
#pragma once

#include <vector>

#include "gui/render/instrument_mesh.h"
#include "gui/render/loft.h"

namespace calot::gui {

inline constexpr double mm = 1e-3;  ///< m
inline constexpr int around = 20;   ///< points of a ring

/// The parts of one instrument, as they are drawn. All lengths are in metres, scaled: a drawing multiplies the sizes of
/// a 5 mm instrument with `scale()`.
class InstrumentParts {
 public:
  explicit InstrumentParts(const InstrumentView& instrument);

  [[nodiscard]] double scale() const { return scale_; }
  [[nodiscard]] double jaw() const { return jaw_; }  ///< opening angle (rad)

  void add(Appearance appearance, Mesh mesh);
  /// The insulated shaft, from outside the port to `end` (z).
  void addShaft(double end);
  /// What all instruments with jaws share: shaft, fork, pin. @param jawLength from the hinge to the tips
  /// @param forkLength from the shaft's end to the hinge
  void addHinged(double jawLength, double forkLength);
  /// Both jaws, opened. @param upper, lower from the hinge at z = 0 along z, inner faces at y = 0 when closed
  void addJaws(const Mesh& upper, const Mesh& lower, double jawLength);

  [[nodiscard]] std::vector<InstrumentPart> take() { return std::move(parts_); }

 private:
  std::vector<InstrumentPart> parts_;
  double scale_;
  double jaw_;
  double shaftStart_;
};

/// The other jaw: y to -y.
[[nodiscard]] Mesh mirrored(Mesh mesh);

namespace drawing {
#define CALOT_DRAWING_DECLARED(name, number) void name(InstrumentParts& parts);
CALOT_INSTRUMENTS(CALOT_DRAWING_DECLARED)
#undef CALOT_DRAWING_DECLARED
}  // namespace drawing

}  // namespace calot::gui
