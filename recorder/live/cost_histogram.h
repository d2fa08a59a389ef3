// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>

namespace calot::recorder {

/// Mean and quantiles of many short durations, in fixed memory: bins of 250 ns up to 1 ms, and one for all above.
class CostHistogram {
 public:
  void add(std::chrono::nanoseconds cost) {
    const auto ns = static_cast<std::uint64_t>(std::max<std::chrono::nanoseconds::rep>(cost.count(), 0));
    ++bins_[std::min<std::size_t>(ns / width, bins_.size() - 1)];
    ++count_;
    sum_ += ns;
    largest_ = std::max(largest_, ns);
  }
  [[nodiscard]] std::uint64_t count() const { return count_; }
  /// s; 0 of none
  [[nodiscard]] double mean() const {
    return count_ == 0 ? 0.0 : 1e-9 * static_cast<double>(sum_) / static_cast<double>(count_);
  }
  [[nodiscard]] double largest() const { return 1e-9 * static_cast<double>(largest_); }  ///< s
  /// Upper bound of quantile `part` (s): the upper edge of its bin, or the maximum if that is less. @pre part in [0, 1]
  [[nodiscard]] double quantile(double part) const {
    const double wanted = part * static_cast<double>(count_);
    std::uint64_t seen = 0;
    for (std::size_t i = 0; i + 1 < bins_.size(); ++i) {
      seen += bins_[i];
      if (static_cast<double>(seen) >= wanted) return std::min(1e-9 * static_cast<double>((i + 1) * width), largest());
    }
    return largest();
  }

 private:
  static constexpr std::uint64_t width = 250;
  std::array<std::uint64_t, 4001> bins_{};
  std::uint64_t count_ = 0, sum_ = 0, largest_ = 0;
};

}  // namespace calot::recorder
