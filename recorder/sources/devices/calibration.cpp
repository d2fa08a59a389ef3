// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/calibration.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <ctime>
#include <iterator>
#include <numeric>
#include <utility>

#include "recorder/base/dates.h"
#include "recorder/base/errors.h"
#include "recorder/base/files.h"
#include "recorder/base/record_json.h"
#include "recorder/sources/devices/dense_solvers.h"
#include "recorder/sources/devices/mouse_device.h"
#include "recorder/sources/pointing.h"

namespace calot::recorder {

namespace {

constexpr double large = 1e6;

std::vector<Field> handsFields() {
  using S = Calibration;
  return {
      object("hands", "Hands that were measured"),
      optional("left", at<S, &S::hand, 0>, "Left hand"),
      optional("right", at<S, &S::hand, 1>, "Right hand"),
  };
}

}  // namespace

std::vector<Field> HandCalibration::fields() {
  using S = HandCalibration;
  return {
      object("hand", "One hand's tool; what could not be measured with this device is absent"),
      optional("tipOffset", at<S, &S::tipOffset>, "m", within(-2, 2), "Tip of the tool in its sensor's frame"),
      optional("pivotResidual", at<S, &S::pivotResidual>, "m", within(0, large),
               "Root mean square distance of the tip from its dimple"),
      optional("scale", at<S, &S::scale>, "1", above(0, 1000), "True length per measured length"),
      optional("scaleSpread", at<S, &S::scaleSpread>, "1", within(0, large),
               "Largest relative deviation of one stroke's scale from it"),
      optional("axesResidual", at<S, &S::axesResidual>, "rad", within(0, 4),
               "Largest angle between a stroke and its axis"),
      {"rate", at<S, &S::rate>, "1/s", within(0, large), "Rate of samples"},
      {"jitter", at<S, &S::jitter>, "s", within(0, large), "Standard deviation of the intervals between samples"},
      {"longInterval", at<S, &S::longInterval>, "s", within(0, large),
       "99th percentile of the intervals, nearest rank"},
      {"invalidShare", at<S, &S::invalidShare>, "1", within(0, 1), "Share of samples without a pose"},
      optional("axes", at<S, &S::axes>, "Unit quaternion w, x, y, z: the device's coordinates to right, down, away"),
      {"noise", at<S, &S::noise>, "m", within(0, large), "Root mean square at rest, each axis of the device"},
  };
}

std::vector<Field> CalibrationLimits::fields() {
  using S = CalibrationLimits;
  return {
      object("limits", "Limits: largest values, and the smallest rate"),
      {"pivotResidual", at<S, &S::pivotResidual>, "m", within(0, large), "Residual of the tip"},
      {"scaleSpread", at<S, &S::scaleSpread>, "1", within(0, large), "Spread of the scale"},
      {"axesResidual", at<S, &S::axesResidual>, "rad", within(0, 4), "Residual of the axes"},
      {"noise", at<S, &S::noise>, "m", within(0, large), "Noise of each axis"},
      {"rate", at<S, &S::rate>, "1/s", within(0, large), "Rate of samples"},
      {"longInterval", at<S, &S::longInterval>, "s", within(0, large), "99th percentile of the intervals"},
      {"invalidShare", at<S, &S::invalidShare>, "1", within(0, 1), "Share of samples without a pose"},
  };
}

std::vector<Field> Calibration::fields() {
  using S = Calibration;
  static constexpr TextRule date{32, "^[0-9]{4}-[0-9]{2}-[0-9]{2}T[0-9]{2}:[0-9]{2}:[0-9]{2}Z$",
                                 "is not a date like 2026-01-31T23:59:59Z"};
  return {
      object("",
             "Measurements of a device, their date and their verdict. The compact text is "
             "copied into every recording that was made with it"),
      fileFormat("calot-calibration"),
      fileFormatVersion(),
      {"device", at<S, &S::device>, TextRule{64}, "Class of device: camera, gamepad, openigtlink, scripted, null"},
      {"identity", at<S, &S::identity>, TextRule{256}, "The device; a calibration is used with no other"},
      {"date", at<S, &S::date>, date, "Time of the measurement: ISO 8601 with Z, to the second"},
      {"validDays", at<S, &S::validDays>, "d", within(1, 3650), "Validity from its date on"},
      {"passed", unstored<bool>, "All values meet the limits; must agree with them"},
      Field("shortcomings", unstored<std::vector<std::string>>, TextRule{200}, "Violated limits, one phrase each")
          .items(0, 64),
      {"hands", keyGroup<S, handsFields>, "Hands that were measured"},
      {"latency", at<S, &S::latency>, TextRule{64}, "A time with its unit, or the reason why there is none"},
      {"force", at<S, &S::force>, TextRule{64}, "An error with its unit, or the reason why there is none"},
      {"limits", at<S, &S::limits>, "Limits that the values must meet"},
      optional("camera", at<S, &S::camera>, "Cameras that watch printed handles: lenses, positions, trocars"),
      optional("declaredPixel", at<S, &S::declaredPixel>, "m", above(0, 1),
               "Motion of the hand per pixel of a mouse, as declared; nothing was measured then"),
  };
}

namespace {

/// Since 1970. @pre isDate(date)
std::int64_t secondsOf(const std::string& date) {
  std::tm time{};
  strptime(date.c_str(), "%Y-%m-%dT%H:%M:%SZ", &time);
  return timegm(&time);
}

}  // namespace

std::int64_t ageInDays(const Calibration& calibration, const std::string& now) {
  return static_cast<std::int64_t>(
      std::floor(static_cast<double>(secondsOf(now) - secondsOf(calibration.date)) / 86400.0));
}

std::vector<std::string> shortcomings(const Calibration& calibration) {
  std::vector<std::string> out;
  const CalibrationLimits& limit = calibration.limits;
  bool any = false;
  for (std::size_t i = 0; i < handCount; ++i) {
    if (!calibration.hand[i]) continue;
    any = true;
    const HandCalibration& h = *calibration.hand[i];
    const auto above = [&](const char* what, double value, double most, double unit, const char* name) {
      if (!(value <= most))
        out.push_back(
            fmt::format("{} {}: {:.3g} {}, at most {:.3g}", handNames[i], what, value * unit, name, most * unit));
    };
    if (h.pivotResidual) above("pivot residual", *h.pivotResidual, limit.pivotResidual, 1e3, "mm");
    if (h.scaleSpread) above("spread of the strokes' scale", *h.scaleSpread, limit.scaleSpread, 100.0, "%");
    if (h.axesResidual)
      above("angle of a stroke to its axis", *h.axesResidual, limit.axesResidual, 57.29577951308232, "deg");
    above("noise", h.noise.maxCoeff(), limit.noise, 1e3, "mm");
    above("99th percentile of the intervals", h.longInterval, limit.longInterval, 1e3, "ms");
    above("invalid samples", h.invalidShare, limit.invalidShare, 100.0, "%");
    if (!(h.rate >= limit.rate))
      out.push_back(fmt::format("{} rate: {:.3g} a second, at least {:.3g}", handNames[i], h.rate, limit.rate));
  }
  if (!any) out.emplace_back("no hand was measured");
  if (calibration.camera) {
    const std::vector<std::string> rig = rigShortcomings(*calibration.camera);
    out.insert(out.end(), rig.begin(), rig.end());
    for (std::size_t i = 0; i < handCount; ++i) {
      if (!calibration.hand[i] || !calibration.hand[i]->scale) continue;
      const double error = *calibration.hand[i]->scale - 1.0, most = calibration.camera->limits.scaleError;
      if (!(std::abs(error) <= most))
        out.push_back(
            fmt::format("{} scale: strokes are measured {:.1f} % too {}, at most {:.1f} %: check the sheets' ruler",
                        handNames[i], 100.0 * std::abs(error), error > 0.0 ? "short" : "long", 100.0 * most));
    }
  }
  return out;
}

std::string calibrationText(const Calibration& c, bool compact) {
  const std::vector<std::string> faults = shortcomings(c);
  nlohmann::ordered_json out = writeRecord(c);
  out["passed"] = faults.empty();
  out["shortcomings"] = faults;
  return compact ? out.dump() : out.dump(2) + "\n";
}

Calibration parseCalibration(std::span<const std::byte> bytes, const std::string& file) {
  const nlohmann::json document = parseStrictJson(bytes, file);
  const JsonPlace root(document, file);
  Calibration c;
  readRecord(root, c);
  if (!isDate(c.date)) root.at("date").fail("is not a date like 2026-01-31T23:59:59Z");
  if (root.at("passed").boolean() != shortcomings(c).empty())
    root.at("passed").fail("does not agree with the values and the limits");
  return c;
}

Calibration readCalibration(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  return parseCalibration(readFileBytes(file, name, 1U << 20U), name);
}

void checkCalibration(const Calibration& c, const DeviceInfo& device, Mode mode, const std::string& now,
                      const std::string& file) {
  const auto refuse = [&](const std::string& why) {
    throw Error(ErrorKind::refused, Where{file}, why, {Remedy::measureCalibration});
  };
  if (c.device != device.name || c.identity != device.identity)
    refuse(fmt::format("is of another device ({}, not {})", c.identity, device.identity));
  if (mode != Mode::assessment) return;
  const std::vector<std::string> faults = shortcomings(c);
  if (!faults.empty()) refuse("failed: " + faults.front());
  const std::int64_t age = ageInDays(c, now);
  if (age < 0) refuse(fmt::format("is dated in the future ({})", c.date));
  if (age >= std::int64_t{c.validDays}) refuse(fmt::format("expired: {} days old, valid for {}", age, c.validDays));
  const int measured = static_cast<int>(c.hand[0].has_value()) + static_cast<int>(c.hand[1].has_value());
  if (measured < device.capabilities.hands)
    refuse(fmt::format("measured {} of the {} hands that the device drives", measured, device.capabilities.hands));
}

namespace {

using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;
constexpr std::size_t fewestPoses = 10;
constexpr double minTurn = 0.01;
constexpr std::size_t fewestRest = 20;
constexpr std::array<const char*, 3> strokeNames{"stroke right", "stroke down", "stroke away"};

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
  const double mean = std::accumulate(interval.begin(), interval.end(), 0.0) / static_cast<double>(interval.size());
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

HandCalibration measureHand(const DeviceScript& stream, Hand hand, const std::vector<DeviceSample>& rest,
                            double strokeLength) {
  const char* const name = handNames[static_cast<std::size_t>(hand)];
  std::vector<DeviceSample> samples;
  std::copy_if(stream.samples.begin(), stream.samples.end(), std::back_inserter(samples),
               [hand](const DeviceSample& s) { return s.hand == hand; });
  HandCalibration out;
  out.noise = deviation(rest);
  measureIntervals(samples, out);
  const std::vector<DeviceSample> pivot = samplesIn(stream, hand, "pivot");
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
    const std::vector<DeviceSample> stroke = samplesIn(stream, hand, strokeNames[i]);
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

std::vector<DeviceSample> samplesIn(const DeviceScript& stream, Hand hand, const std::string& phase) {
  std::vector<DeviceSample> out;
  for (const DeviceScript::Phase& p : stream.phases) {
    if (p.name != phase) continue;
    std::copy_if(stream.samples.begin(), stream.samples.end(), std::back_inserter(out), [&](const DeviceSample& s) {
      return s.valid && s.hand == hand && s.hostTime >= p.from && s.hostTime < p.to;
    });
  }
  return out;
}

namespace {

/// The form whose largest value is taken by the quaternion w, x, y, z that turns measured into true directions best
/// (Horn, J. Opt. Soc. Am. A 4 (1987) 629). @param c sum of true times measured directions
Eigen::Matrix4d rotationForm(const Mat3& c) {
  const Vec3 turned(c(2, 1) - c(1, 2), c(0, 2) - c(2, 0), c(1, 0) - c(0, 1));
  Eigen::Matrix4d out;
  out(0, 0) = c.trace();
  out.block<1, 3>(0, 1) = turned.transpose();
  out.block<3, 1>(1, 0) = turned;
  out.block<3, 3>(1, 1) = c + c.transpose() - c.trace() * Mat3::Identity();
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
  if (!(eigenOf(normal).values[0] >= minTurn)) return std::nullopt;
  const Vec6 solution = solved(normal, right);
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
  const SymmetricEigen best = eigenOf(rotationForm(covariance));
  const Eigen::Vector4d q = best.vectors.col(3);
  const Mat3 rotation = Quat(q[0], q[1], q[2], q[3]).toRotationMatrix();
  StrokeFit fit;
  fit.axes = quaternionOf(rotation);
  double squares = 0.0;
  for (const Vec3& d : strokes) squares += d.squaredNorm();
  fit.scale = length * best.values[3] / squares;
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
    const auto hand = static_cast<Hand>(h);
    const std::vector<DeviceSample> rest = samplesIn(stream, hand, "rest");
    if (rest.size() < fewestRest) continue;
    any = true;
    out.hand[h] = measureHand(stream, hand, rest, strokeLength);
  }
  if (!any) refuse(stream, fmt::format("no hand has {} valid samples in a phase \"rest\"", fewestRest));
  return out;
}

Calibration declaredCalibration(const DeviceInfo& device, double pixel) {
  constexpr double leastPixel = 1e-6, mostPixel = 0.005;  // m: 25,000 and 5 counts an inch
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
