// SPDX-License-Identifier: GPL-3.0-or-later
// Values files of several shares, read as one (schemas/values.md).
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "analytics/shards/values_header.h"
#include "analytics/shards/values_row.h"
#include "recorder/base/errors.h"

namespace calot::analytics {

/// Every file is read and checked to its end before any row of it is given: what is refused leaves no trace. All files
/// are of one plan, that of the first good one; memory grows with the number of rows, not with their size.
class ValuesSet {
 public:
  /// @param refuse throws Error for a row that cannot be taken: its whole file is refused
  ValuesSet(const std::vector<std::filesystem::path>& files, SharedWork work,
            const std::function<void(const ValuesRow& row)>& refuse);

  /// Files that were refused, each with the reason.
  [[nodiscard]] const std::vector<Error>& refused() const { return refused_; }
  /// How many shares there are in all; 0: every file was refused.
  [[nodiscard]] std::uint32_t shares() const { return plan_ ? plan_->shard.of : 0; }
  /// Shares of which no file was accepted.
  [[nodiscard]] std::vector<std::uint32_t> missing() const;
  /// Recordings of all shares.
  [[nodiscard]] std::uint64_t planned() const { return plan_ ? plan_->planned : 0; }
  [[nodiscard]] std::size_t rows() const { return rows_.size(); }

  /// Calls `take` with every row, in the order of the list that was divided. @throws Error (damaged) where a file has
  /// changed since it was checked.
  void forEach(const std::function<void(const ValuesRow& row)>& take) const;

 private:
  struct Location {
    std::uint64_t position = 0;
    std::size_t file = 0;
    std::uint64_t offset = 0;
    std::uint32_t bytes = 0;  ///< of the line, its end included
  };
  struct Accepted {
    std::filesystem::path path;
    ValuesHeader header;
  };
  void accept(const std::filesystem::path& path, SharedWork work,
              const std::function<void(const ValuesRow& row)>& refuse);
  void checkPlan(const ValuesHeader& header, SharedWork work, const std::filesystem::path& path) const;

  std::vector<Error> refused_;
  std::vector<Accepted> files_;
  std::optional<ValuesHeader> plan_;  ///< of the first accepted file
  std::vector<Location> rows_;
};

}  // namespace calot::analytics
