// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

namespace calot::recorder {

/// A State's digest in the short form that recordings from format version 2 on hold (schemas/recording.md, "Steps").
struct BriefDigest {
  std::uint64_t state = 0;           ///< XXH3-64 of the digests of components
  std::vector<std::uint16_t> field;  ///< low 16 bits of each field's
  bool operator==(const BriefDigest&) const = default;
};

}  // namespace calot::recorder
