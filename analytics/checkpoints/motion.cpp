// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/checkpoints/motion.h"

#include <fmt/format.h>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <utility>

#include "analytics/checkpoints/hand_motion.h"
#include "recorder/sources/pointing.h"
#include "sim/math/elementary.h"
#include "sim/math/linear.h"
#include "sim/math/no_fused_pairs.h"  // first

namespace calot::analytics {
namespace {

/// Share of a grid interval within which a sample counts as on the point: times in seconds are rounded.
constexpr double onThePoint = 1e-6;

Quat unit(const Quat& q) {
  const double length = std::sqrt(q.w() * q.w() + q.x() * q.x() + q.y() * q.y() + q.z() * q.z());
  if (!(length > 0.0)) return Quat::Identity();  // a recording of a stranger
  return {q.w() / length, q.x() / length, q.y() / length, q.z() / length};
}

}  // namespace

void GridRun::append(const Vec3& p, const Quat& q) {
  double cosine = 1.0;
  if (!orientation.empty()) {
    const Quat& before = orientation.back();
    cosine = before.w() * q.w() + before.x() * q.x() + before.y() * q.y() + before.z() * q.z();
  }
  position.push_back(p);
  orientation.push_back(cosine < 0.0 ? Quat(-q.w(), -q.x(), -q.y(), -q.z()) : q);
}

double gridTime(std::int64_t k, double unitsPerSecond) { return static_cast<double>(k) * unitsPerSecond / motionRate; }

void SampleGrid::put(const Vec3& position, const Quat& orientation) {
  runs_.back().append(position, orientation);
  ++next_;
}

void SampleGrid::begin(double time, const Vec3& position, const Quat& orientation, bool continues) {
  const double slack = onThePoint * unitsPerSecond_ / motionRate;
  next_ = static_cast<std::int64_t>(std::floor(time * motionRate / unitsPerSecond_));
  while (gridTime(next_, unitsPerSecond_) < time - slack) ++next_;
  const TimedPose sample{time, position, unit(orientation)};
  runs_.push_back({next_, {}, {}, sample, sample, continues});
  noise_.interrupt();
  noise_.add(time / unitsPerSecond_, position);
  if (gridTime(next_, unitsPerSecond_) <= time + slack) put(position, sample.orientation);
}

void SampleGrid::extend(double time, const Vec3& position, const Quat& orientation) {
  assert(!runs_.empty() && time > runs_.back().end.time);
  const TimedPose last = runs_.back().end;
  const Quat to = unit(orientation);
  const double slack = onThePoint * unitsPerSecond_ / motionRate;
  for (double at = gridTime(next_, unitsPerSecond_); at <= time + slack; at = gridTime(next_, unitsPerSecond_)) {
    if (at >= time - slack) {
      put(position, to);
    } else {
      const double s = (at - last.time) / (time - last.time);
      put(last.position + s * (position - last.position), recorder::interpolated(last.orientation, to, s));
    }
  }
  runs_.back().end = {time, position, to};
  noise_.add(time / unitsPerSecond_, position);
}

namespace {

constexpr double binsPerSecond = 1e5;
constexpr double evenIntervals = 1.5;  ///< medians
constexpr double evenShare = 0.1;      ///< of the time

std::size_t binOf(double seconds) { return static_cast<std::size_t>(std::floor(seconds * binsPerSecond + 0.5)); }

}  // namespace

void SampleRate::add(double seconds) {
  assert(seconds > 0.0);
  if (seconds > longestInterval) return;
  const std::size_t at = binOf(seconds);
  if (at >= bins_.size()) bins_.resize(at + 1);
  for (Bin* bin : {&bins_[at], &all_}) {
    ++bin->count;
    bin->seconds += seconds;
  }
}

SampleRate::Bin SampleRate::upTo(double longest) const {
  Bin sum;
  const std::size_t end = std::min(bins_.size(), binOf(std::min(longest, longestInterval)) + 1);
  for (std::size_t i = 0; i < end; ++i) {
    sum.count += bins_[i].count;
    sum.seconds += bins_[i].seconds;
  }
  return sum;
}

double SampleRate::interval() const {
  if (all_.count == 0) return 0.0;
  const auto meanOf = [](const Bin& bin) { return bin.seconds / static_cast<double>(bin.count); };
  std::size_t i = 0;
  for (std::uint64_t count = bins_[0].count; 2 * count < all_.count; count += bins_[i].count) ++i;
  const double median = meanOf(bins_[i]);
  if (upTo(evenIntervals * median).seconds >= evenShare * all_.seconds) return median;
  double seconds = 0.0;
  for (i = 0; i + 1 < bins_.size(); ++i) {
    seconds += bins_[i].seconds;
    if (2.0 * seconds >= all_.seconds) break;
  }
  return meanOf(bins_[i]);  // not empty: with it the sum passed one half, or it is the longest
}

double SampleRate::hertz(double longest) const {
  const Bin sum = upTo(longest);
  return sum.count == 0 ? 0.0 : static_cast<double>(sum.count) / sum.seconds;
}

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

MotionCoverage coverageWithin(const MotionCoverage& coverage, const TimeSpans& window) {
  return {intersection(coverage.mounted, window), intersection(coverage.lost, window)};
}

MotionCoverage ofBoth(const MotionCoverage& left, const MotionCoverage& right) {
  const TimeSpans mounted = intersection(left.mounted, right.mounted);
  return {mounted, intersection(unionOf(left.lost, right.lost), mounted)};
}

namespace {

std::vector<double> speeds(const std::vector<Vec3>& p) {
  const std::size_t n = p.size();
  std::vector<double> speed(n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t a = i == 0 ? 0 : i - 1, b = i + 1 == n ? i : i + 1;
    speed[i] = lengthOf(p[b] - p[a]) * (motionRate / static_cast<double>(b - a));
  }
  return speed;
}

/// Filters each component of the vectors by itself. @param componentsOf gives those of one
template <class T, class Components>
std::vector<T> smoothed(const ZeroPhaseFilter& filter, const std::vector<T>& raw, int count, Components componentsOf) {
  std::vector<T> smooth(raw.size());
  std::vector<double> part(raw.size());
  for (int c = 0; c < count; ++c) {
    for (std::size_t i = 0; i < part.size(); ++i) part[i] = componentsOf(raw[i])[c];
    const std::vector<double> y = filter.apply(part);
    for (std::size_t i = 0; i < part.size(); ++i) componentsOf(smooth[i])[c] = y[i];
  }
  return smooth;
}

std::vector<Quat> smoothOrientations(const ZeroPhaseFilter& filter, const std::vector<Quat>& raw) {
  std::vector<Quat> smooth = smoothed(
      filter, raw, 4, [](auto& q) -> auto& { return q.coeffs(); });
  for (std::size_t i = 0; i < smooth.size(); ++i) {
    const auto& q = smooth[i].coeffs();
    const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    // A turn of half a revolution within a filter's width can cancel out: the unfiltered one is a rotation.
    smooth[i] = length > 1e-3 ? Quat(q / length) : raw[i];
  }
  return smooth;
}

MotionSegment filteredSegment(GridRun&& run, const ZeroPhaseFilter& filter, bool oriented) {
  MotionSegment segment;
  segment.first = run.first;
  segment.continues = run.continues;
  segment.raw = std::move(run.position);
  segment.filtered = smoothed(
      filter, segment.raw, 3, [](auto& p) -> auto& { return p; });
  if (oriented) segment.orientation = smoothOrientations(filter, run.orientation);
  segment.speed = speeds(segment.filtered);
  return segment;
}

}  // namespace

std::string motionFilterText(double cutoff) {
  return fmt::format(
      "the tracker's own samples, linear to 100 Hz; gaps of up to 1 s without samples bridged by cubics, longer ones "
      "split; Butterworth order 2 at {:g} Hz forward and backward, odd extension by 50, steady initial state, cut-off "
      "not corrected by 0.802; central differences",
      cutoff);
}

std::uint64_t Motion::points() const {
  std::uint64_t count = 0;
  for (const MotionSegment& segment : segments) count += segment.filtered.size();
  return count;
}

std::vector<double> speedsOf(const std::vector<MotionSegment>& segments) {
  std::vector<double> speed;
  for (const MotionSegment& segment : segments) speed.insert(speed.end(), segment.speed.begin(), segment.speed.end());
  return speed;
}

Motion filteredMotion(MotionSamples samples, double cutoff) {
  Motion motion;
  motion.mounted = !samples.coverage.mounted.empty();
  motion.interval = samples.rate.interval();
  motion.rate = samples.rate.hertz(samples.longestRate);
  motion.noise = samples.grid.noise().deviation();
  motion.cutoff = cutoff;
  const double unitsPerSecond = samples.grid.unitsPerSecond();
  std::vector<GridRun> runs = bridged(std::move(samples.grid).takeRuns(), GapRule{motion.interval}, unitsPerSecond);
  const ZeroPhaseFilter filter(cutoff, motionRate);
  TimeSpans lost = std::move(samples.coverage.lost);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (runs[i].position.size() >= ZeroPhaseFilter::shortest) {
      motion.segments.push_back(filteredSegment(std::move(runs[i]), filter, samples.oriented));
    } else if (runs[i].continues || (i + 1 < runs.size() && runs[i + 1].continues)) {
      lost.push_back({runs[i].begin.time / unitsPerSecond, runs[i].end.time / unitsPerSecond});
    }
  }
  motion.coverage = {std::move(samples.coverage.mounted), {}};
  motion.coverage.lost = intersection(normalized(std::move(lost)), motion.coverage.mounted);
  motion.movementSpeed = movementSpeedOf(motion.segments);
  return motion;
}

namespace {

constexpr double slopeWindow = 0.1;  // s

/// Times between two runs (s).
double between(const GridRun& before, const GridRun& after, double unitsPerSecond) {
  return (after.begin.time - before.end.time) / unitsPerSecond;
}

/// Least-squares slope (m/s) of the `points` first or last positions of a run. @pre points >= 2
Vec3 slopeOf(const std::vector<Vec3>& position, bool atEnd, std::size_t points) {
  const std::size_t from = atEnd ? position.size() - points : 0;
  const double middle = 0.5 * static_cast<double>(points - 1);
  Vec3 sum = Vec3::Zero();
  double squares = 0.0;
  for (std::size_t i = 0; i < points; ++i) {
    const double t = static_cast<double>(i) - middle;
    sum += t * position[from + i];
    squares += t * t;
  }
  return sum * (motionRate / squares);
}

/// Velocities at both ends of a gap, times its length: tangents of the Hermite curve (m).
struct Tangents {
  Vec3 begin, end;
};

Tangents tangentsOf(const GridRun& before, const GridRun& after, double seconds, double interval) {
  const Vec3 chord = after.begin.position - before.end.position;
  const auto window = static_cast<std::size_t>(std::floor(std::max(slopeWindow, interval) * motionRate + 0.5)) + 1;
  const auto tangent = [&](const GridRun& run, bool atEnd) -> Vec3 {
    const std::size_t points = std::min(window, run.position.size());
    if (points < 2) return chord;
    return slopeOf(run.position, atEnd, points) * seconds;
  };
  return {tangent(before, true), tangent(after, false)};
}

Vec3 hermite(const Vec3& from, const Vec3& to, const Tangents& tangents, double s) {
  const double s2 = s * s, s3 = s2 * s;
  return (2.0 * s3 - 3.0 * s2 + 1.0) * from + (s3 - 2.0 * s2 + s) * tangents.begin + (3.0 * s2 - 2.0 * s3) * to +
         (s3 - s2) * tangents.end;
}

/// Appends the points between both runs, then those of `after`.
void join(GridRun& before, GridRun&& after, const GapRule& rule, double unitsPerSecond) {
  const double seconds = between(before, after, unitsPerSecond);
  const bool straight = rule.isStraight(seconds);
  const Tangents tangents = straight ? Tangents{} : tangentsOf(before, after, seconds, rule.interval);
  const TimedPose from = before.end, &to = after.begin;
  const auto end = after.first;
  for (auto k = before.first + static_cast<std::int64_t>(before.position.size()); k < end; ++k) {
    const double s = (gridTime(k, unitsPerSecond) - from.time) / (to.time - from.time);
    before.append(straight ? Vec3(from.position + s * (to.position - from.position))
                           : hermite(from.position, to.position, tangents, s),
                  recorder::interpolated(from.orientation, to.orientation, s));
  }
  for (std::size_t i = 0; i < after.position.size(); ++i) before.append(after.position[i], after.orientation[i]);
  before.end = after.end;
}

template <class Takes>
std::vector<GridRun> joined(std::vector<GridRun> runs, const GapRule& rule, double unitsPerSecond, Takes takes) {
  std::vector<GridRun> result;
  for (GridRun& run : runs) {
    if (run.continues && !result.empty() && takes(between(result.back(), run, unitsPerSecond))) {
      join(result.back(), std::move(run), rule, unitsPerSecond);
    } else {
      result.push_back(std::move(run));
    }
  }
  return result;
}

}  // namespace

std::vector<GridRun> bridged(std::vector<GridRun> runs, const GapRule& rule, double unitsPerSecond) {
  // Straight ones first: what they join gives the slopes of the curves.
  runs = joined(std::move(runs), rule, unitsPerSecond, [&](double seconds) { return rule.isStraight(seconds); });
  return joined(std::move(runs), rule, unitsPerSecond, [&](double seconds) { return rule.isBridged(seconds); });
}

ZeroPhaseFilter::ZeroPhaseFilter(double cutoff, double rate) {
  assert(cutoff > 0.0 && cutoff < rate / 2.0);
  const double angle = std::numbers::pi * cutoff / rate;
  const double k = sine(angle) / cosine(angle);
  const double root2 = std::sqrt(2.0);
  const double scale = 1.0 / (1.0 + root2 * k + k * k);
  b0_ = k * k * scale;
  b1_ = 2.0 * b0_;
  b2_ = b0_;
  a1_ = 2.0 * (k * k - 1.0) * scale;
  a2_ = (1.0 - root2 * k + k * k) * scale;
}

void ZeroPhaseFilter::pass(std::vector<double>& signal) const {
  // Transposed direct form II; the state in which a constant input passes unchanged, times the first value.
  double z1 = (1.0 - b0_) * signal.front();
  double z2 = (b2_ - a2_) * signal.front();
  for (double& value : signal) {
    const double x = value;
    const double y = b0_ * x + z1;
    z1 = b1_ * x - a1_ * y + z2;
    z2 = b2_ * x - a2_ * y;
    value = y;
  }
}

std::vector<double> ZeroPhaseFilter::apply(std::span<const double> signal) const {
  assert(signal.size() >= shortest);
  const std::size_t margin = std::min(edge, signal.size() - 1);
  std::vector<double> extended;
  extended.reserve(signal.size() + 2 * margin);
  for (std::size_t i = margin; i >= 1; --i) extended.push_back(2.0 * signal.front() - signal[i]);
  extended.insert(extended.end(), signal.begin(), signal.end());
  for (std::size_t i = 1; i <= margin; ++i) extended.push_back(2.0 * signal.back() - signal[signal.size() - 1 - i]);
  pass(extended);
  std::reverse(extended.begin(), extended.end());
  pass(extended);
  std::reverse(extended.begin(), extended.end());
  return {extended.begin() + static_cast<std::ptrdiff_t>(margin), extended.end() - static_cast<std::ptrdiff_t>(margin)};
}

}  // namespace calot::analytics
