// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace calot::analytics {

/// Second-order Butterworth low-pass, run forward and backward: no delay, fourth-order roll-off.
///
/// Design: bilinear transform, pre-warped so that one pass has -3 dB exactly at the cut-off; both passes together have
/// -6 dB there (their -3 dB lies at 0.802 of it). The cut-off is not raised by 1/0.802 to make up for that.
/// Edges: the signal is extended at both ends by up to `edge` values (all but one of them where it is shorter),
/// mirrored through its end point (2 x_0 - x_k). Half a second at 100 Hz: the start-up of a 6 Hz filter has died away
/// to 2e-6, where the customary nine values leave a tenth of it. Initial state: that of a constant input equal to the
/// first value of the extended signal, for each pass. These are the conventions of scipy.signal.filtfilt(*butter(2, fc,
/// fs=fs), x, padlen=min(50, len(x) - 1)).
///
/// Own arithmetic (+ - * / sqrt, and sine and cosine of sim/math), in source-fixed order.
class ZeroPhaseFilter {
 public:
  static constexpr std::size_t edge = 50;
  static constexpr std::size_t shortest = 10;  ///< values that a signal must have at least

  /// @param cutoff, rate in Hz. @pre 0 < cutoff < rate / 2.
  ZeroPhaseFilter(double cutoff, double rate);

  /// @pre signal.size() >= shortest. Returns as many values.
  [[nodiscard]] std::vector<double> apply(std::span<const double> signal) const;

 private:
  void pass(std::vector<double>& signal) const;
  double b0_ = 0.0, b1_ = 0.0, b2_ = 0.0, a1_ = 0.0, a2_ = 0.0;
};

}  // namespace calot::analytics
