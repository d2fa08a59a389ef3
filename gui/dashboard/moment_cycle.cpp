// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/moment_cycle.h"

#include <algorithm>

namespace calot::gui {

std::optional<double> MomentCycle::next(const analytics::FigureMoments& figure) {
  const std::vector<analytics::Moment>& moments = figure.moments;
  if (moments.empty()) return std::nullopt;
  const std::string name = figure.checkpoint + '\n' + figure.subject;
  if (name == figure_) {
    at_ = (at_ + 1) % moments.size();
  } else {
    const auto most = std::max_element(moments.begin(), moments.end(),
                                       [](const auto& a, const auto& b) { return a.share < b.share; });
    at_ = static_cast<std::size_t>(most - moments.begin());
    figure_ = name;
  }
  return std::max(0.0, moments[at_].begin - leadIn);
}

}  // namespace calot::gui
