// SPDX-License-Identifier: GPL-3.0-or-later
// Columns of rest compliances that all sessions of a scene share, on any thread; and how they come back from a file
// that is not to be believed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "sim/solid/compliance_store.h"

namespace calot::recorder {

/// A column with its place: number of the solid, of the node.
struct ComplianceColumn {
  std::uint32_t solid = 0, node = 0;
  std::vector<float> value;
};

class SharedCompliances final : public ComplianceStore {
 public:
  [[nodiscard]] const float* find(std::size_t solid, std::size_t node) override;
  const float* keep(std::size_t solid, std::size_t node, std::vector<float> column) override;

  /// Columns that are said to be this scene's. A solid's are given out once one of them was worked out here and came
  /// out the same; where one differs, none of any solid is. @pre before the first find()
  void offer(std::vector<ComplianceColumn> columns);

  /// All that are held, those offered and not refuted too.
  [[nodiscard]] std::vector<ComplianceColumn> columns() const;
  /// How many of them were worked out here.
  [[nodiscard]] std::size_t computed() const;
  /// Was an offered column refuted?
  [[nodiscard]] bool refuted() const;

 private:
  using Place = std::pair<std::size_t, std::size_t>;

  mutable std::mutex mutex_;
  std::map<Place, std::unique_ptr<const std::vector<float>>> held_;
  std::map<Place, std::vector<float>> offered_;
  std::map<std::size_t, bool> proven_;  ///< per solid
  std::size_t computed_ = 0;
  bool refuted_ = false;
};

}  // namespace calot::recorder
