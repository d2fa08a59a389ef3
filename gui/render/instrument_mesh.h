// SPDX-License-Identifier: GPL-3.0-or-later
// Common parts of the drawings of instruments, and the drawings: one per instrument, in a file of its own here.
// Sizes are those of the contact shapes (sim/instruments). Internal to this folder and instrument_mesh.cpp.
#pragma once

#include <vector>

#include "gui/render/draw_list.h"
#include "gui/render/mesh.h"
#include "sim/scene/scene_view.h"

namespace calot::gui {

struct InstrumentPart {
  Appearance appearance = Appearance::steel;
  Mesh mesh;  ///< in the instrument's frame I: origin at the tip, z along the shaft towards it, x along the jaws' hinge
              ///< (m)
};

/// Shaft from beyond the port to the tip, and what the instrument carries there, jaws opened by instrument.jaw between
/// them. Sizes follow 5 mm instruments of the trade and scale with the shaft's radius. Nothing where none is mounted.
[[nodiscard]] std::vector<InstrumentPart> makeInstrument(const InstrumentView& instrument);

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
  /// Parts shared by all instruments with jaws: shaft, fork, pin. @param jawLength from the hinge to the tips
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

/// A closed clip in its own frame (m): two flat legs along y around a gap of three quarters of 2 halfGap (they bite
/// into the wall), joined by a crotch at y = -legs / 2, a little open there as bent wire stays; `width` along z. Wire
/// thickness is half the width.
[[nodiscard]] Mesh makeClip(const ClipView& clip);

}  // namespace calot::gui
