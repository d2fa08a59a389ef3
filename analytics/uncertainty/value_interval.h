// SPDX-License-Identifier: GPL-3.0-or-later
// How far a figure may be from what an exact simulation with the right constants would give.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "analytics/checkpoints/checkpoint.h"

namespace calot::analytics {

/// Rises with every change of how an interval is made.
inline constexpr std::uint32_t intervalMethod = 1;

/// Half-width of an interval for what the assumed constants do, in standard deviations: about 95 % where many small
/// effects add up.
inline constexpr double coverageFactor = 2.0;

/// Interval of one value, in its SI unit. @invariant lower <= value <= upper, or there is no interval and a reason.
struct ValueInterval {
  std::string name, subject;     ///< of the checkpoint value
  std::uint32_t version = 1;     ///< of its definition
  double value = 0.0;            ///< to the bit: the interval is of this value and of no other
  double stepEffect = 0.0;       ///< what the value would change by in steps of length zero, extrapolated
  double meshEffect = 0.0;       ///< and with elements of size zero
  double constantsSpread = 0.0;  ///< its standard deviation over the assumed constants
  std::optional<double> lower, upper;
  std::string reason;        ///< why there is no interval; or empty
  std::vector<double> runs;  ///< the value in each run of the design, designRuns of them; or empty, as the interval

  /// value + stepEffect + meshEffect.
  [[nodiscard]] double limit() const { return value + stepEffect + meshEffect; }
  /// The value in every world that was tried or extrapolated, the same worlds in the same order for every attempt: as
  /// it is, in steps of length zero, with elements of size zero, with both, and in each run of the design. Errors of a
  /// simulation are common to all attempts: groups are to be compared within a world. Empty without an interval.
  [[nodiscard]] std::vector<double> worlds() const;
  /// Could the exact value lie on the other side of the mark, or on it?
  [[nodiscard]] bool contains(double mark) const { return lower && mark >= *lower && mark <= *upper; }
  bool operator==(const ValueInterval&) const = default;
};

/// The interval that is of this value, or null.
const ValueInterval* findInterval(const std::vector<ValueInterval>& intervals, const CheckpointValue& of);

/// An attempt's values in other divisions and with other constants.
struct VariedValues {
  std::vector<CheckpointValue> smallerStep;
  double stepRatio = 2.0;  ///< of the step to the smaller one, > 1
  std::vector<CheckpointValue> finerMesh;
  double meshRatio = 1.26;                           ///< of the elements' size to the finer ones', > 1
  std::vector<std::vector<CheckpointValue>> design;  ///< designRuns of them, in order
};

/// An interval of every value that is there, in its order.
///
/// With errors of first order in the step and in the elements' size, the value in steps shorter by r lies
/// (v_r - v) r / (r - 1) from the value in steps of length zero (Richardson); likewise for the mesh. With these effects
/// D_h and D_m and the spread s, the interval reaches from v to v + D_h + D_m and beyond both by sqrt(D_h^2 + D_m^2 +
/// (2 s)^2): an extrapolated difference is taken to be uncertain by itself, in size and sign, since order one is
/// assumed and not shown. s^2 is the sum over the design's factors of E^2 / 3, E half the difference between the mean
/// with the factor raised and lowered: the variance of a constant that is anywhere within the change alike. It stays
/// above zero where no value is below.
std::vector<ValueInterval> intervalsOf(const std::vector<CheckpointValue>& values, const VariedValues& varied);

}  // namespace calot::analytics
