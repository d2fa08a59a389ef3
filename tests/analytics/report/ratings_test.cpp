// SPDX-License-Identifier: GPL-3.0-or-later
// Forms: the schema, what comes with the program, answers, storing them, and what they say.
#include "analytics/report/ratings.h"

#include <gtest/gtest.h>

#include "analytics/report/plots.h"
#include "tests/analytics/assessment/support/texts.h"
#include "tests/analytics/cohort/support/cohort_support.h"
#include "tests/support/fault.h"
#include "tests/support/message.h"

namespace calot::analytics::ratings_test {
namespace {

using Access = CohortDatabase::Access;
using nlohmann::json;
using support::bytesOf;
using support::Folder;
using support::humanAttempt;
using support::uuidOf;

RatingForm shipped(const std::string& name) {
  return readRatingForm(std::string(CALOT_SOURCE_DIR) + "/assets/forms/" + name + ".json");
}

StoredDocument stored(const RatingForm& form) { return {form.name, form.version, form.sha256, form.text}; }

TEST(RatingForm, theQuestionnaireIsThePapersTable) {
  const RatingForm form = shipped("questionnaire-2014");
  const json table = support::jsonOf("assets/reference/cholecystectomy-2014-table3.json");
  ASSERT_EQ(form.sections.size(), table.at("sections").size());
  for (std::size_t s = 0; s < form.sections.size(); ++s) {
    const json& section = table.at("sections")[s];
    EXPECT_EQ(form.sections[s].name, section.at("name"));
    ASSERT_EQ(form.sections[s].items.size(), section.at("items").size());
    for (std::size_t i = 0; i < form.sections[s].items.size(); ++i) {
      const FormItem& item = form.sections[s].items[i];
      EXPECT_EQ(item.text, section.at("items")[i].at("item"));
      EXPECT_EQ(item.published.at("expert"), section.at("items")[i].at("expert"));
      EXPECT_EQ(item.published.at("novice"), section.at("items")[i].at("novice"));
      EXPECT_EQ(item.primaryGroup, item.text.find("ealism") == std::string::npos ? "" : "expert");
    }
  }
  EXPECT_EQ(form.words.back(), "very good");
  EXPECT_EQ(shipped("goals").items().size(), 5U);
  EXPECT_EQ(shipped("osats").items().size(), 7U);
  EXPECT_TRUE(shipped("osats").items()[0].anchors.empty()) << "the site supplies the wording";
  EXPECT_EQ(shipped("competence").items().at(0).key, "competent");
}

TEST(RatingForm, everyFaultHasItsPlace) {
  const json good = support::jsonOf("assets/forms/goals.json");
  const auto fault = [&](const std::string& place, const std::vector<std::string>& values, auto change) {
    json bad = good;
    change(bad);
    expectFault(ErrorKind::damaged, "f.json: " + place, values,
                [&] { (void)parseRatingForm(bytesOf(bad.dump()), "f.json"); });
  };
  fault("/sections/0/items/1", {}, [](json& f) { f["sections"][0]["items"][1]["key"] = "depth-perception"; });
  fault("/sections/0/items/0/anchors", {"2", "5"}, [](json& f) {
    f["sections"][0]["items"][0]["anchors"] = {"bad", "good"};
  });
  fault("/scale", {"\"least\""}, [](json& f) { f["scale"] = {{"least", 1}, {"most", 1}}; });
  fault("/about", {"attempt, simulator"}, [](json& f) { f["about"] = "rater"; });
  fault("/sections", {"0"}, [](json& f) { f["sections"] = json::array(); });
}

TEST(RatingForm, answersAreCheckedAgainstTheForm) {
  const RatingForm form = shipped("competence");
  EXPECT_EQ(answersOf(form, {{"competent", "1"}}).at("competent"), 1);
  const auto fault = [&](const std::vector<std::string>& values,
                         const std::vector<std::pair<std::string, std::string>>& given) {
    expectFault(ErrorKind::invalid, "", values, [&] { (void)answersOf(form, given); });
  };
  fault({"able", "competent"}, {{"able", "1"}});
  fault({"\"2\"", "0", "1"}, {{"competent", "2"}});
  fault({"\"0.5\"", "0", "1"}, {{"competent", "0.5"}});
  fault({"0", "1"}, {{"competent", "\n"}});
  fault({"competent", "twice"}, {{"competent", "1"}, {"competent", "0"}});
  fault({"competent", "blank"}, {});
  fault({form.name}, {{"competent", "-"}});
}

TEST(Ratings, areStoredOnceAndReplacedWhenAsked) {
  const Folder folder;
  const std::string path = folder.file("c.db");
  CohortDatabase cohort(path, Access::create);
  cohort.storeAttempt(humanAttempt(1, "P1"), {});
  CohortDatabase database(path, Access::write);
  RatingForm form = shipped("competence");
  Rating rating{"", 1, uuidOf(1), "R1", "", {{"competent", 0}}, ""};
  database.storeRating(stored(form), rating, false);
  expectFault(ErrorKind::refused, "", {"competence"}, [&] { database.storeRating(stored(form), rating, false); },
              {Remedy::replaceExisting});
  rating.answers["competent"] = 1;
  database.storeRating(stored(form), rating, true);
  ASSERT_EQ(database.ratings().size(), 1U);
  EXPECT_EQ(database.ratings()[0].answers.at("competent"), 1);
  rating.attempt = uuidOf(2);
  expectFault(ErrorKind::refused, path, {uuidOf(2)}, [&] { database.storeRating(stored(form), rating, false); });
  rating.attempt = uuidOf(1);
  rating.rater.clear();
  expectFault(ErrorKind::invalid, "", {"pseudonym"}, [&] { database.storeRating(stored(form), rating, false); });
  rating.rater = "R2";
  form.sha256[0] = form.sha256[0] == '0' ? '1' : '0';
  expectFault(ErrorKind::refused, "", {"competence", "wording"},
              [&] { database.storeRating(stored(form), rating, false); });
}

TEST(Ratings, areTakenBackAndBothIsAudited) {
  const Folder folder;
  const std::string path = folder.file("c.db");
  CohortDatabase database(path, Access::create);
  database.storeAttempt(humanAttempt(1, "P1"), {});
  Rating rating{"competence", 1, uuidOf(1), "R1", "", {{"competent", 0}}, "", 0.85};
  expectFault(ErrorKind::refused, path, {uuidOf(1), "competence", "R1"}, [&] { database.removeRating(rating); });
  const RatingForm form = shipped("competence");
  rating.formVersion = form.version;
  database.storeRating(stored(form), rating, false);
  Rating other = rating;
  other.rater = "R2";
  database.storeRating(stored(form), other, false);
  database.removeRating(rating);
  ASSERT_EQ(database.ratings().size(), 1U);
  EXPECT_EQ(database.ratings()[0].rater, "R2") << "of the other rater nothing is taken";
  expectFault(ErrorKind::refused, path, {"R1"}, [&] { database.removeRating(rating); });
  SQLite::Database raw(path);
  EXPECT_EQ(raw.execAndGet("SELECT count(*) FROM audit WHERE action = 'rating-remove'").getInt(), 1);
  SQLite::Statement seen(raw, "SELECT detail FROM audit WHERE action = 'rating' AND detail LIKE '%R1%'");
  ASSERT_TRUE(seen.executeStep());
  expectHolds(seen.getColumn(0).getString(), {"85"});
  database.storeRating(stored(form), rating, false);
  EXPECT_EQ(database.ratings().size(), 2U) << "and stored again";
}

TEST(Ratings, agreementIsThatOfShroutAndFleiss) {
  // Six attempts and four raters: Shrout and Fleiss (1979), table 2; ICC(2,1) .2897637795 [.0187865, .7610844].
  constexpr int scores[6][4] = {{9, 2, 5, 8}, {6, 1, 3, 2}, {8, 4, 6, 8}, {7, 1, 2, 6}, {10, 5, 6, 9}, {6, 2, 4, 7}};
  json text = support::jsonOf("assets/forms/competence.json");
  text["scale"] = {{"least", 1}, {"most", 10}};
  const RatingForm form = parseRatingForm(bytesOf(text.dump()), "f.json");
  std::vector<Rating> ratings;
  std::map<std::string, std::string> groupOf;
  for (unsigned a = 0; a < 6; ++a) {
    groupOf[uuidOf(a)] = a < 3 ? "expert" : "novice";
    for (unsigned r = 0; r < 4; ++r)
      ratings.push_back({form.name, 1, uuidOf(a), fmt::format("R{}", r), "", {{"competent", scores[a][r]}}, ""});
  }
  // A seventh attempt that one rater alone saw is no part of the agreement; an eighth is of nobody in the study.
  groupOf[uuidOf(7)] = "novice";
  ratings.push_back({form.name, 1, uuidOf(7), "R0", "", {{"competent", 3}}, ""});
  ratings.push_back({form.name, 1, uuidOf(8), "R0", "", {{"competent", 3}}, ""});
  const FormReport report = reportForm(form, ratings, groupOf, {"expert", "novice"});
  EXPECT_EQ(report.filled, 25U);
  EXPECT_EQ(report.leftOut, 1U);
  EXPECT_EQ(report.incomplete, 1U);
  ASSERT_EQ(report.agreement.size(), 1U);
  const Agreement& a = report.agreement[0];
  EXPECT_EQ(a.attempts, 6U);
  EXPECT_NEAR(a.single->value, 0.2897637795, 1e-9);
  EXPECT_NEAR(a.single->interval->lower, 0.0187865, 1e-6);
  EXPECT_NEAR(a.single->interval->upper, 0.7610844, 1e-6);
  // Means over the raters: 6, 3, 6.5.
  EXPECT_EQ(report.items[0].groups[0].n, 3U);
  EXPECT_DOUBLE_EQ(*report.items[0].groups[0].median, 6.0);
  EXPECT_EQ(report.items[0].groups[1].n, 4U);
}

/// A participant's later attempts are no further subjects: the agreement is that of the first ones.
TEST(Ratings, agreementIsOverOneAttemptOfEachParticipant) {
  constexpr int scores[6][4] = {{9, 2, 5, 8}, {6, 1, 3, 2}, {8, 4, 6, 8}, {7, 1, 2, 6}, {10, 5, 6, 9}, {6, 2, 4, 7}};
  json text = support::jsonOf("assets/forms/competence.json");
  text["scale"] = {{"least", 1}, {"most", 10}};
  const RatingForm form = parseRatingForm(bytesOf(text.dump()), "f.json");
  std::vector<Rating> ratings;
  std::map<std::string, std::string> groupOf;
  std::map<std::string, AttemptOf> attemptOf;
  for (unsigned a = 0; a < 12; ++a) {
    // The second attempts have the lower uuids, and started later.
    const unsigned person = a % 6, uuid = a < 6 ? 20 + a : a - 6;
    groupOf[uuidOf(uuid)] = person < 3 ? "expert" : "novice";
    attemptOf[uuidOf(uuid)] = {fmt::format("P{}", person), a < 6 ? "2026-01-01T00:00:00Z" : "2026-01-02T00:00:00Z"};
    for (unsigned r = 0; r < 4; ++r)
      ratings.push_back({form.name,
                         1,
                         uuidOf(uuid),
                         fmt::format("R{}", r),
                         "",
                         {{"competent", a < 6 ? scores[person][r] : static_cast<int>(1 + (a * r) % 9)}},
                         ""});
  }
  const FormReport report = reportForm(form, ratings, groupOf, {"expert", "novice"}, attemptOf);
  EXPECT_EQ(report.repeated, 6U);
  EXPECT_EQ(report.incomplete, 0U);
  EXPECT_EQ(report.agreement[0].attempts, 6U);
  EXPECT_NEAR(report.agreement[0].single->value, 0.2897637795, 1e-9) << "Shrout and Fleiss (1979), table 2";
  EXPECT_EQ(report.items[0].groups[0].n, 3U) << "one value a participant";
  const FormReport apart = reportForm(form, ratings, groupOf, {"expert", "novice"});
  EXPECT_EQ(apart.agreement[0].attempts, 12U);
  EXPECT_EQ(apart.items[0].groups[0].n, 6U);
}

/// Sums worked out by hand: respect, time and handling of 2, 3, 4 are 9; a blank leaves out the sums that it is in.
TEST(Ratings, sumsOfSubscalesAreOfFormsThatHaveAllOfTheirItems) {
  const RatingForm form = shipped("osats");
  ASSERT_EQ(form.subscales.size(), 2U);
  const std::map<std::string, int> whole{{"respect-for-tissue", 2},    {"time-and-motion", 3},
                                         {"instrument-handling", 4},   {"knowledge-of-instruments", 5},
                                         {"use-of-assistants", 1},     {"flow-of-operation", 2},
                                         {"knowledge-of-procedure", 3}};
  std::map<std::string, int> other = whole;
  other["time-and-motion"] = 5;
  std::map<std::string, int> blank = whole;
  blank.erase("flow-of-operation");
  const std::string a = uuidOf(1), b = uuidOf(2);
  // Two raters of one attempt, whose mean counts, and one of the other, who left an item blank.
  const std::vector<Rating> ratings{{form.name, form.version, a, "R1", "", whole, ""},
                                    {form.name, form.version, a, "R2", "", other, ""},
                                    {form.name, form.version, b, "R1", "", blank, ""}};
  const FormReport report = reportForm(form, ratings, {{a, "expert"}, {b, "novice"}}, {"expert", "novice"},
                                       {{a, {"P1", "2026-01-01T00:00:00Z"}}, {b, {"P2", "2026-01-01T00:00:00Z"}}});
  ASSERT_EQ(report.scales.size(), 3U) << "the subscales, then all items";
  const std::vector<std::optional<double>> experts{10.0, 11.0, 21.0}, novices{9.0, std::nullopt, std::nullopt};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(report.scales[i].groups[0].median, experts[i]) << report.scales[i].name;
    EXPECT_EQ(report.scales[i].groups[1].median, novices[i]) << report.scales[i].name;
  }
  EXPECT_EQ(report.scales[2].items, 7U);
  EXPECT_EQ(report.scales[1].groups[1].blank, 1U);
}

TEST(Ratings, questionnairesKeepBlanksAndCountAnswers) {
  const RatingForm form = shipped("questionnaire-2014");
  std::vector<Rating> ratings;
  std::map<std::string, std::string> groupOf;
  for (int p = 0; p < 4; ++p) {
    Rating r{form.name, 1, "", "", fmt::format("P{}", p), {}, ""};
    for (const FormItem& item : form.items()) r.answers[item.key] = 2 + (p + static_cast<int>(item.key.size())) % 4;
    if (p == 0) r.answers.erase("ease-use");
    groupOf[r.participant] = "expert";
    ratings.push_back(r);
  }
  const FormReport report = reportForm(form, ratings, groupOf, {"expert", "novice"});
  for (const ItemReport& item : report.items) {
    const bool blank = item.key == "ease-use";
    EXPECT_EQ(item.groups[0].n, blank ? 3U : 4U) << item.key;
    EXPECT_EQ(item.groups[0].blank, blank ? 1U : 0U);
    EXPECT_EQ(item.groups[1].n, 0U);
    std::uint64_t counted = 0;
    for (const auto& [score, count] : item.groups[0].counts) counted += count;
    EXPECT_EQ(counted, item.groups[0].n);
  }
  EXPECT_EQ(report.sections.size(), 2U) << "subscales of three items or more";
  EXPECT_TRUE(report.agreement.empty());
}

TEST(Ratings, barsAreAsWideAsTheSharesOfTheScores) {
  FormReport report;
  report.title = "A <form>";
  report.filled = 7;
  report.least = 1;
  report.most = 5;
  report.groups = {"expert", "novice"};
  ItemReport item{"ease", "Easy to use", "", {}, {}};
  item.groups.resize(2);
  item.groups[0].counts = {{1, 1}, {3, 1}, {5, 2}};
  report.items.assign(14, item);
  const std::vector<Drawing> drawings = drawScores(report, true);
  ASSERT_EQ(drawings.size(), 2U) << "thirteen items a page";
  EXPECT_EQ(drawings[0].title, "A <form> ( 1), 1 of 2");
  std::vector<std::pair<Ink, DrawnBox>> boxes;
  std::size_t none = 0;
  for (const Shape& shape : drawings[1].shapes) {
    if (const auto* box = std::get_if<DrawnBox>(&shape.form)) boxes.emplace_back(shape.ink, *box);
    if (const auto* text = std::get_if<DrawnText>(&shape.form)) none += text->text == "no answers" ? 1 : 0;
    EXPECT_EQ(shape.ink == Ink::watermark, &shape == &drawings[1].shapes.back());
  }
  EXPECT_EQ(none, 1U) << "nobody of the novices answered";
  ASSERT_EQ(boxes.size(), 3U + 5U) << "the scores given, and the legend of all";
  const double whole = boxes[0].second.width + boxes[1].second.width + boxes[2].second.width;
  EXPECT_DOUBLE_EQ(boxes[0].second.width, whole / 4);
  EXPECT_DOUBLE_EQ(boxes[2].second.width, whole / 2);
  EXPECT_DOUBLE_EQ(boxes[1].second.x, boxes[0].second.x + whole / 4);
  EXPECT_EQ(boxes[0].first, Ink::low3);
  EXPECT_EQ(boxes[1].first, Ink::middle);
  EXPECT_EQ(boxes[2].first, Ink::high3);
  EXPECT_EQ(boxes[4].first, Ink::low2) << "half way below the middle";
  for (const Shape& shape : drawings[0].shapes) {
    if (const auto* box = std::get_if<DrawnBox>(&shape.form)) {
      EXPECT_GE(box->y, 0.0);
      EXPECT_LE(box->y + box->height, drawings[0].height);
      EXPECT_LE(box->x + box->width, drawings[0].width);
    }
  }
  report.filled = 0;
  EXPECT_TRUE(drawScores(report, false).empty());
}

}  // namespace
}  // namespace calot::analytics::ratings_test
