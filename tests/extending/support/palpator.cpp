// SPDX-License-Identifier: GPL-3.0-or-later
// A rod with a ball at its end: an example of an instrument. As one of Calot's it would stand in sim/instruments, and
// its kind and name would be its own.
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/instruments/instrument_shape.h"
#include "sim/instruments/instruments.h"
#include "tests/extending/support/examples.h"

namespace calot::instrument {

const InstrumentDefinition palpator{
    .kind = InstrumentKind::probe,
    .name = "palpator",
    .word = "palpator",
    .action = InstrumentAction::none,
    .shape =
        [](ShapeBuilder& shape) {
          const double mm = shape.millimetre();
          // The ball, 8 mm wide, ends at the tip; the shaft begins behind it.
          shape.add(Vec3(0.0, 0.0, -4.0 * mm), Vec3(0.0, 0.0, -4.0 * mm), 4.0 * mm, Capsule::Part::neck);
          shape.addShaft(-6.0 * mm);
        },
};

}  // namespace calot::instrument
