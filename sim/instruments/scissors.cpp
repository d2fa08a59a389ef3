// SPDX-License-Identifier: GPL-3.0-or-later
// Curved blades of 15 mm.
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/instruments/instrument_shape.h"
#include "sim/instruments/instruments.h"

namespace calot {

constinit const InstrumentDefinition instrument::scissors{
    .kind = InstrumentKind::scissors,
    .name = "scissors",
    .word = "scissors",
    .action = InstrumentAction::cut,
    // Blades must open about a vessel before they cut. Assumed.
    .jaw = {.opened = 0.7},
    .jawLength = 15.0 * mm,
    .jawWidth = 6.0 * mm,  // the blades are curved to one side
    .bladeLength = 12.0 * mm,
    .shape =
        [](ShapeBuilder& shape) {
          const double m = shape.millimetre();
          const double length = instrument::scissors.jawLength;
          const double s = shape.scale();
          shape.setHinge(-length * s);
          // A pointed blade, curved along the hinge's line.
          shape.addJaws(Vec3(0.0, 0.9 * m, 0.5 * m), Vec3(0.7 * m, 0.6 * m, 0.5 * length * s), 0.9 * m);
          shape.addJaws(Vec3(0.7 * m, 0.6 * m, 0.5 * length * s), Vec3(2.5 * m, 0.4 * m, length * s - 0.5 * m),
                        0.5 * m);
          const double sleeve = -length * s - 9.0 * m;
          shape.addFork(sleeve);
          shape.addShaft(sleeve);
        },
};

}  // namespace calot
