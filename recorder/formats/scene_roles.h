// SPDX-License-Identifier: GPL-3.0-or-later
// Roles of the structures of a scene file. Internal to this folder.
#pragma once

#include <initializer_list>

#include "recorder/base/json_reader.h"
#include "sim/scene/description.h"

namespace calot::recorder {

/// The object's role; `other` where it states none.
/// @param allowed roles that such tissue can have, beside `other`.
/// @throws Error damaged, naming the place and the roles allowed.
StructureRole readRole(const JsonObject& object, std::initializer_list<StructureRole> allowed);

/// Does any tissue of the scene state its role? @param root the scene file's object, read without fault.
bool statesRoles(const JsonObject& root);

/// Gives roles to the tissue of a scene that states none, as recordings made before scenes had roles: liver and
/// gallbladder by appearance; a vessel grown to a gallbladder is the cystic duct or, where it does not look like a
/// duct, the cystic artery; other vessels are bile ducts or arteries by appearance; connective tissue on a gallbladder
/// is the cystic plate, and all fat is that of Calot's triangle. Nowhere else is appearance more than a look.
void deriveRoles(SceneDescription& scene);

}  // namespace calot::recorder
