// SPDX-License-Identifier: GPL-3.0-or-later
// Jaws of 17 mm, 3.9 to 2.6 mm wide.
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/instruments/instrument_shape.h"
#include "sim/instruments/instruments.h"

namespace calot {

constinit const InstrumentDefinition instrument::grasper{
    .kind = InstrumentKind::grasper,
    .name = "grasper",
    .word = "grasper",
    .action = InstrumentAction::grasp,
    .jawLength = 17.0 * mm,
    .jawWidth = 3.9 * mm,
    .teethLength = 0.8 * (17.0 * mm),
    .shape =
        [](ShapeBuilder& shape) {
          const double m = shape.millimetre();
          const double jaw = instrument::grasper.jawLength * shape.scale();
          shape.setHinge(-jaw);
          // Each jaw: two bars side by side that come together towards the tip.
          for (const double side : {-1.0, 1.0}) {
            shape.addJaws(Vec3(side * 1.2 * m, 1.15 * m, 0.5 * m), Vec3(side * 0.55 * m, 0.5 * m, jaw - 0.75 * m),
                          0.75 * m);
          }
          const double sleeve = -jaw - 9.0 * m;
          shape.addFork(sleeve);
          shape.addShaft(sleeve);
        },
};

}  // namespace calot
