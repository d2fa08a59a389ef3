// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/instruments/instruments.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "sim/instruments/instrument_shape.h"

namespace calot {

constinit const InstrumentDefinition instrument::none{.name = "none", .word = "nothing"};

namespace {

#define CALOT_INSTRUMENT_ADDRESS(name, number) &instrument::name,
constexpr std::array mountable{CALOT_INSTRUMENTS(CALOT_INSTRUMENT_ADDRESS)};
#undef CALOT_INSTRUMENT_ADDRESS

/// Definitions by number; null where no instrument has it.
constexpr std::array<const InstrumentDefinition*, 256> byNumber = [] {
  std::array<const InstrumentDefinition*, 256> table{&instrument::none};
#define CALOT_INSTRUMENT_PLACE(name, number) table[number] = &instrument::name;
  CALOT_INSTRUMENTS(CALOT_INSTRUMENT_PLACE)
#undef CALOT_INSTRUMENT_PLACE
  return table;
}();

}  // namespace

std::span<const InstrumentDefinition* const> instruments() { return mountable; }

const InstrumentDefinition& instrumentOf(InstrumentKind kind) {
  const InstrumentDefinition* const known = byNumber[static_cast<std::size_t>(kind)];
  return known == nullptr ? instrument::none : *known;
}

const InstrumentDefinition* findInstrument(std::string_view name) {
  const auto* const found =
      std::find_if(mountable.begin(), mountable.end(), [name](const auto* each) { return each->name == name; });
  return found == mountable.end() ? nullptr : *found;
}

bool isInstrumentNumber(unsigned number) { return number < byNumber.size() && byNumber[number] != nullptr; }

// Jaws of 16 mm at a shaft of 5 mm, with a lift that leaves room for a clip; twice as large at 10 mm.
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

// Jaws of 17 mm, 3.9 to 2.6 mm wide.
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

// Electrode shaped like an L: wire of 1.2 mm, toe 4.6 mm.
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

// A rod with a round end, to palpate and to push aside with.
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

// Curved blades of 15 mm.
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
