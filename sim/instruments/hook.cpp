// SPDX-License-Identifier: GPL-3.0-or-later
// Electrode shaped like an L: wire of 1.2 mm, toe 4.6 mm.
#include "sim/math/no_fused_pairs.h"  // first

#include <cstddef>

#include "sim/instruments/instrument_shape.h"
#include "sim/instruments/instruments.h"

namespace calot {

constinit const InstrumentDefinition instrument::hook{
    .kind = InstrumentKind::hook,
    .name = "hook",
    .word = "hook",
    .action = InstrumentAction::burn,
    .shape =
        [](ShapeBuilder& shape) {
          const double m = shape.millimetre();
          const double wire = 0.6 * m;
          // Along the axis, a short bend in two chords, then across; its heel is the tip of the frame.
          const Vec3 path[] = {Vec3(0.0, 0.0, -10.0 * m), Vec3(0.0, 0.0, -1.9 * m), Vec3(0.0, 0.381 * m, -0.981 * m),
                               Vec3(0.0, 1.3 * m, -wire), Vec3(0.0, 4.6 * m, -wire)};
          for (std::size_t k = 0; k < 4; ++k) shape.add(path[k], path[k + 1], wire, Capsule::Part::electrode);
          const double sleeve = -13.0 * m;
          shape.add(Vec3(0.0, 0.0, sleeve), Vec3(0.0, 0.0, -11.3 * m), 1.9 * m, Capsule::Part::neck);
          shape.addShaft(sleeve);
        },
};

}  // namespace calot
