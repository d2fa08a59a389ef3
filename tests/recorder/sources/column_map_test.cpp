// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/column_map.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "sim/math/random.h"
#include "tests/support/fault.h"

namespace calot::recorder::column_map_test {
namespace {

using nlohmann::json;

std::vector<std::byte> bytesOf(const std::string& text) {
  std::vector<std::byte> bytes(text.size());
  if (!text.empty()) std::memcpy(bytes.data(), text.data(), text.size());
  return bytes;
}

json validMap() {
  return json::parse(R"({"format": "calot-columns", "formatVersion": 1, "device": "tracker", "frame": "world",
    "length": "mm", "time": {"column": "t", "unit": "ms"},
    "left": {"position": ["lx", "ly", "lz"], "quaternion": ["qw", "qx", "qy", "qz"], "axis": "x"},
    "right": {"position": ["rx", "ry", "rz"]}})");
}

ColumnMap mapOf(const json& map) { return parseColumnMap(bytesOf(map.dump()), "m.json"); }

std::optional<Error> mapFault(const json& map) {
  return caught([&] { (void)mapOf(map); });
}

std::optional<Error> motionFault(const std::string& text, const json& map = validMap()) {
  return caught([&] { (void)parseCsvMotion(bytesOf(text), "m.csv", mapOf(map)); });
}

const std::string names = "note, t ,lx,ly,lz,qw,qx,qy,qz,\"rx\",ry,rz\n";
const std::string rowA = "a,1000,10,20,30,1,0,0,0,-1,-2,-3\n";
const std::string rowB = "nan,1010,11,20,30,0.8,0.6,0,0,-1,-2,-4\n";

TEST(CsvMotion, readsUnitsOrderAndAxis) {
  // Order of columns is the file's; blanks, quotes, Windows line ends and a byte order mark are of no account.
  std::string text = "\xEF\xBB\xBF" + names + rowA + rowB + "\n\n";
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2) text.insert(at, 1, '\r');
  const TrackedMotion m = parseCsvMotion(bytesOf(text), "m.csv", mapOf(validMap()));
  ASSERT_EQ(m.time.size(), 2U);
  EXPECT_EQ(m.time[0], 0.0);
  EXPECT_NEAR(m.time[1], 0.01, 1e-15);
  EXPECT_EQ(m.rate, 0.0);
  EXPECT_LT((m.hand[0].position[1] - Vec3(0.011, 0.02, 0.03)).norm(), 1e-15);
  EXPECT_LT((m.hand[1].position[1] - Vec3(-0.001, -0.002, -0.004)).norm(), 1e-15);
  EXPECT_TRUE(m.hand[0].oriented);
  EXPECT_FALSE(m.hand[1].oriented);
  // The file's x axis is the shaft: z of the instrument is x of the file's orientation.
  const Quat given(0.8, 0.6, 0.0, 0.0);
  EXPECT_LT((m.hand[0].orientation[1] * Vec3::UnitZ() - given * Vec3::UnitX()).norm(), 1e-14);
  EXPECT_EQ(m.device, "tracker");
  EXPECT_EQ(m.frame, "world");
}

TEST(CsvMotion, theLastRowNeedsNoLineEnd) {
  const std::string text = names + rowA + rowB;
  const TrackedMotion m = parseCsvMotion(bytesOf(text.substr(0, text.size() - 1)), "m.csv", mapOf(validMap()));
  ASSERT_EQ(m.time.size(), 2U);
  EXPECT_NEAR(m.hand[1].position[1].z(), -0.004, 1e-15);
}

TEST(CsvMotion, lengthDoesNotDependOnWhenItBegan) {
  json map = validMap();
  map["time"]["unit"] = "s";
  const auto lengthFrom = [&](const char* first, const char* last) {
    const std::string rest = ",10,20,30,1,0,0,0,-1,-2,-3\n";
    return parseCsvMotion(bytesOf(names + "a," + first + rest + "b," + last + rest), "m.csv", mapOf(map)).time.back();
  };
  ASSERT_NE(23.4 - 11.7, 35.1 - 23.4);  // in binary
  EXPECT_EQ(lengthFrom("11.7", "23.4"), 11.7);
  EXPECT_EQ(lengthFrom("23.4", "35.1"), 11.7);
}

TEST(CsvMotion, everyAxisIsTurnedOntoZ) {
  const std::pair<const char*, Vec3> axes[] = {{"x", Vec3::UnitX()},   {"-x", -Vec3::UnitX()}, {"y", Vec3::UnitY()},
                                               {"-y", -Vec3::UnitY()}, {"z", Vec3::UnitZ()},   {"-z", -Vec3::UnitZ()}};
  for (const auto& [name, axis] : axes) {
    json map = validMap();
    map["left"]["axis"] = name;
    EXPECT_LT((mapOf(map).hand[0]->axis * Vec3::UnitZ() - axis).norm(), 1e-15) << name;
  }
}

TEST(CsvMotion, aMatrixARateAndAnotherDelimiter) {
  json map = validMap();
  map.erase("time");
  map.erase("left");
  map["rate"] = 50;
  map["delimiter"] = "tab";
  map["right"]["matrix"] = {"a", "b", "c", "d", "e", "f", "g", "h", "i"};
  const std::string text =
      "rx\try\trz\ta\tb\tc\td\te\tf\tg\th\ti\n1\t2\t3\t0\t-1\t0\t1\t0\t0\t0\t0\t1\n2\t2\t3\t1\t0\t0\t0\t1\t0\t0\t0\t1";
  const TrackedMotion m = parseCsvMotion(bytesOf(text), "m.csv", mapOf(map));
  EXPECT_EQ(m.rate, 50.0);
  EXPECT_FALSE(m.hand[0].present);
  EXPECT_LT((m.hand[1].orientation[0] * Vec3::UnitX() - Vec3::UnitY()).norm(), 1e-15);
  std::string mirrored = text;
  mirrored.replace(mirrored.rfind('1'), 1, "-1");
  expectFault(ErrorKind::damaged, "m.csv: line 3", {"2", "0.001"}, motionFault(mirrored, map));
}

TEST(CsvMotion, jawsAndPedalsMayBeMissingAlone) {
  json map = validMap();
  map["right"]["jaw"] = "note";
  map["left"]["pedal"] = "qz";
  const TrackedMotion m =
      parseCsvMotion(bytesOf(names + "0.5,1000,10,20,30,1,0,0,0,-1,-2,-3\n,1010,11,20,30,0.8,0.6,0,0,-1,-2,-4\n" +
                             "-0.1,1020,11,20,30,0,0,0,1,-1,-2,-4\n"),
                     "m.csv", mapOf(map));
  ASSERT_EQ(m.hand[1].jaw.size(), 3U);
  EXPECT_EQ(m.hand[1].jaw[0], 0.5);
  EXPECT_TRUE(std::isnan(m.hand[1].jaw[1]));
  EXPECT_EQ(m.hand[1].jaw[2], -0.1);
  EXPECT_FALSE(m.hand[1].isMissing(1));
  EXPECT_EQ(m.hand[0].pedal, (std::vector<bool>{false, false, true}));
  EXPECT_TRUE(m.hand[0].jaw.empty());
  expectFault(ErrorKind::damaged, "m.csv: line 2: column \"note\"", {"\"a\""}, motionFault(names + rowA + rowB, map));
}

TEST(CsvMotion, everyFaultIsNamedWithItsLine) {
  EXPECT_FALSE(motionFault(names + rowA + rowB));
  expectFault(ErrorKind::damaged, "m.csv", {}, motionFault(""));
  expectFault(ErrorKind::damaged, "m.csv", {"0", "2"}, motionFault(names));
  expectFault(ErrorKind::damaged, "m.csv", {"1", "2"}, motionFault(names + rowA));
  expectFault(ErrorKind::damaged, "m.csv: line 1", {"\"ly\"", "t, lx"}, motionFault("t,lx\n1,2\n"));
  expectFault(ErrorKind::damaged, "m.csv: line 1", {"\"t\""},
              motionFault(std::string("t,").append(names).append("1,").append(rowA)));
  expectFault(ErrorKind::damaged, "m.csv: line 3", {"4", "12"}, motionFault(names + rowA + "a,1010,10,20\n"));
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string row = rowB;
    row.replace(row.find(from), from.size(), to);
    return motionFault(names + rowA + row);
  };
  expectFault(ErrorKind::damaged, "m.csv: line 3: column \"t\"", {"\"nan\""}, with("1010", "nan"));
  expectFault(ErrorKind::damaged, "m.csv: line 3: column \"t\"", {"\"1e999\""}, with("1010", "1e999"));
  expectFault(ErrorKind::damaged, "m.csv: line 3: column \"ry\"", {"\"two\""}, with("-2", "two"));
  expectFault(ErrorKind::damaged, "m.csv: line 3", {"5"}, with("-2", "6000"));
  expectFault(ErrorKind::damaged, "m.csv: line 3", {}, with("1010", "1000"));
  expectFault(ErrorKind::damaged, "m.csv: line 3", {"1e+06"}, with("1010", "1e13"));
  expectFault(ErrorKind::damaged, "m.csv: line 3", {"0.608", "1"}, with("0.8", "0.1"));
  expectFault(ErrorKind::damaged, "m.csv: line 3", {}, motionFault(names + rowA + "\n" + rowB));
}

TEST(CsvMotion, whatIsDamagedAtRandomIsRefusedInOneLineOrRead) {
  const unsigned seed = 5;
  SCOPED_TRACE("seed " + std::to_string(seed));
  Random random(seed, 1);
  std::string text = names;
  for (int i = 0; i < 20; ++i) text += fmt::format("n,{},10,20,30,1,0,0,0,-1,-2,-3\n", 1000 + 10 * i);
  const std::string map = validMap().dump();
  std::size_t refused = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    std::string csv = text, columns = map;
    std::string& victim = trial % 4 == 0 ? columns : csv;
    for (std::uint32_t change = 0, changes = 1 + random.next() % 3; change < changes && !victim.empty(); ++change) {
      const std::size_t at = random.next() % victim.size();
      switch (random.next() % 4) {
        case 0:
          victim[at] = static_cast<char>(random.next() % 256);
          break;
        case 1:
          victim.erase(at, random.next() % 30);
          break;
        case 2:
          victim.insert(at, 1, ",\n\r\"-e9"[random.next() % 7]);
          break;
        default:
          victim.resize(at);
      }
    }
    try {
      const TrackedMotion m = parseCsvMotion(bytesOf(csv), "m.csv", parseColumnMap(bytesOf(columns), "m.json"));
      for (std::size_t i = 1; i < m.time.size(); ++i) ASSERT_LT(m.time[i - 1], m.time[i]);
      for (const TrackedHand& hand : m.hand) {
        ASSERT_EQ(hand.position.size(), hand.present ? m.time.size() : 0U);
        for (const Quat& q : hand.orientation) ASSERT_NEAR(q.norm(), 1.0, 1e-9);
      }
    } catch (const Error& e) {
      ++refused;
      expectFault(ErrorKind::damaged,
                  e.where().place.empty() ? e.where().file : e.where().file + ": " + e.where().place, {}, e);
      ASSERT_EQ(e.where().file.substr(0, 2), "m.") << e.what();
    }
  }
  EXPECT_GT(refused, 1000U);
  EXPECT_LT(refused, 4000U);
}

TEST(ColumnMap, everyFaultIsNamedWithItsPlace) {
  const auto with = [](const char* pointer, const json& value) {
    json map = validMap();
    map[json::json_pointer(pointer)] = value;
    return mapFault(map);
  };
  EXPECT_FALSE(mapFault(validMap()));
  expectFault(ErrorKind::damaged, "m.json: /length", {"cm, inch, m, mm"}, with("/length", "millimetres"));
  expectFault(ErrorKind::damaged, "m.json: /time/unit", {"frame, iso, ms, ns, s, time-of-day, us"},
              with("/time/unit", "min"));
  expectFault(ErrorKind::damaged, "m.json: /format", {"\"calot-columns\""}, with("/format", "other"));
  expectFault(ErrorKind::damaged, "m.json: /delimiter", {",, ;, auto, tab"}, with("/delimiter", "|"));
  expectFault(ErrorKind::damaged, "m.json: /left/axis", {"-x, -y, -z, x, y, z"}, with("/left/axis", "w"));
  expectFault(ErrorKind::damaged, "m.json: /frame", {}, with("/frame", "two words"));
  expectFault(ErrorKind::damaged, "m.json: /", {"\"rate\"", "\"time\""}, with("/rate", 30));
  expectFault(ErrorKind::damaged, "m.json: /left/position/1", {}, with("/left/position/1", ""));
  expectFault(ErrorKind::damaged, "m.json: /right/axis", {}, with("/right/axis", "x"));
  expectFault(ErrorKind::damaged, "m.json: /left/position", {"2", "3"}, with("/left/position", {"lx", "ly"}));
  expectFault(ErrorKind::damaged, "m.json: /more", {}, with("/more", 1));
  json map = validMap();
  map.erase("time");
  expectFault(ErrorKind::damaged, "m.json: /", {"\"rate\"", "\"time\""}, mapFault(map));
  map["rate"] = 0.5;
  expectFault(ErrorKind::damaged, "m.json: /rate", {"0.5", "[1, 100000]"}, mapFault(map));
  map = validMap();
  map.erase("left");
  map.erase("right");
  expectFault(ErrorKind::damaged, "m.json: /", {"\"left\"", "\"right\""}, mapFault(map));
  map = validMap();
  map.erase("frame");
  expectFault(ErrorKind::damaged, "m.json: /", {"\"frame\""}, mapFault(map));
}

}  // namespace
}  // namespace calot::recorder::column_map_test
