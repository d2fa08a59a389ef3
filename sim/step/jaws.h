// SPDX-License-Identifier: GPL-3.0-or-later
// Jaw angles at which instruments act. Internal to this folder.
#pragma once

namespace calot {

/// Jaws opened wider than this act when they close next (rad). Smaller: a twitch lets go; larger: hands must open far.
/// Assumed, as the others here.
inline constexpr double openJaw = 0.35;
inline constexpr double openBlades = 0.7;  ///< the same for scissors: blades that close further cut (rad)
inline constexpr double closedJaw = 0.25;  ///< jaws closed further grasp, clip or cut what is between them (rad)

}  // namespace calot
