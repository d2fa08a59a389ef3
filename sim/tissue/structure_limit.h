// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

namespace calot {

/// Most structures (organs, vessels and bodies of fat together) of a scene. The key of a contact block has four bits
/// for its structure; masks of structures, as HandResult::touching, have 32. A scene with more is refused at load.
inline constexpr std::size_t maxStructures = 16;

}  // namespace calot
