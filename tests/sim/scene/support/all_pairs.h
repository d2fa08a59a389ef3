// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "sim/contact/broad_phase.h"

namespace calot::test {

/// The broad phase that knows nothing: every leaf may touch every query.
class AllPairs final : public BroadPhase {
 public:
  void update(std::span<const Box> leaves) override { leaves_ = leaves.size(); }
  void pairs(std::span<const Box> queries, std::vector<Pair>& out) const override {
    out.clear();
    for (std::uint32_t q = 0; q < queries.size(); ++q) {
      for (std::uint32_t l = 0; l < leaves_; ++l) out.push_back({q, l});
    }
  }
  static std::unique_ptr<BroadPhase> make() { return std::make_unique<AllPairs>(); }

 private:
  std::size_t leaves_ = 0;
};

}  // namespace calot::test
