// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/calibration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "recorder/base/dates.h"
#include "recorder/base/errors.h"
#include "recorder/sources/devices/mouse_device.h"
#include "tests/recorder/sources/devices/support/calibration_streams.h"

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
  const auto refused = [&](const std::string& pointer, const nlohmann::json& value, const std::string& names) {
    nlohmann::json bad = good;
    bad[nlohmann::json::json_pointer(pointer)] = value;
    try {
      parseCalibration(bytesOf(bad.dump()), "c.json");
      ADD_FAILURE() << "taken: " << pointer << " " << value;
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::damaged);
      EXPECT_EQ(std::string(e.what()).find("c.json: "), 0U);
      EXPECT_NE(std::string(e.what()).find(names), std::string::npos) << e.what();
    }
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
    try {
      checkCalibration(calibration, info, mode, now, "c.json");
      return std::string();
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::refused);
      return std::string(e.what());
    }
  };
  EXPECT_EQ(verdict(c, device, Mode::assessment, "2026-01-01T12:00:00Z"), "");
  EXPECT_EQ(verdict(c, device, Mode::assessment, "2026-01-31T11:59:59Z"), "");
  EXPECT_NE(verdict(c, device, Mode::assessment, "2026-01-31T12:00:00Z").find("expired: 30 days"), std::string::npos);
  EXPECT_NE(verdict(c, device, Mode::assessment, "2026-01-01T11:59:59Z").find("future"), std::string::npos);
  EXPECT_EQ(verdict(c, device, Mode::practice, "2027-01-31T12:00:00Z"), "");
  Calibration failed = c;
  failed.hand[0]->noise = Vec3(0, 0.01, 0);
  EXPECT_NE(verdict(failed, device, Mode::assessment, "2026-01-02T12:00:00Z").find("failed: left noise"),
            std::string::npos);
  EXPECT_EQ(verdict(failed, device, Mode::practice, "2026-01-02T12:00:00Z"), "");
  DeviceInfo other = device;
  other.identity = "openigtlink:other/a,b";
  EXPECT_NE(verdict(c, other, Mode::assessment, "2026-01-02T12:00:00Z").find("another device"), std::string::npos);
  EXPECT_NE(verdict(c, other, Mode::practice, "2026-01-02T12:00:00Z").find("another device"), std::string::npos);
  Calibration oneHand = c;
  oneHand.hand[0].reset();
  EXPECT_NE(verdict(oneHand, device, Mode::assessment, "2026-01-02T12:00:00Z").find("1 of the 2 hands"),
            std::string::npos);
}

TEST(Calibration, LeapDaysAndYearsCount) {
  Calibration c;
  c.date = "2028-02-28T00:00:00Z";
  EXPECT_EQ(ageInDays(c, "2028-03-01T00:00:00Z"), 2);
  EXPECT_EQ(ageInDays(c, "2029-02-28T00:00:00Z"), 366);
  EXPECT_EQ(ageInDays(c, "2028-02-27T23:59:59Z"), -1);
}

/// What the published schema says of an object, against what the text holds: no JSON Schema library is at hand.
void agrees(const nlohmann::json& value, const nlohmann::json& schema, const nlohmann::json& root,
            const std::string& at) {
  const nlohmann::json& rule =
      schema.contains("$ref") ? root.at(nlohmann::json::json_pointer(schema.at("$ref").get<std::string>().substr(1)))
                              : schema;
  if (rule.contains("const")) {
    EXPECT_EQ(rule.at("const"), value) << at;
  }
  if (!rule.contains("type")) return;
  const std::string type = rule.at("type");
  if (type == "object") {
    ASSERT_TRUE(value.is_object()) << at;
    for (const auto& name : rule.at("required")) EXPECT_TRUE(value.contains(name)) << at << " lacks " << name;
    for (const auto& [name, child] : value.items()) {
      ASSERT_TRUE(rule.at("properties").contains(name)) << at << ": unknown " << name;
      agrees(child, rule.at("properties").at(name), root, at + "/" + name);
    }
  } else if (type == "array") {
    ASSERT_TRUE(value.is_array()) << at;
    if (rule.contains("minItems")) {
      EXPECT_GE(value.size(), rule.at("minItems").get<std::size_t>()) << at;
    }
    for (const auto& child : value) agrees(child, rule.at("items"), root, at + "/");
  } else if (type == "number" || type == "integer") {
    ASSERT_TRUE(type == "integer" ? value.is_number_integer() : value.is_number()) << at;
    if (rule.contains("minimum")) {
      EXPECT_GE(value.get<double>(), rule.at("minimum").get<double>()) << at;
    }
    if (rule.contains("maximum")) {
      EXPECT_LE(value.get<double>(), rule.at("maximum").get<double>()) << at;
    }
  } else if (type == "string") {
    EXPECT_TRUE(value.is_string()) << at;
  } else if (type == "boolean") {
    EXPECT_TRUE(value.is_boolean()) << at;
  } else {
    ADD_FAILURE() << "unknown type " << type;
  }
}

TEST(Calibration, ThePublishedSchemaSaysWhatIsWritten) {
  std::ifstream in(std::string(CALOT_SOURCE_DIR) + "/schemas/calibration.schema.json");
  const nlohmann::json schema = nlohmann::json::parse(in);
  const nlohmann::json text =
      nlohmann::json::parse(calibrationText(measureCalibration(wholeStream(0.0002), 0.1, trackerInfo()), true));
  agrees(text, schema, schema, "");
  for (const auto& name : schema.at("required")) {
    nlohmann::json without = text;
    without.erase(name.get<std::string>());
    EXPECT_THROW(parseCalibration(bytesOf(without.dump()), "c.json"), Error) << name;
  }
}

}  // namespace
}  // namespace calot::recorder
