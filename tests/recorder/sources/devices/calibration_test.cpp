// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/calibration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "recorder/base/dates.h"
#include "recorder/sources/devices/mouse_device.h"
#include "tests/recorder/sources/devices/support/calibration_streams.h"
#include "tests/support/fault.h"

namespace calot::recorder {
namespace {

using devicetest::bytesOf;
using devicetest::trackerInfo;
using devicetest::wholeStream;

TEST(Calibration, TheTextComesBackAsItWas) {
  const Calibration c = measureCalibration(wholeStream(0.0002), 0.1, trackerInfo());
  for (const bool compact : {false, true}) {
    const std::string text = calibrationText(c, compact);
    EXPECT_EQ(text.find('\n') == std::string::npos, compact);
    const Calibration back = parseCalibration(bytesOf(text), "c.json");
    EXPECT_EQ(calibrationText(back, compact), text);
  }
}

TEST(Calibration, BadFilesAreRefusedWithTheirPlace) {
  const Calibration c = measureCalibration(wholeStream(0.0002), 0.1, trackerInfo());
  const nlohmann::json good = nlohmann::json::parse(calibrationText(c, true));
  const auto refused = [&](const std::string& pointer, const nlohmann::json& value, const std::string& place) {
    nlohmann::json bad = good;
    bad[nlohmann::json::json_pointer(pointer)] = value;
    SCOPED_TRACE(pointer + " " + value.dump());
    expectFault(ErrorKind::damaged, "", {"c.json: ", place}, [&] { parseCalibration(bytesOf(bad.dump()), "c.json"); });
  };
  refused("/format", "x", "/format");
  refused("/formatVersion", 2, "/formatVersion");
  refused("/date", "yesterday", "/date");
  refused("/date", "2026-13-01T00:00:00Z", "/date");
  refused("/validDays", 0, "/validDays");
  refused("/passed", false, "/passed");
  refused("/hands/left/axes", {1, 1, 0, 0}, "/hands/left/axes");
  refused("/hands/left/scale", 0, "/hands/left/scale");
  refused("/hands/left/noise", {1, 2}, "/hands/left/noise");
  refused("/hands/middle", 1, "middle");
  refused("/limits/rate", "fast", "/limits/rate");
}

TEST(Calibration, OfAMouseIsDeclared) {
  const MouseDevice mouse(std::make_shared<MouseInput>());
  const Calibration c = declaredCalibration(mouse.info(), 0.00005);
  EXPECT_TRUE(shortcomings(c).empty());
  EXPECT_NO_THROW(checkCalibration(c, mouse.info(), Mode::assessment, presentDate(), "c.json"));
  const Calibration back = parseCalibration(bytesOf(calibrationText(c, true)), "c.json");
  EXPECT_EQ(back.declaredPixel, 0.00005);
  EXPECT_FALSE(back.hand[0]->scale) << "the tip moves as it did";
  EXPECT_THROW(declaredCalibration(trackerInfo(), 0.00005), Error);
  for (const double pixel : {0.0, -0.001, 1.0, std::nan("")})
    EXPECT_THROW(declaredCalibration(mouse.info(), pixel), Error);
}

TEST(Calibration, AssessmentRefusesWhatPracticeMayUse) {
  Calibration c = measureCalibration(wholeStream(0.0002), 0.1, trackerInfo());
  c.date = "2026-01-01T12:00:00Z";
  const DeviceInfo device = trackerInfo();
  const auto verdict = [&](const Calibration& calibration, const DeviceInfo& info, Mode mode, const char* now) {
    return caught([&] { checkCalibration(calibration, info, mode, now, "c.json"); });
  };
  const auto refuses = [](const std::vector<std::string>& values, const std::optional<Error>& error) {
    expectFault(ErrorKind::refused, "c.json", values, error, {Remedy::measureCalibration});
  };
  EXPECT_FALSE(verdict(c, device, Mode::assessment, "2026-01-01T12:00:00Z"));
  EXPECT_FALSE(verdict(c, device, Mode::assessment, "2026-01-31T11:59:59Z"));
  refuses({"30"}, verdict(c, device, Mode::assessment, "2026-01-31T12:00:00Z"));
  refuses({c.date}, verdict(c, device, Mode::assessment, "2026-01-01T11:59:59Z"));
  EXPECT_FALSE(verdict(c, device, Mode::practice, "2027-01-31T12:00:00Z"));
  Calibration failed = c;
  failed.hand[0]->noise = Vec3(0, 0.01, 0);
  refuses({"left", "noise"}, verdict(failed, device, Mode::assessment, "2026-01-02T12:00:00Z"));
  EXPECT_FALSE(verdict(failed, device, Mode::practice, "2026-01-02T12:00:00Z"));
  DeviceInfo other = device;
  other.identity = "openigtlink:other/a,b";
  refuses({c.identity, other.identity}, verdict(c, other, Mode::assessment, "2026-01-02T12:00:00Z"));
  refuses({c.identity, other.identity}, verdict(c, other, Mode::practice, "2026-01-02T12:00:00Z"));
  Calibration oneHand = c;
  oneHand.hand[0].reset();
  refuses({"1", "2"}, verdict(oneHand, device, Mode::assessment, "2026-01-02T12:00:00Z"));
}

TEST(Calibration, LeapDaysAndYearsCount) {
  Calibration c;
  c.date = "2028-02-28T00:00:00Z";
  EXPECT_EQ(ageInDays(c, "2028-03-01T00:00:00Z"), 2);
  EXPECT_EQ(ageInDays(c, "2029-02-28T00:00:00Z"), 366);
  EXPECT_EQ(ageInDays(c, "2028-02-27T23:59:59Z"), -1);
}

TEST(Calibration, NoRequiredKeyMayBeMissing) {
  const nlohmann::json text =
      nlohmann::json::parse(calibrationText(measureCalibration(wholeStream(0.0002), 0.1, trackerInfo()), true));
  for (const Field& field : recordOf<Calibration>().fields) {
    if (!field.required) continue;
    nlohmann::json without = text;
    EXPECT_EQ(without.erase(field.name), 1U) << field.name;
    EXPECT_THROW(parseCalibration(bytesOf(without.dump()), "c.json"), Error) << field.name;
  }
}

}  // namespace
}  // namespace calot::recorder
