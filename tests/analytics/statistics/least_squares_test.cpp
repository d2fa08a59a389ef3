// SPDX-License-Identifier: GPL-3.0-or-later
// Least squares, HC3 errors and the analysis of covariance on a baseline.
#include "analytics/statistics/regression.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "tests/analytics/statistics/support/published_data.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

using Values = std::vector<double>;

TEST(LeastSquares, longleysCertifiedValues) {
  // NIST StRD, Longley, certified (in R's units, thousands): the columns are dependent to five digits.
  std::vector<Values> columns{Values(16, 1.0)};
  columns.insert(columns.end(), data::longley.begin(), data::longley.end());
  const auto fit = leastSquares(columns, data::employed);
  ASSERT_TRUE(fit) << fit.reason();
  const Values b{-3482.25863459582,   0.0150618722713733,  -0.0358191792925910, -0.0202022980381683,
                 -0.0103322686717359, -0.0511041056535807, 1.82915146461355};
  const Values se{890.420383607373,    0.0849149257747669, 0.0334910077722432, 0.00488399681651699,
                  0.00214274163161675, 0.226073200069370,  0.455478499142212};
  const Values errors = fit->standardErrors();
  for (std::size_t j = 0; j < b.size(); ++j) {
    EXPECT_NEAR(fit->coefficients[j], b[j], 1e-9 * std::abs(b[j])) << j;
    EXPECT_NEAR(errors[j], se[j], 1e-9 * se[j]) << j;
  }
  EXPECT_NEAR(fit->sigma, 0.304854073561965, 1e-11);
  EXPECT_DOUBLE_EQ(fit->df, 9.0);
}

TEST(LeastSquares, hc3OfMotorCars) {
  // R 4.2.2, sandwich 3.0-2: f <- lm(mpg ~ wt + hp, mtcars); sqrt(diag(vcovHC(f, type = "HC3"))); hatvalues(f).
  const std::vector<Values> columns{Values(32, 1.0), data::weight, data::horsepower};
  const auto fit = leastSquares(columns, data::mpg);
  ASSERT_TRUE(fit) << fit.reason();
  EXPECT_NEAR(fit->coefficients[0], 37.227270116447201, 1e-12);
  EXPECT_NEAR(fit->coefficients[1], -3.877830742404682, 1e-13);
  EXPECT_NEAR(fit->coefficients[2], -0.031772946982161, 5e-15);
  EXPECT_NEAR(fit->residualSumOfSquares, 195.04775474146638, 1e-11);
  EXPECT_NEAR(fit->leverages[0], 0.0442769148204860, 5e-15);
  EXPECT_NEAR(std::accumulate(fit->leverages.begin(), fit->leverages.end(), 0.0), 3.0, 1e-12);
  const auto errors = hc3Errors(*fit, columns);
  ASSERT_TRUE(errors) << errors.reason();
  EXPECT_NEAR((*errors)[0], 2.22980540343623135, 1e-12);
  EXPECT_NEAR((*errors)[1], 0.76851905035781765, 1e-13);
  EXPECT_NEAR((*errors)[2], 0.00938513790864755, 1e-15);
}

TEST(LeastSquares, degenerate) {
  EXPECT_EQ(leastSquares({{1, 1, 1}, {0, 0, 0}}, Values{1, 2, 3}).reason(),
            leastSquares({{1, 1, 1}, {2, 2, 2}}, Values{1, 2, 3}).reason());
  EXPECT_EQ(leastSquares({{1, 1, 1}}, Values{1, 2, NAN}).reason(),
            leastSquares({{1, 1, NAN}}, Values{1, 2, 3}).reason());
  expectDistinct({leastSquares({}, Values{1, 2}).reason(), leastSquares({{1, 1, 1}}, Values{1, 2}).reason(),
                  leastSquares({{1, 1}, {1, 2}}, Values{1, 2}).reason(),
                  leastSquares({{1, 1, 1}, {2, 2, 2}}, Values{1, 2, 3}).reason(),
                  leastSquares({{1, 1, NAN}}, Values{1, 2, 3}).reason()});
  const std::vector<Values> alone{{1, 1, 1, 1}, {0, 0, 0, 1}};
  expectNames(hc3Errors(*leastSquares(alone, Values{1, 2, 3, 9}), alone).reason(), {});
}

TEST(CovarianceAnalysis, anorexia) {
  // R 4.2.2, MASS 7.3-58.2, sandwich 3.0-2: f <- lm(Postwt ~ (Treat == "CBT") + Prewt, data = subset(anorexia, Treat !=
  // "FT")); vcovHC(f, type = "HC3"); Student with 52 degrees of freedom. Slopes: the same with the product.
  const auto a =
      covarianceAnalysis({data::therapyBefore, data::therapyAfter}, {data::controlBefore, data::controlAfter});
  ASSERT_TRUE(a) << a.reason();
  EXPECT_NEAR(a->estimate, 4.244112265475052, 1e-12);
  EXPECT_NEAR(a->error, 1.849093714312690, 1e-12);
  EXPECT_NEAR(a->t, 2.29523913938164, 1e-12);
  EXPECT_DOUBLE_EQ(a->df, 52.0);
  EXPECT_NEAR(a->p, 0.02578477209603125, 1e-13);
  EXPECT_NEAR(a->interval.lower, 0.533634271389843, 1e-11);
  EXPECT_NEAR(a->interval.upper, 7.954590259560261, 1e-11);
  EXPECT_NEAR(a->slope, 0.304556944149741, 1e-13);
  ASSERT_TRUE(a->sameSlope) << a->sameSlope.reason();
  EXPECT_NEAR(*a->sameSlope, 0.0680655579907959, 1e-11);
}

TEST(CovarianceAnalysis, degenerate) {
  const Values base{1, 2, 3}, out{2, 4, 5};
  const auto reason = [&](const Values& bx, const Values& ox, const Values& by, const Values& oy) {
    return covarianceAnalysis({bx, ox}, {by, oy}).reason();
  };
  EXPECT_EQ(reason({5, 5}, {1, 2}, {6, 6}, {2, 3}), reason({5, 5}, {1, 2}, {5, 5}, {2, 3}));
  expectDistinct({reason({}, {}, base, out), reason(base, {1}, base, out), reason({5, 5}, {1, 2}, {5, 5}, {2, 3}),
                  reason({1}, {1}, {2}, {3}), reason({1}, {1}, base, out), reason({1, 2, NAN}, out, base, out)});
  expectNames(reason({0.1, 0.2, 0.7}, {3.2, 3.4, 4.4}, {0.1, 0.3, 0.5}, {1.2, 1.6, 2.0}), {});
}

}  // namespace
}  // namespace calot::analytics
