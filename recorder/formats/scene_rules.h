// SPDX-License-Identifier: GPL-3.0-or-later
// Rules across the fields of a scene file, beyond those of single fields (SceneDescription::fields()).
#pragma once

#include "recorder/base/json_reader.h"
#include "sim/scene/description.h"

namespace calot::recorder {

/// Checks a scene whose fields and surfaces were read, and completes what other fields decide: the camera's
/// orientation, and roles. Rules over fields that have faults are skipped.
/// @param root the scene file
/// @throws Error (damaged), naming the place
void applySceneRules(const JsonPlace& root, SceneDescription& scene);

/// Gives roles to the tissue of a scene that states none, as recordings made before scenes had roles: liver and
/// gallbladder by appearance; a vessel grown to a gallbladder is the cystic duct or, where it does not look like a
/// duct, the cystic artery; other vessels are bile ducts or arteries by appearance; connective tissue on a gallbladder
/// is the cystic plate, and all fat is that of Calot's triangle. Nowhere else is appearance more than a look.
void deriveRoles(SceneDescription& scene);

}  // namespace calot::recorder
