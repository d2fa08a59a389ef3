// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/calibration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "recorder/base/dates.h"
#include "tests/recorder/sources/devices/support/calibration_streams.h"
#include "tests/support/fault.h"

namespace calot::recorder {
namespace {

using namespace devicetest;

TEST(CalibrationFit, PivotFindsTheTip) {
  const std::optional<PivotFit> fit = fitPivot(pivotStream(300, 0.8, 0.0, 1));
  ASSERT_TRUE(fit);
  EXPECT_NEAR((fit->tipOffset - trueTip).norm(), 0.0, 1e-12);
  EXPECT_NEAR((fit->pivot - truePivot).norm(), 0.0, 1e-12);
  EXPECT_NEAR(fit->residual, 0.0, 1e-12);
}

TEST(CalibrationFit, PivotUnderNoiseIsAsGoodAsTheNoiseAllows) {
  constexpr double noise = 0.0005;  // each axis
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const std::optional<PivotFit> fit = fitPivot(pivotStream(1000, 0.7, noise, seed));
    ASSERT_TRUE(fit);
    EXPECT_LT((fit->tipOffset - trueTip).norm(), 0.0003);
    EXPECT_NEAR(fit->residual, noise * std::sqrt(3.0), 0.1 * noise);
  }
}

TEST(CalibrationFit, PivotRefusesWhatDoesNotTurn) {
  EXPECT_FALSE(fitPivot(pivotStream(300, 0.02, 0.0005, 1)));
  EXPECT_FALSE(fitPivot(pivotStream(9, 0.8, 0.0, 1)));
  std::vector<DeviceSample> oneAxis;  // the offset along the axis is not determined
  for (int i = 0; i < 100; ++i) {
    const Quat q(Eigen::AngleAxisd(0.03 * i, Vec3::UnitX()));
    DeviceSample s = sampleAt(i, Hand::right, truePivot - q * trueTip);
    s.orientation = q;
    oneAxis.push_back(s);
  }
  EXPECT_FALSE(fitPivot(oneAxis));
}

TEST(CalibrationFit, StrokesGiveAxesAndScale) {
  const Quat axes(Eigen::AngleAxisd(1.1, Vec3(1, 2, 3).normalized()));  // q_CD
  std::array<Vec3, 3> strokes;
  for (int i = 0; i < 3; ++i) strokes[static_cast<std::size_t>(i)] = axes.conjugate() * (0.08 * Vec3::Unit(i));
  std::optional<StrokeFit> fit = fitStrokes(strokes, 0.1);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->scale, 1.25, 1e-12);
  EXPECT_NEAR(fit->axes.angularDistance(axes), 0.0, 1e-7);
  EXPECT_NEAR(fit->scaleSpread, 0.0, 1e-12);
  EXPECT_NEAR(fit->axesResidual, 0.0, 1e-7);

  strokes[0] *= 1.1;
  strokes[1] = Eigen::AngleAxisd(0.06, axes.conjugate() * Vec3::UnitX()) * strokes[1];
  fit = fitStrokes(strokes, 0.1);
  ASSERT_TRUE(fit);
  EXPECT_GT(fit->scaleSpread, 0.03);
  EXPECT_GT(fit->axesResidual, 0.02);
  EXPECT_LT(fit->axesResidual, 0.06);

  std::swap(strokes[0], strokes[1]);
  EXPECT_FALSE(fitStrokes(strokes, 0.1)) << "mirrored";
  std::swap(strokes[0], strokes[1]);
  strokes[2].setZero();
  EXPECT_FALSE(fitStrokes(strokes, 0.1));
  EXPECT_FALSE(fitStrokes({Vec3::Zero(), Vec3::Zero(), Vec3::Zero()}, 0.1));
}

TEST(CalibrationFit, MeasuresAWholeStream) {
  const Calibration c = measureCalibration(wholeStream(0.0002), 0.1, trackerInfo());
  EXPECT_EQ(c.identity, "openigtlink:h/a,b");
  expectNames(c.latency, {"measured"});
  expectNames(c.force, {"applicable"});
  EXPECT_EQ(ageInDays(c, presentDate()), 0);
  for (const auto& hand : c.hand) {
    ASSERT_TRUE(hand);
    EXPECT_NEAR((hand->tipOffset.value() - trueTip).norm(), 0.0, 0.0003);
    EXPECT_NEAR(hand->pivotResidual.value(), 0.0002 * std::sqrt(3.0), 0.00004);
    EXPECT_NEAR(hand->scale.value(), 1.25, 0.005);
    EXPECT_NEAR(hand->axes->angularDistance(Quat(Eigen::AngleAxisd(0.5, Vec3::UnitY()))), 0.0, 0.005);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(hand->noise[k], 0.0002, 0.00004);
    EXPECT_NEAR(hand->rate, 100.0, 1e-6);
    EXPECT_NEAR(hand->jitter, 0.0, 1e-9);
    EXPECT_NEAR(hand->longInterval, 0.01, 1e-12);
    EXPECT_EQ(hand->invalidShare, 0.0);
  }
  EXPECT_TRUE(shortcomings(c).empty());
  EXPECT_FALSE(shortcomings(measureCalibration(wholeStream(0.002), 0.1, trackerInfo())).empty());
}

TEST(CalibrationFit, IntervalsAndInvalidSamplesAreMeasured) {
  DeviceScript script = wholeStream(0.0);
  for (std::size_t i = 0; i < script.samples.size(); i += 20) script.samples[i].valid = false;
  std::int64_t late = 0;
  for (std::size_t i = 2; i < script.samples.size(); i += 2) {
    if (i % 100 == 0) late += 100'000'000;  // 2 % of the intervals are 110 ms
    script.samples[i].hostTime += late;
    script.samples[i + 1].hostTime += late;
  }
  script.phases = {{"rest", 0, 1'000'000'000}};
  const Calibration c = measureCalibration(script, 0.1, trackerInfo());
  ASSERT_TRUE(c.hand[0]);
  EXPECT_NEAR(c.hand[0]->invalidShare, 0.1, 0.001);
  EXPECT_NEAR(c.hand[0]->longInterval, 0.11, 1e-9);
  EXPECT_GT(c.hand[0]->jitter, 0.01);
  EXPECT_LT(c.hand[0]->rate, 90.0);
  EXPECT_FALSE(c.hand[0]->tipOffset);
  EXPECT_GE(shortcomings(c).size(), 3U);
}

TEST(CalibrationFit, StreamsThatCannotBeMeasuredSayWhy) {
  const auto refused = [](DeviceScript script, const std::string& names) {
    expectFault(ErrorKind::damaged, "", {names}, [&] { measureCalibration(script, 0.1, trackerInfo()); });
  };
  DeviceScript script = wholeStream(0.0);
  script.phases.erase(script.phases.begin());
  refused(script, "\"rest\"");
  script = wholeStream(0.0);
  for (DeviceSample& s : script.samples) s.orientation = Quat::Identity();
  refused(script, "\"pivot\"");
  script = wholeStream(0.0);
  script.phases.pop_back();
  refused(script, "strokes");
  script = wholeStream(0.0);
  std::swap(script.phases[2].name, script.phases[3].name);
  refused(script, "strokes");
  refused(DeviceScript{}, "\"rest\"");
}

}  // namespace
}  // namespace calot::recorder
