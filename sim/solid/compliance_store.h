// SPDX-License-Identifier: GPL-3.0-or-later
// Cache of a scene's rest compliances, shared by steppers. They depend on the Model alone, so every
// run of it can have them from any other.
#pragma once

#include <cstddef>
#include <vector>

namespace calot {

class ComplianceStore {
 public:
  ComplianceStore() = default;
  ComplianceStore(const ComplianceStore&) = delete;
  ComplianceStore& operator=(const ComplianceStore&) = delete;
  virtual ~ComplianceStore() = default;

  /// The column of a node (RestCompliance), or null: the caller then computes it. It stays where it is for as long as
  /// the store is there. Steppers of several threads may call at the same time.
  /// @param solid organs of the Model, then its bodies of fat
  [[nodiscard]] virtual const float* find(std::size_t solid, std::size_t node) = 0;
  /// Takes a column that find() did not have. @returns the one that is kept, with the same numbers
  virtual const float* keep(std::size_t solid, std::size_t node, std::vector<float> column) = 0;
};

/// A solid's part of a store; of none, the solid keeps its columns itself.
struct ComplianceShelf {
  ComplianceStore* store = nullptr;
  std::size_t solid = 0;
};

}  // namespace calot
