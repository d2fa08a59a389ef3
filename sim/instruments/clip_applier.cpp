// SPDX-License-Identifier: GPL-3.0-or-later
// Jaws of 16 mm at a shaft of 5 mm, with a lift that leaves room for a clip; twice as large at 10 mm.
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/instruments/instrument_shape.h"
#include "sim/instruments/instruments.h"

namespace calot {

constinit const InstrumentDefinition instrument::clipApplier{
    .kind = InstrumentKind::clipApplier,
    .name = "clip-applier",
    .word = "clip applier",
    .action = InstrumentAction::clip,
    .jawLength = 16.0 * mm,
    .jawWidth = 3.5 * mm,
    .shape =
        [](ShapeBuilder& shape) {
          const double m = shape.millimetre();
          const double length = instrument::clipApplier.jawLength;
          const double s = shape.scale();
          shape.setHinge(-length * s);
          // A bar that first leaves the axis and then runs along it, its end turned inward.
          shape.addJaws(Vec3(0.0, 0.3 * m, 0.0), Vec3(0.0, 1.9 * m, 0.35 * length * s), 1.1 * m);
          for (const double side : {-1.0, 1.0}) {
            shape.addJaws(Vec3(side * 0.8 * m, 1.9 * m, 0.35 * length * s),
                          Vec3(side * 0.65 * m, 1.6 * m, length * s - 0.95 * m), 0.95 * m);
          }
          const double sleeve = -length * s - 10.0 * m;
          shape.addFork(sleeve);
          shape.addShaft(sleeve);
        },
};

}  // namespace calot
