// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/checkpoints/time_spans.h"

#include <algorithm>
#include <utility>

#include "sim/math/linear.h"

namespace calot::analytics {

TimeSpans normalized(TimeSpans spans) {
  std::sort(spans.begin(), spans.end(), [](const TimeSpan& a, const TimeSpan& b) { return a.begin < b.begin; });
  TimeSpans joined;
  for (const TimeSpan& span : spans) {
    if (!(span.begin < span.end)) continue;
    if (!joined.empty() && span.begin <= joined.back().end) {
      joined.back().end = std::max(joined.back().end, span.end);
    } else {
      joined.push_back(span);
    }
  }
  return joined;
}

TimeSpans intersection(const TimeSpans& a, const TimeSpans& b) {
  TimeSpans common;
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    const TimeSpan both{std::max(a[i].begin, b[j].begin), std::min(a[i].end, b[j].end)};
    if (both.begin < both.end) common.push_back(both);
    if (a[i].end < b[j].end) {
      ++i;
    } else {
      ++j;
    }
  }
  return common;
}

TimeSpans unionOf(const TimeSpans& a, const TimeSpans& b) {
  TimeSpans all = a;
  all.insert(all.end(), b.begin(), b.end());
  return normalized(std::move(all));
}

double lengthOf(const TimeSpans& spans) {
  double seconds = 0.0;
  for (const TimeSpan& span : spans) seconds += span.end - span.begin;
  return seconds;
}

std::optional<double> MotionCoverage::share() const {
  const double whole = lengthOf(mounted);
  if (!(whole > 0.0)) return std::nullopt;
  return notNegative(1.0 - lengthOf(lost) / whole);
}

MotionCoverage within(const MotionCoverage& coverage, const TimeSpans& window) {
  return {intersection(coverage.mounted, window), intersection(coverage.lost, window)};
}

MotionCoverage ofBoth(const MotionCoverage& left, const MotionCoverage& right) {
  const TimeSpans mounted = intersection(left.mounted, right.mounted);
  return {mounted, intersection(unionOf(left.lost, right.lost), mounted)};
}

}  // namespace calot::analytics
