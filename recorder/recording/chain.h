// SPDX-License-Identifier: GPL-3.0-or-later
// The content chain (schemas/recording.md, "Content chain"): BLAKE2b-256 over decoded values, one link a flush.
// Internal to this folder.
#pragma once

#include <array>
#include <cstdint>

#include "recorder/recording/block.h"
#include "recorder/recording/layout.h"
#include "recorder/recording/reader.h"

namespace calot::recorder {

using ChainHead = std::array<std::uint8_t, 32>;

/// Link 0: root attributes, scene, names.
ChainHead chainStart(const AttemptHeader& header);

/// The next link: the rows of a block and the counts of its row of /status. @param before the row before it.
ChainHead chainNext(const Layout& layout, const StatusRow& before, const Block& block, const StatusRow& after);

}  // namespace calot::recorder
