// SPDX-License-Identifier: GPL-3.0-or-later
// The files that declare checkpoints. Internal to this folder; for the registry.
#pragma once

#include <span>
#include <vector>

#include "analytics/checkpoints/checkpoint.h"

namespace calot::analytics {

using EntriesOfFile = std::vector<CheckpointEntry> (*)();

/// One function per file of analytics/checkpoints/figures, sorted by the file's name.
std::span<const EntriesOfFile> figureFiles();

}  // namespace calot::analytics
