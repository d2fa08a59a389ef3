// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/instrument_mesh.h"

#include "gui/render/instruments/instrument_parts.h"

namespace calot::gui {

std::vector<InstrumentPart> makeInstrument(const InstrumentView& instrument) {
  InstrumentParts parts(instrument);
  switch (instrument.kind) {
    case InstrumentKind::none:
      break;
#define CALOT_DRAWN(name, number) \
  case InstrumentKind::name:      \
    drawing::name(parts);         \
    break;
      CALOT_INSTRUMENTS(CALOT_DRAWN)
#undef CALOT_DRAWN
  }
  return parts.take();
}

}  // namespace calot::gui
