// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace calot::gui {

/// Nice values above the program's: a thread of the second has about a ninth of the share of the interface's and the
/// simulation's, one of the first four tenths.
inline constexpr int behindInterface = 4;    ///< reading, replays, imports: somebody waits for them
inline constexpr int behindEverything = 10;  ///< pictures: the next one replaces what is late

/// The calling thread, and those it starts from here on, come after the program's other ordinary threads where all of
/// them want the processor at once: pictures and reading wait for the interface and the simulation, never the other way
/// round. Where the processor is free it changes nothing. May be called between fork and exec.
void stepBack(int behind);

}  // namespace calot::gui
