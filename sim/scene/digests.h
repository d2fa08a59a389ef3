// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace calot {

/// Names of what is digested, fixed by the Model: components in order, and their fields in order.
struct DigestLayout {
  struct Field {
    std::uint32_t component = 0;
    std::string name;  ///< "organ.liver/position"
  };
  std::vector<std::string> components;  ///< "clock", "camera", "hand.left", "organ.liver", ...
  std::vector<Field> fields;
};

/// Digests of one State: XXH3-64 of each component's field bytes, and the low 32 bits of each field's own XXH3-64.
struct StateDigest {
  std::vector<std::uint64_t> component;
  std::vector<std::uint32_t> field;
  bool operator==(const StateDigest&) const = default;
};

}  // namespace calot
