// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/calibration.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>

#include "recorder/base/dates.h"
#include "recorder/base/errors.h"
#include "recorder/base/file_bytes.h"
#include "recorder/base/record_reader.h"
#include "recorder/base/record_writer.h"

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
                                 "is no date like 2026-01-31T23:59:59Z"};
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

std::int64_t secondsOf(const std::string& date) {
  const auto number = [&](std::size_t at, std::size_t length) { return std::stoi(date.substr(at, length)); };
  const std::chrono::sys_days day = std::chrono::year(number(0, 4)) /
                                    std::chrono::month(static_cast<unsigned>(number(5, 2))) /
                                    std::chrono::day(static_cast<unsigned>(number(8, 2)));
  return std::int64_t{day.time_since_epoch().count()} * 86400 + number(11, 2) * 3600 + number(14, 2) * 60 +
         number(17, 2);
}

}  // namespace

std::int64_t ageInDays(const Calibration& calibration, const std::string& now) {
  const std::int64_t seconds = secondsOf(now) - secondsOf(calibration.date);
  return seconds >= 0 ? seconds / 86400 : -((-seconds + 86399) / 86400);
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
  if (!isDate(c.date)) root.at("date").fail("is no date like 2026-01-31T23:59:59Z");
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
  if (age < 0) refuse("is dated in the future");
  if (age >= std::int64_t{c.validDays}) refuse(fmt::format("expired: {} days old, valid for {}", age, c.validDays));
  const int measured = static_cast<int>(c.hand[0].has_value()) + static_cast<int>(c.hand[1].has_value());
  if (measured < device.capabilities.hands)
    refuse(fmt::format("measured {} of the {} hands that the device drives", measured, device.capabilities.hands));
}

}  // namespace calot::recorder
