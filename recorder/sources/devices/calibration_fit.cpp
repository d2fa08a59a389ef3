// SPDX-License-Identifier: GPL-3.0-or-later

#include "recorder/sources/devices/calibration_fit.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

#include "recorder/base/dates.h"
#include "recorder/base/errors.h"
#include "recorder/sources/devices/mouse_device.h"
#include "recorder/sources/pointing.h"

namespace calot::recorder {
namespace {

using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;
constexpr std::size_t fewestPoses = 10;
constexpr double minTurn = 0.01;
constexpr std::size_t fewestRest = 20;
constexpr std::array<const char*, 3> strokeNames{"stroke right", "stroke down", "stroke away"};

std::vector<DeviceSample> inPhase(const std::vector<DeviceSample>& samples, const DeviceScript& stream,
                                  const std::string& name) {
  std::vector<DeviceSample> out;
  for (const DeviceScript::Phase& phase : stream.phases) {
    if (phase.name != name) continue;
    for (const DeviceSample& s : samples) {
      if (s.valid && s.hostTime >= phase.from && s.hostTime < phase.to) out.push_back(s);
    }
  }
  return out;
}

Vec3 meanTip(std::span<const DeviceSample> samples, const Vec3& offset) {
  Vec3 sum = Vec3::Zero();
  for (const DeviceSample& s : samples) sum += s.position + s.orientation * offset;
  return sum / static_cast<double>(samples.size());
}

Vec3 deviation(std::span<const DeviceSample> samples) {
  const Vec3 mean = meanTip(samples, Vec3::Zero());
  Vec3 sum = Vec3::Zero();
  for (const DeviceSample& s : samples) sum += (s.position - mean).cwiseAbs2();
  return (sum / static_cast<double>(samples.size())).cwiseSqrt();
}

// Intervals of the device's receptions; @pre two samples at least.
void measureIntervals(const std::vector<DeviceSample>& samples, HandCalibration& out) {
  std::vector<double> interval;
  std::size_t invalid = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!samples[i].valid) ++invalid;
    if (i > 0) interval.push_back(1e-9 * static_cast<double>(samples[i].hostTime - samples[i - 1].hostTime));
  }
  double sum = 0.0;
  for (const double d : interval) sum += d;
  const double mean = sum / static_cast<double>(interval.size());
  double squares = 0.0;
  for (const double d : interval) squares += (d - mean) * (d - mean);
  std::sort(interval.begin(), interval.end());
  out.rate = mean > 0.0 ? 1.0 / mean : 0.0;
  out.jitter = std::sqrt(squares / static_cast<double>(interval.size()));
  out.longInterval = interval[std::min(interval.size() - 1, (interval.size() * 99 + 99) / 100 - 1)];
  out.invalidShare = static_cast<double>(invalid) / static_cast<double>(samples.size());
}

[[noreturn]] void refuse(const DeviceScript& stream, const std::string& why) {
  throw Error(ErrorKind::damaged, Where{stream.file}, why);
}

HandCalibration measureHand(const DeviceScript& stream, const std::vector<DeviceSample>& samples,
                            const std::vector<DeviceSample>& rest, double strokeLength, const char* name) {
  HandCalibration out;
  out.noise = deviation(rest);
  measureIntervals(samples, out);
  const std::vector<DeviceSample> pivot = inPhase(samples, stream, "pivot");
  if (!pivot.empty()) {
    const std::optional<PivotFit> fit = fitPivot(pivot);
    if (!fit) {
      refuse(stream,
             fmt::format("{} hand: the phase \"pivot\" ({} samples) does not turn the tool enough: tilt it by 30 "
                         "degrees or more in all directions",
                         name, pivot.size()));
    }
    out.tipOffset = fit->tipOffset;
    out.pivotResidual = fit->residual;
  }
  std::array<Vec3, 3> strokes;
  std::size_t there = 0;
  for (std::size_t i = 0; i < strokes.size(); ++i) {
    const std::vector<DeviceSample> stroke = inPhase(samples, stream, strokeNames[i]);
    if (stroke.size() < 2) continue;
    strokes[i] = strokeOf(stroke, out.tipOffset.value_or(Vec3::Zero()));
    ++there;
  }
  if (there == 0) return out;
  const std::optional<StrokeFit> fit =
      there == strokes.size() ? fitStrokes(strokes, strokeLength) : std::optional<StrokeFit>();
  if (!fit) {
    refuse(stream, fmt::format("{} hand: the strokes are not three of {:.0f} mm to the right, down and away", name,
                               1e3 * strokeLength));
  }
  out.scale = fit->scale;
  out.axes = fit->axes;
  out.scaleSpread = fit->scaleSpread;
  out.axesResidual = fit->axesResidual;
  return out;
}

}  // namespace

std::optional<PivotFit> fitPivot(std::span<const DeviceSample> samples) {
  if (samples.size() < fewestPoses) return std::nullopt;
  const auto n = static_cast<double>(samples.size());
  // Normal equations of [R_i  -I] [o; p] = -t_i.
  Mat6 normal = Mat6::Zero();
  Vec6 right = Vec6::Zero();
  const Vec3 middle = meanTip(samples, Vec3::Zero());  // keeps the numbers small
  for (const DeviceSample& s : samples) {
    const Mat3 r = s.orientation.toRotationMatrix();
    const Vec3 t = s.position - middle;
    normal.topLeftCorner<3, 3>() += Mat3::Identity() / n;
    normal.topRightCorner<3, 3>() -= r.transpose() / n;
    normal.bottomLeftCorner<3, 3>() -= r / n;
    normal.bottomRightCorner<3, 3>() += Mat3::Identity() / n;
    right.head<3>() -= r.transpose() * t / n;
    right.tail<3>() += t / n;
  }
  const Eigen::SelfAdjointEigenSolver<Mat6> values(normal, Eigen::EigenvaluesOnly);
  if (!(values.eigenvalues()[0] >= minTurn)) return std::nullopt;
  const Vec6 solution = normal.ldlt().solve(right);
  PivotFit fit;
  fit.tipOffset = solution.head<3>();
  fit.pivot = solution.tail<3>() + middle;
  double squares = 0.0;
  for (const DeviceSample& s : samples)
    squares += (s.orientation * fit.tipOffset + s.position - fit.pivot).squaredNorm();
  fit.residual = std::sqrt(squares / n);
  if (!fit.tipOffset.allFinite() || !std::isfinite(fit.residual)) return std::nullopt;
  return fit;
}

std::optional<StrokeFit> fitStrokes(const std::array<Vec3, 3>& strokes, double length) {
  double longest = 0.0, shortest = 1e300;
  Mat3 covariance = Mat3::Zero();
  for (int i = 0; i < 3; ++i) {
    const Vec3& d = strokes[static_cast<std::size_t>(i)];
    const double size = d.norm();
    if (!std::isfinite(size)) return std::nullopt;
    longest = std::max(longest, size);
    shortest = std::min(shortest, size);
    covariance += Vec3::Unit(i) * d.transpose();
  }
  if (!(longest > 0.0) || shortest < 0.1 * longest) return std::nullopt;
  if (!(covariance.determinant() > 0.0)) return std::nullopt;  // mirrored
  const Eigen::JacobiSVD<Mat3> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Mat3 rotation = svd.matrixU() * svd.matrixV().transpose();
  if (!(rotation.determinant() > 0.0)) return std::nullopt;
  StrokeFit fit;
  fit.axes = quaternionOf(rotation);
  double squares = 0.0;
  for (const Vec3& d : strokes) squares += d.squaredNorm();
  fit.scale = length * svd.singularValues().sum() / squares;
  for (int i = 0; i < 3; ++i) {
    const Vec3 d = rotation * strokes[static_cast<std::size_t>(i)];
    fit.scaleSpread = std::max(fit.scaleSpread, std::abs(length / d.norm() / fit.scale - 1.0));
    fit.axesResidual = std::max(fit.axesResidual, std::atan2(d.cross(Vec3::Unit(i)).norm(), d[i]));
  }
  return fit;
}

Vec3 strokeOf(std::span<const DeviceSample> samples, const Vec3& tipOffset) {
  const std::size_t end = std::max<std::size_t>(1, samples.size() / 10);
  return meanTip(samples.last(end), tipOffset) - meanTip(samples.first(end), tipOffset);
}

Calibration measureCalibration(const DeviceScript& stream, double strokeLength, const DeviceInfo& device) {
  Calibration out;
  out.device = device.name;
  out.identity = device.identity;
  out.date = presentDate();
  if (device.capabilities.actuated > 0) out.force = "not measured";
  bool any = false;
  for (std::size_t h = 0; h < handCount; ++h) {
    std::vector<DeviceSample> samples;
    for (const DeviceSample& s : stream.samples) {
      if (static_cast<std::size_t>(s.hand) == h) samples.push_back(s);
    }
    const std::vector<DeviceSample> rest = inPhase(samples, stream, "rest");
    if (rest.size() < fewestRest) continue;
    any = true;
    out.hand[h] = measureHand(stream, samples, rest, strokeLength, handNames[h]);
  }
  if (!any) refuse(stream, fmt::format("no hand has {} valid samples in a phase \"rest\"", fewestRest));
  return out;
}

namespace {

constexpr double leastPixel = 1e-6, mostPixel = 0.005;  // m: 25,000 and 5 counts an inch

}  // namespace

Calibration declaredCalibration(const DeviceInfo& device, double pixel) {
  if (device.name != mouseKind.name)
    throw Error(ErrorKind::invalid, fmt::format("{}: is measured; only a mouse is declared", device.identity));
  if (!(pixel >= leastPixel && pixel <= mostPixel))
    throw Error(ErrorKind::invalid, fmt::format("{:g} mm a pixel: a mouse's are {:g} to {:g}", 1e3 * pixel,
                                                1e3 * leastPixel, 1e3 * mostPixel));
  Calibration out;
  out.device = device.name;
  out.identity = device.identity;
  out.date = presentDate();
  out.declaredPixel = pixel;
  HandCalibration hand;
  hand.rate = device.capabilities.rate;
  hand.longInterval = 1.0 / hand.rate;
  for (int h = 0; h < device.capabilities.hands; ++h) out.hand[static_cast<std::size_t>(h)] = hand;
  return out;
}

}  // namespace calot::recorder
