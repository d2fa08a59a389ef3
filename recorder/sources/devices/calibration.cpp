// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/calibration.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <utility>

#include "recorder/base/dates.h"
#include "recorder/base/errors.h"
#include "recorder/base/file_bytes.h"
#include "recorder/sources/json_values.h"

namespace calot::recorder {
namespace {

using Json = nlohmann::ordered_json;
constexpr std::size_t maxBytes = 1U << 20U;
constexpr double large = 1e6;

const ObjectRule rootRule{"",
                          {{"format"},
                           {"formatVersion", true, 1, 1},
                           {"device"},
                           {"identity"},
                           {"date"},
                           {"validDays", true, 1, 3650},
                           {"passed"},
                           {"shortcomings"},
                           {"hands"},
                           {"latency"},
                           {"force"},
                           {"limits"},
                           {"camera", false},
                           {"declaredPixel", false, 0, 1, true, false}}};
const ObjectRule handsRule{"hands", {{"left", false}, {"right", false}}};
JsonValues valuesOf(HandCalibration& h) {
  return {{{"tipOffset", false, -2, 2}, &h.tipOffset},
          {{"pivotResidual", false, 0, large}, &h.pivotResidual},
          {{"scale", false, 0, 1000, true, false}, &h.scale},
          {{"scaleSpread", false, 0, large}, &h.scaleSpread},
          {{"axesResidual", false, 0, 4}, &h.axesResidual},
          {{"rate", true, 0, large}, &h.rate},
          {{"jitter", true, 0, large}, &h.jitter},
          {{"longInterval", true, 0, large}, &h.longInterval},
          {{"invalidShare", true, 0, 1}, &h.invalidShare},
          {{"axes", false, -1, 1}, &h.axes},
          {{"noise", true, 0, large}, &h.noise}};
}

JsonValues valuesOf(CalibrationLimits& l) {
  return {{{"pivotResidual", true, 0, large}, &l.pivotResidual},
          {{"scaleSpread", true, 0, large}, &l.scaleSpread},
          {{"axesResidual", true, 0, 4}, &l.axesResidual},
          {{"noise", true, 0, large}, &l.noise},
          {{"rate", true, 0, large}, &l.rate},
          {{"longInterval", true, 0, large}, &l.longInterval},
          {{"invalidShare", true, 0, 1}, &l.invalidShare}};
}

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

std::string calibrationText(Calibration c, bool compact) {
  const std::vector<std::string> faults = shortcomings(c);
  Json out{{"format", "calot-calibration"}, {"formatVersion", 1},    {"device", c.device},
           {"identity", c.identity},        {"date", c.date},        {"validDays", c.validDays},
           {"passed", faults.empty()},      {"shortcomings", faults}};
  Json hands = Json::object();
  for (std::size_t i = 0; i < handCount; ++i) {
    if (c.hand[i]) hands[handNames[i]] = jsonOf(valuesOf(*c.hand[i]));
  }
  out["hands"] = hands;
  out["latency"] = c.latency;
  out["force"] = c.force;
  out["limits"] = jsonOf(valuesOf(c.limits));
  if (c.camera) out["camera"] = rigJson(*c.camera);
  if (c.declaredPixel) out["declaredPixel"] = *c.declaredPixel;
  return compact ? out.dump() : out.dump(2) + "\n";
}

Calibration parseCalibration(std::span<const std::byte> bytes, const std::string& file) {
  const nlohmann::json document = parseStrictJson(bytes, file);
  const JsonObject root = JsonPlace(document, file).object(rootRule);
  if (root.at("format").text(64) != "calot-calibration") root.at("format").fail("is not \"calot-calibration\"");
  std::uint32_t version = 0;
  root.read("formatVersion", version);
  Calibration c;
  root.read("device", c.device, 64);
  root.read("identity", c.identity, 256);
  root.read("date", c.date, 32);
  if (!isDate(c.date)) root.at("date").fail("is no date like 2026-01-31T23:59:59Z");
  root.read("validDays", c.validDays);
  root.read("latency", c.latency, 64);
  root.read("force", c.force, 64);
  for (const JsonPlace& place : root.at("shortcomings").list(0, 64)) (void)place.text(200);
  const JsonObject hands = root.at("hands").object(handsRule);
  for (std::size_t i = 0; i < handCount; ++i) {
    if (hands.has(handNames[i])) readValues(hands.at(handNames[i]), valuesOf(c.hand[i].emplace()));
  }
  readValues(root.at("limits"), valuesOf(c.limits));
  if (root.has("camera")) c.camera = rigOf(root.at("camera"));
  if (root.has("declaredPixel")) root.read("declaredPixel", c.declaredPixel.emplace());
  if (root.at("passed").boolean() != shortcomings(c).empty())
    root.at("passed").fail("does not agree with the values and the limits");
  return c;
}

Calibration readCalibration(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  return parseCalibration(readFileBytes(file, name, maxBytes), name);
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
