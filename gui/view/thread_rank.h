// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace calot::gui {

/// The calling thread, and those it starts from here on, come after the program's other ordinary threads where all of
/// them want the processor at once: pictures and reading wait for the interface and the simulation, never the other way
/// round. Where the processor is free it changes nothing. May be called between fork and exec.
void stepBack();

}  // namespace calot::gui
