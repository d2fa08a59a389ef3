// SPDX-License-Identifier: GPL-3.0-or-later
// Longest time without a break in which an instrument touches an organ: an example of a checkpoint. As one of Calot's
// it would stand in analytics/checkpoints/figures/contact_rows.cpp.
#include <algorithm>
#include <cstdint>
#include <vector>

#include "analytics/checkpoints/checkpoint.h"

namespace calot::analytics {
namespace {

struct LongestTouch {
  const AttemptContext& context;
  std::vector<std::uint64_t> now = std::vector<std::uint64_t>(context.structures.size());
  std::vector<std::uint64_t> longest = now;

  void add(const StepResult& result) {
    for (std::size_t o = 0; o < now.size(); ++o) {
      bool touched = false;
      for (const HandResult& hand : result.hand) touched = touched || (hand.contacts() >> o & 1U) != 0;
      now[o] = touched ? now[o] + 1 : 0;
      longest[o] = std::max(longest[o], now[o]);
    }
  }
  [[nodiscard]] Measured figure(const AttemptEnd& end, std::size_t o) const {
    return Measured::of(context.seconds(longest[o]), stretchNote(end));
  }
};

}  // namespace

std::vector<CheckpointEntry> longestTouchRows() {
  return {{.place = {CheckpointFamily::contact, 25},
           .definition = {.name = "longest-touch",
                          .title = "Longest touch of the organ",
                          .unit = "s",
                          .direction = Direction::lower,
                          .aggregation = Aggregation::organ,
                          .instruments = "union over instruments: any of them goes on with the touch",
                          .definition = "step length * most steps one after the other at whose end an instrument "
                                        "exerts a force on organ o"},
           .accumulate = accumulating<LongestTouch>()}};
}

}  // namespace calot::analytics
