// SPDX-License-Identifier: GPL-3.0-or-later
// A result or the reason why there is none, and confidence intervals.
#pragma once

#include <cassert>
#include <optional>
#include <string>
#include <utility>

namespace calot::analytics {

/// Reason why there is no result, one line.
struct NoResult {
  std::string reason;
};

/// A result, or the reason why there is none. Degenerate input (an empty group, all values tied, n = 1) gives a
/// printable reason, not an error and never a NaN.
template <class T>
class Expected {
 public:
  Expected(T value) : value_(std::move(value)) {}               // NOLINT: implicit on purpose, a result converts
  Expected(NoResult none) : reason_(std::move(none.reason)) {}  // NOLINT: so does a reason

  explicit operator bool() const { return value_.has_value(); }
  /// @pre there is a result.
  const T& operator*() const {
    assert(value_.has_value());
    return *value_;
  }
  const T* operator->() const {
    assert(value_.has_value());
    return &*value_;
  }
  [[nodiscard]] const std::optional<T>& optional() const { return value_; }
  /// One line; empty exactly when there is a result.
  [[nodiscard]] const std::string& reason() const { return reason_; }

 private:
  std::optional<T> value_;
  std::string reason_;
};

/// A two-sided confidence interval and how it was made: the method is printed beside the numbers.
struct Interval {
  double lower = 0.0, upper = 0.0;
  double level = 0.95;  ///< asked for
  std::string method;
};

}  // namespace calot::analytics
