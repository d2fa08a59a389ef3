// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "recorder/base/counted.h"
#include "recorder/base/errors.h"
#include "recorder/sources/tracked_motion.h"

namespace calot::recorder {
namespace {

constexpr std::size_t fewestSamples = 20;              ///< below them there is no rule to deviate from
constexpr double fastestHand = 5.0;                    ///< m/s
constexpr double strongestHand = 50.0;                 ///< m/s^2
constexpr double strongestStart = 10.0;                ///< m/s^2, from a pose that was held
constexpr double leastJump = 2e-3, leastStart = 1e-3;  ///< m
constexpr double manyDifferences = 10.0;               ///< medians
constexpr double shortPiece = 0.5;                     ///< s
constexpr double heldPose = 0.1, heldIntervals = 3.0;  ///< s; the tracker's own

double medianOf(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// A pose, and the rows that have it.
struct Hold {
  std::size_t first = 0, last = 0;
};

/// One hand's distinct poses in a row, and the steps between them.
class HandSamples {
 public:
  HandSamples(const std::vector<double>& time, TrackedHand& hand) : time_(time), hand_(hand) {
    holds_.reserve(hand.position.size());
    for (std::size_t i = 0; i < hand.position.size(); ++i) {
      if (hand.isMissing(i)) continue;
      const bool same = !holds_.empty() && holds_.back().last + 1 == i && repeats(i);
      if (same)
        holds_.back().last = i;
      else
        holds_.push_back({i, i});
    }
    std::vector<double> intervals, differences;
    intervals.reserve(holds_.size());
    differences.reserve(holds_.size());
    for (std::size_t k = 1; k < holds_.size(); ++k) intervals.push_back(at(k) - at(k - 1));
    interval_ = medianOf(std::move(intervals));
    for (std::size_t k = 2; k < holds_.size(); ++k) {
      if (at(k) - at(k - 2) < 4.0 * interval_)
        differences.push_back((position(k) - 2.0 * position(k - 1) + position(k - 2)).norm());
    }
    difference_ = manyDifferences * medianOf(std::move(differences));
    steps_.resize(holds_.size());
    for (std::size_t k = 1; k < holds_.size(); ++k) steps_[k] = (position(k) - position(k - 1)).norm();
  }

  /// Marks what was held while the tracker saw nothing. @return rows
  std::size_t markHeld(double& begin) {
    std::size_t rows = 0;
    for (std::size_t k = 0; k + 1 < holds_.size(); ++k) {
      const Hold hold = holds_[k];
      const double held = time_[hold.last] - time_[hold.first];
      const double resumed = time_[holds_[k + 1].first] - time_[hold.last];
      if (!(held > heldPose && held > heldIntervals * interval_) || resumed > heldPose) continue;
      const double least = std::max({leastStart, strongestStart * interval_ * interval_, difference_});
      if (!(steps_[k + 1] > least)) continue;
      if (rows == 0) begin = time_[hold.first];
      rows += mark({hold.first + 1, hold.last});
      hand_.jumps.erase(std::remove(hand_.jumps.begin(), hand_.jumps.end(), holds_[k + 1].first), hand_.jumps.end());
    }
    return rows;
  }

  /// Marks what lies beyond jumps: short pieces to which no hand goes from the nearest kept one.
  /// @param[out] begin of the first @return rows
  std::size_t markBeyondJumps(double& begin) {
    std::vector<Hold> pieces{{0, 0}};  // of poses
    for (std::size_t k = 1; k < holds_.size(); ++k) {
      if (isJump(k)) pieces.push_back({k, k});
      pieces.back().last = k;
    }
    if (pieces.size() == 1) return 0;
    const auto longest =
        std::max_element(pieces.begin(), pieces.end(), [&](Hold a, Hold b) { return lengthOf(a) < lengthOf(b); });
    const auto anchor = static_cast<std::size_t>(longest - pieces.begin());
    std::vector<bool> kept(pieces.size(), false);
    kept[anchor] = true;
    for (std::size_t p = anchor + 1, near = anchor; p < pieces.size(); ++p) {
      const bool reached = p > near + 1 && reaches(pieces[near].last, pieces[p].first);
      kept[p] = reached || isLong(pieces[p]);
      if (kept[p] && !reached) hand_.jumps.push_back(holds_[pieces[p].first].first);
      if (kept[p]) near = p;
    }
    for (std::size_t p = anchor, near = anchor; p-- > 0;) {
      const bool reached = near > p + 1 && reaches(pieces[p].last, pieces[near].first);
      kept[p] = reached || isLong(pieces[p]);
      if (kept[p] && !reached) hand_.jumps.push_back(holds_[pieces[near].first].first);
      if (kept[p]) near = p;
    }
    std::sort(hand_.jumps.begin(), hand_.jumps.end());
    std::size_t rows = 0;
    for (std::size_t p = 0; p < pieces.size(); ++p) {
      if (kept[p]) continue;
      if (rows == 0) begin = at(pieces[p].first);
      for (std::size_t k = pieces[p].first; k <= pieces[p].last; ++k) rows += mark(holds_[k]);
    }
    return rows;
  }

  [[nodiscard]] std::size_t size() const { return holds_.size(); }

 private:
  [[nodiscard]] bool repeats(std::size_t i) const {
    return hand_.position[i] == hand_.position[i - 1] &&
           hand_.orientationAt(i).coeffs() == hand_.orientationAt(i - 1).coeffs();
  }
  [[nodiscard]] double at(std::size_t k) const { return time_[holds_[k].first]; }
  [[nodiscard]] const Vec3& position(std::size_t k) const { return hand_.position[holds_[k].first]; }

  /// Time in which it was made, at least the tracker's interval (s).
  [[nodiscard]] double seconds(std::size_t k) const {
    return std::max(time_[holds_[k].first] - time_[holds_[k - 1].last], interval_);
  }
  [[nodiscard]] double leastJumpIn(double seconds) const {
    return std::max({leastJump, strongestHand * seconds * seconds, difference_});
  }
  [[nodiscard]] bool isJump(std::size_t k) const {
    double beside = 1e300;  // m, of the steps before and after, in the same time
    if (k > 1) beside = std::min(beside, steps_[k - 1] * seconds(k) / seconds(k - 1));
    if (k + 1 < holds_.size()) beside = std::min(beside, steps_[k + 1] * seconds(k) / seconds(k + 1));
    return steps_[k] > fastestHand * seconds(k) || steps_[k] - beside > leastJumpIn(seconds(k));
  }
  [[nodiscard]] double lengthOf(Hold piece) const {
    return time_[holds_[piece.last].last] - time_[holds_[piece.first].first];
  }
  [[nodiscard]] bool isLong(Hold piece) const {
    const bool atOrigin = piece.first == piece.last && position(piece.first).isZero(0.0);
    return lengthOf(piece) >= shortPiece && !atOrigin;
  }
  /// Could a hand go from pose a to pose b?
  [[nodiscard]] bool reaches(std::size_t a, std::size_t b) const {
    const double seconds = at(b) - time_[holds_[a].last];
    return (position(b) - position(a)).norm() <= leastJumpIn(seconds) + 1.0 * seconds;
  }
  std::size_t mark(Hold rows) {
    hand_.missing.resize(hand_.position.size());
    for (std::size_t i = rows.first; i <= rows.last; ++i) hand_.missing[i] = true;
    return rows.last + 1 - rows.first;
  }

  const std::vector<double>& time_;
  TrackedHand& hand_;
  std::vector<Hold> holds_;
  std::vector<double> steps_;  ///< length of the step to each pose (m)
  double interval_ = 0.0;      ///< between poses, the median (s)
  double difference_ = 0.0;    ///< ten medians of second differences (m)
};

/// 95th percentile of the speeds over at least 0.1 s (m/s).
double fastSpeedOf(const std::vector<double>& time, const TrackedHand& hand) {
  std::vector<double> speeds;
  std::size_t from = 0;
  for (std::size_t i = 0; i < hand.position.size(); ++i) {
    if (hand.isMissing(i)) continue;
    if (hand.isMissing(from) || time[i] - time[from] > 1.0) from = i;
    if (time[i] - time[from] < 0.0999) continue;
    speeds.push_back((hand.position[i] - hand.position[from]).norm() / (time[i] - time[from]));
    from = i;
  }
  if (speeds.empty()) return 0.0;
  const auto nth = speeds.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(speeds.size() - 1));
  std::nth_element(speeds.begin(), nth, speeds.end());
  return *nth;
}

}  // namespace

void markInvalidSamples(TrackedMotion& motion) {
  for (std::size_t h = 0; h < motion.hand.size(); ++h) {
    TrackedHand& hand = motion.hand[h];
    if (!hand.present) continue;
    HandSamples samples(motion.time, hand);
    if (samples.size() < fewestSamples) continue;
    const auto note = [&](std::size_t rows, double begin, const char* why) {
      if (rows == 0) return;
      hand.leftOut += rows;
      motion.notes.push_back(
          fmt::format("{} hand: {} left out, from {:.3f} s: {}", handNames[h], counted(rows, "row"), begin, why));
    };
    double begin = 0.0;
    const std::size_t beyond = samples.markBeyondJumps(begin);
    note(beyond, begin, "positions to which no hand jumps");
    const std::size_t held = (beyond > 0 ? HandSamples(motion.time, hand) : samples).markHeld(begin);
    note(held, begin, "the same pose held, then left with a jump, as trackers do that have lost it");
    if (!hand.jumps.empty())
      motion.notes.push_back(
          fmt::format("{} hand: {} that no hand makes, the first at {:.3f} s; the motion is "
                      "divided there",
                      handNames[h], counted(hand.jumps.size(), "jump"), motion.time[hand.jumps.front()]));
  }
}

void checkUnits(const TrackedMotion& motion) {
  const auto fail = [&](const std::string& fault) {
    throw Error(ErrorKind::damaged, Where{motion.file},
                fault + "; \"verified\": true in the map says that they are right");
  };
  if (motion.time.size() < fewestSamples) return;
  std::vector<double> intervals;
  intervals.reserve(motion.time.size());
  for (std::size_t i = 1; i < motion.time.size(); ++i) intervals.push_back(motion.time[i] - motion.time[i - 1]);
  const double interval = medianOf(std::move(intervals));
  if (interval > 1.0 || interval < 5e-5)
    fail(fmt::format("rows are {:.3g} s apart: the map's unit of time, or its rate, may be wrong", interval));
  constexpr double shortest = 5.0, slowest = 5e-3, fastest = 2.0;
  if (motion.time.back() < shortest) return;
  double fast = 0.0;
  for (const TrackedHand& hand : motion.hand) {
    if (hand.present) fast = std::max(fast, fastSpeedOf(motion.time, hand));
  }
  if (fast < slowest || fast > fastest)
    fail(
        fmt::format("the faster hand is {} {:.3g} mm/s for {} % of the time: the map's units of length and time may be "
                    "wrong (m, cm, mm, inch; s, ms)",
                    fast < slowest ? "slower than" : "faster than", 1000.0 * fast, fast < slowest ? 95 : 5));
}

}  // namespace calot::recorder
