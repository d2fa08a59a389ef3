// SPDX-License-Identifier: GPL-3.0-or-later
// A rod with a round end, to palpate and to push aside with.
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/instruments/instrument_shape.h"
#include "sim/instruments/instruments.h"

namespace calot {

constinit const InstrumentDefinition instrument::probe{
    .kind = InstrumentKind::probe,
    .name = "probe",
    .word = "probe",
    .action = InstrumentAction::none,
    .shape =
        [](ShapeBuilder& shape) {
          // The shaft's own round end, whose centre is a radius behind the tip.
          shape.addShaft((1.4 - 2.5) * shape.millimetre());
        },
};

}  // namespace calot
