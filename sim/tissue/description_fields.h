// SPDX-License-Identifier: GPL-3.0-or-later
// Fields that several parts of a scene have (sim/math/record.h).
#pragma once

#include <initializer_list>

#include "sim/math/record.h"
#include "sim/tissue/structure_role.h"

namespace calot {

/// A name that goes into columns and file names.
inline constexpr TextRule sceneName{64, "^[a-z0-9][a-z0-9-]*$",
                                    "small letters, digits and hyphens are allowed, the first no hyphen"};

/// A coordinate (m): a scene is a part of one abdomen, so nothing lies farther from the origin.
inline constexpr Range sceneCoordinate = within(-1, 1);

/// The key "role" of a tissue, which has one of these roles, or `other`.
Field roleField(const Access& access, std::initializer_list<StructureRole> roles);

}  // namespace calot
