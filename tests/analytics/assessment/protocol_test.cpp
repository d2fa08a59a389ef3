// SPDX-License-Identifier: GPL-3.0-or-later
// Reading a protocol: the schema, what comes with the program, and every fault with its place.
#include "analytics/assessment/protocol.h"

#include <gtest/gtest.h>

#include <functional>

#include "tests/analytics/assessment/support/texts.h"
#include "tests/support/fault.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

using nlohmann::json;
using support::bytesOf;

constexpr const char* shipped = "assets/protocols/cholecystectomy-2014-table2.json";

Protocol parsed(const json& document) { return parseProtocol(bytesOf(document.dump()), "p.json"); }

TEST(Protocol, theOneThatComesWithTheProgramIsThePapersTable) {
  const Protocol p = readProtocol(std::string(CALOT_SOURCE_DIR) + "/" + shipped);
  const json table = support::jsonOf("assets/reference/cholecystectomy-2014-table2.json");
  ASSERT_EQ(p.hypotheses.size(), table.at("rows").size());
  for (std::size_t i = 0; i < p.hypotheses.size(); ++i) {
    const json& row = table.at("rows")[i];
    SCOPED_TRACE(row.at("checkpoint"));
    EXPECT_EQ(p.hypotheses[i].checkpoint, row.at("matches"));
    EXPECT_EQ(p.hypotheses[i].subject, row.at("subject"));
    EXPECT_TRUE(p.hypotheses[i].primary);
    // The paper's own means say which group's are larger.
    EXPECT_EQ(p.hypotheses[i].larger, row.at("expert") > row.at("novice") ? "expert" : "novice");
  }
  EXPECT_EQ(p.sha256.size(), 64U);
  EXPECT_EQ(p.populations[0].criteria.at(0).atLeast, 100.0);
}

TEST(Protocol, everyFaultHasItsPlace) {
  const json good = support::jsonOf(shipped);
  const auto fault = [&](const std::string& place, const std::vector<std::string>& values,
                         const std::function<void(json&)>& change) {
    json bad = good;
    change(bad);
    expectFault(ErrorKind::damaged, "p.json: " + place, values, [&] { (void)parsed(bad); });
  };
  EXPECT_EQ(parsed(good).hypotheses.size(), 8U);
  fault("/better", {"expert", "novice"}, [](json& p) { p["better"] = "surgeons"; });
  fault("/hypotheses/2/larger", {}, [](json& p) { p["hypotheses"][2]["larger"] = "x"; });
  fault("/hypotheses/1/checkpoint", {}, [](json& p) { p["hypotheses"][1]["checkpoint"] = "speed"; });
  fault("/hypotheses/8", {}, [](json& p) { p["hypotheses"].push_back(p["hypotheses"][0]); });
  fault("/hypotheses", {}, [](json& p) {
    for (json& h : p["hypotheses"]) h["primary"] = false;
  });
  fault("/hypotheses/0/direction", {}, [](json& p) { p["hypotheses"][0]["direction"] = "up"; });
  fault("/unit", {"\"participant\""}, [](json& p) { p["unit"] = "attempt"; });
  fault("/attemptRule", {"first, mean, single"}, [](json& p) { p["attemptRule"] = "best"; });
  fault("/missing", {}, [](json& p) { p["missing"] = "zero"; });
  fault("/level", {"0", "(0, 0.5]"}, [](json& p) { p["level"] = 0; });
  fault("/name", {}, [](json& p) { p["name"] = "../p"; });
  fault("/populations/1", {}, [](json& p) { p["populations"][1]["group"] = "expert"; });
  fault("/populations/0/criteria/0", {"\"equals\""},
        [](json& p) { p["populations"][0]["criteria"][0]["equals"] = "yes"; });
  fault("/populations/0/criteria/0", {"\"atLeast\""},
        [](json& p) { p["populations"][0]["criteria"][0]["atMost"] = 1; });
  fault("/exclusions/outcomes/0", {}, [](json& p) { p["exclusions"]["outcomes"][0] = "completed"; });
  fault("/", {"\"level\""}, [](json& p) { p.erase("level"); });
  fault("/title", {}, [](json& p) { p["title"] = "a\nb"; });
  expectFault(ErrorKind::damaged, "p.json", {"JSON", "1"},
              [] { (void)parseProtocol(bytesOf("{\"format\": "), "p.json"); });
}

TEST(Protocol, populationsAreCriteriaAndNotLabels) {
  Population p{"expert", "", {{"operations", 100.0, 500.0, ""}, {"level", {}, {}, "attending"}}};
  const std::map<std::string, std::string> good{{"operations", "100"}, {"level", "attending"}};
  EXPECT_EQ(whyOutside(p, good), "");
  const auto with = [&](const char* key, const char* value) {
    auto e = good;
    e[key] = value;
    return whyOutside(p, e);
  };
  expectNames(with("operations", "99"), {"operations 99", "100"});
  expectNames(with("operations", "501"), {"operations 501", "500"});
  expectNames(with("operations", "many"), {"operations"});
  expectNames(with("level", "resident"), {"level resident", "attending"});
  expectNames(whyOutside(p, {{"level", "attending"}}), {"operations"});
  expectDistinct({with("operations", "many"), whyOutside(p, {{"level", "attending"}})});
}

TEST(Protocol, changesAreNamed) {
  const json before = support::jsonOf(shipped);
  json after = before;
  after["version"] = 2;
  ASSERT_EQ(changedPlaces(before.dump(), after.dump(4)).size(), 1U);
  expectNames(changedPlaces(before.dump(), after.dump(4))[0], {"layout"});
  after["hypotheses"][3]["primary"] = false;
  after["level"] = 0.01;
  EXPECT_EQ(changedPlaces(before.dump(), after.dump()), (std::vector<std::string>{"/hypotheses/3/primary", "/level"}));
}

}  // namespace
}  // namespace calot::analytics
