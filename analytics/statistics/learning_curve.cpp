// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/learning_curve.h"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <set>
#include <vector>

#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/distributions.h"
#include "analytics/statistics/regression.h"

namespace calot::analytics {
namespace {

using Columns = std::vector<std::vector<double>>;

/// The curve's variable: basis exp(-c u), with u = x or ln x, and the least of u taken off so that nothing overflows.
struct Abscissa {
  std::vector<double> u;                           ///< less `first`
  double first = 0.0, reach = 0.0, nearest = 0.0;  ///< least u; largest less least; second least less least
};

Abscissa abscissa(CurveShape shape, std::span<const double> x) {
  Abscissa a;
  for (const double v : x) a.u.push_back(shape == CurveShape::exponential ? v : std::log(v));
  const std::set<double> distinct(a.u.begin(), a.u.end());
  a.first = *distinct.begin();
  a.nearest = *std::next(distinct.begin()) - a.first;
  a.reach = *distinct.rbegin() - a.first;
  for (double& u : a.u) u -= a.first;
  return a;
}

/// Columns of a and b for y = a - b exp(-c u).
Columns basis(const Abscissa& a, double c) {
  Columns columns(2, std::vector<double>(a.u.size(), 1.0));
  for (std::size_t i = 0; i < a.u.size(); ++i) columns[1][i] = -std::exp(-c * a.u[i]);
  return columns;
}

struct Minimum {
  double c = 1.0;
  LeastSquares linear;
};

Expected<Minimum> minimise(const Abscissa& a, std::span<const double> y) {
  using Result = Expected<Minimum>;
  // From a curve that is straight to 1 % over all x to one that is within e^-20 of its end at the second x.
  constexpr int cells = 200;
  const double low = std::log(0.01 / a.reach), high = std::log(20.0 / a.nearest);
  const auto sumOfSquares = [&](double logC) {
    const Expected<LeastSquares> fit = leastSquares(basis(a, std::exp(logC)), y);
    return fit ? fit->residualSumOfSquares : HUGE_VAL;
  };
  const auto place = [&](int i) { return low + (high - low) * i / cells; };
  int best = 0;
  double least = HUGE_VAL;
  for (int i = 0; i <= cells; ++i) {
    const double s = sumOfSquares(place(i));
    if (s < least) {
      least = s;
      best = i;
    }
  }
  if (best == 0) return Result::none("does not converge: no plateau in sight");
  if (best == cells) return Result::none("does not converge: all change is over after the first attempt");
  const double logC = boost::math::tools::brent_find_minima(sumOfSquares, place(best - 1), place(best + 1), 50).first;
  const double c = std::exp(logC);
  const Expected<LeastSquares> linear = leastSquares(basis(a, c), y);
  if (!linear) return Result::none("does not converge: " + linear.reason());
  return Minimum{c, *linear};
}

}  // namespace

double LearningCurve::at(double x) const {
  return plateau - gap * (shape == CurveShape::exponential ? std::exp(-rate * x) : std::pow(x, -rate));
}

Expected<LearningCurve> fitLearningCurve(CurveShape shape, std::span<const double> x, std::span<const double> y) {
  using Result = Expected<LearningCurve>;
  if (x.size() != y.size()) return Result::none("attempts and values have different lengths");
  if (!allFinite(x) || !allFinite(y)) return Result::none("a value is not finite");
  if (!std::all_of(x.begin(), x.end(), [](double v) { return v > 0.0; }))
    return Result::none("an attempt's number is not positive");
  const std::size_t parameters = shape == CurveShape::inverse ? 2 : 3;
  if (std::set<double>(x.begin(), x.end()).size() < parameters || y.size() <= parameters)
    return Result::none("too few attempts for the curve");
  if (std::all_of(y.begin(), y.end(), [&](double v) { return v == y.front(); }))
    return Result::none("all values are equal");
  LearningCurve curve;
  curve.shape = shape;
  if (shape == CurveShape::inverse) {
    Columns columns(2, std::vector<double>(x.size(), 1.0));
    for (std::size_t i = 0; i < x.size(); ++i) columns[1][i] = -1.0 / x[i];
    const Expected<LeastSquares> fit = leastSquares(columns, y);
    if (!fit) return Result::none(fit.reason());
    const std::vector<double> errors = fit->standardErrors();
    curve.plateau = fit->coefficients[0];
    curve.gap = fit->coefficients[1];
    curve.plateauError = errors[0];
    curve.gapError = errors[1];
    curve.residualSumOfSquares = fit->residualSumOfSquares;
    curve.sigma = fit->sigma;
    curve.covariance = fit->sigma * fit->sigma * fit->unscaled[1];
    curve.freedom = y.size() - parameters;
    return curve;
  }
  const Abscissa a = abscissa(shape, x);
  const Expected<Minimum> minimum = minimise(a, y);
  if (!minimum) return Result::none(minimum.reason());
  double c = minimum->c;
  LeastSquares linear = minimum->linear;
  // In the parameters of the whole curve, whose gap is b = b' exp(c first). Gauss-Newton in all three at once: what
  // Brent's method leaves in c, half of the digits, is gone after two steps.
  Expected<LeastSquares> step = Expected<LeastSquares>::none("");
  for (int i = 0; i < 4; ++i) {
    Columns jacobian(3, std::vector<double>(y.size(), 1.0));
    const double b = linear.coefficients[1] * std::exp(c * a.first);
    for (std::size_t k = 0; k < y.size(); ++k) {
      const double u = a.u[k] + a.first;
      jacobian[1][k] = -std::exp(-c * u);
      jacobian[2][k] = b * u * std::exp(-c * u);
    }
    step = leastSquares(jacobian, linear.residuals);
    if (!step) return Result::none("does not converge: the curve's parameters can't be told apart");
    const double next = c + step->coefficients[2];
    if (i == 3 || !(next > 0.0)) break;
    const Expected<LeastSquares> moved = leastSquares(basis(a, next), y);
    if (!moved || !(moved->residualSumOfSquares <= linear.residualSumOfSquares * (1.0 + 1e-12))) break;
    c = next;
    linear = *moved;
  }
  curve.plateau = linear.coefficients[0];
  curve.gap = linear.coefficients[1] * std::exp(c * a.first);
  curve.rate = c;
  curve.residualSumOfSquares = linear.residualSumOfSquares;
  curve.sigma = std::sqrt(linear.residualSumOfSquares / static_cast<double>(y.size() - parameters));
  const auto error = [&](std::size_t j) { return curve.sigma * std::sqrt(step->unscaled[j * 3 + j]); };
  curve.plateauError = error(0);
  curve.gapError = error(1);
  curve.rateError = error(2);
  return curve;
}

Expected<Interval> bandOf(const LearningCurve& curve, double x, double level) {
  if (curve.shape != CurveShape::inverse || curve.freedom == 0)
    return Expected<Interval>::none("the band is of the curve a - b / x alone");
  const double variance =
      curve.plateauError * curve.plateauError - 2.0 * curve.covariance / x + curve.gapError * curve.gapError / (x * x);
  const double half =
      studentQuantile(0.5 + 0.5 * level, static_cast<double>(curve.freedom)) * std::sqrt(std::max(0.0, variance));
  return Interval{curve.at(x) - half, curve.at(x) + half, level, "Student's t of a linear fit, pointwise"};
}

}  // namespace calot::analytics
