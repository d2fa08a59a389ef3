// SPDX-License-Identifier: GPL-3.0-or-later
// What is handed out: who is in it, what is left of what was measured, and that nothing names anyone.
#include "analytics/interchange/cohort_bundle.h"

#include <gtest/gtest.h>
#include <SQLiteCpp/SQLiteCpp.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <span>

#include "analytics/cohort/cohort_database.h"
#include "analytics/cohort/registers.h"
#include "analytics/cohort/withdraw.h"
#include "analytics/interchange/bundle_names.h"
#include "recorder/base/csv.h"
#include "recorder/base/files.h"
#include "tests/analytics/cohort/support/cohort_support.h"
#include "tests/support/fault.h"

namespace calot::analytics {
namespace {

namespace fs = std::filesystem;
using Access = CohortDatabase::Access;
using nlohmann::json;
using support::attemptOf;
using support::Folder;
using support::humanAttempt;
using support::uuidOf;
using support::valuesOf;

std::string bytesOf(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// Seconds since 1970 of "2026-01-01T00:00:00Z".
std::int64_t secondsOf(const std::string& utc) {
  std::tm t{};
  EXPECT_NE(::strptime(utc.c_str(), "%Y-%m-%dT%H:%M:%SZ", &t), nullptr) << utc;
  return ::timegm(&t);
}

/// Six who have consented with two attempts each, and one of each kind that stays out.
class Bundles : public testing::Test {
 protected:
  Bundles() : path_(folder_.file("c.db")), database_(path_, Access::create) {
    for (unsigned n = 0; n < 6; ++n) {
      const std::string who = fmt::format("SITE-{:04}", 7301 + n);
      add(who, n % 2 == 0 ? "expert" : "novice", {{"research", "2025-03-04"}});
      for (unsigned k = 0; k < 2; ++k) attempt(10 * n + k + 1, who, k);
    }
    add("Refuser-1", "expert", {{"teaching", "2025-03-04"}});
    attempt(81, "Refuser-1");
    add("Leaver-2", "novice", {{"research", "2025-03-04"}});
    attempt(82, "Leaver-2");
    add("Silent-3", "novice", {});
    attempt(83, "Silent-3");
    database_.excludeAttempts({uuidOf(11)}, "Mrs Secret fell ill", "Dr Whisper");
    database_.tagAttempts({uuidOf(1)}, "Secret", "Dr Whisper");
    AttemptRecord broken = humanAttempt(84, "SITE-7301");
    broken.verification.verdict = Verdict::diverged;
    database_.storeAttempt(broken, {});
    database_.storeAttempt(attemptOf(85, "skilled"), valuesOf(1, 1));
    withdraw(path_, planWithdrawal(path_, "Leaver-2", WithdrawalScope::all));
    CohortDatabase assessment(path_, Access::write);
    const std::string form = "{}";
    const StoredDocument document{"goals", 1, recorder::sha256Hex(std::as_bytes(std::span(form))), form};
    assessment.storeRating(document, {"goals", 1, uuidOf(1), "Rater-Kay", "", {{"autonomy", 4}}, ""}, false);
    assessment.storeRating(document, {"goals", 1, uuidOf(11), "Rater-Kay", "", {{"autonomy", 2}}, ""}, false);
    assessment.storeRating(document, {"goals", 1, "", "", "SITE-7303", {{"autonomy", 5}}, ""}, false);
    assessment.storeRating(document, {"goals", 1, "", "", "Refuser-1", {{"autonomy", 1}}, ""}, false);
  }

  void add(const std::string& who, const std::string& group, const std::map<std::string, std::string>& consent) {
    database_.addParticipant({who,
                              group,
                              "",
                              "Northtown",
                              {{"laparoscopies", "120"}, {"level", "attending"}, {"school", "of " + who}},
                              consent});
  }

  void attempt(unsigned n, const std::string& who, unsigned day = 0) {
    AttemptRecord a = humanAttempt(n, who);
    a.startUtc = fmt::format("2025-0{}-1{}T0{}:17:31Z", 4 + n % 3, day, 5 + day);
    a.station = "Theatre-West";
    a.calibration = "2025-02-17";
    a.comparabilityKey = "touch-liver/1 device=falcon calibration=2025-02-17 simulation=1 results=1 mode=assessment";
    a.fileName = fmt::format("{}-{}.h5", who, n);
    database_.storeAttempt(a, valuesOf(n, 0.1 * n));
  }

  Bundle write(const std::string& name, const BundleOptions& options = {}) {
    return writeBundle(path_, folder_.file(name), options);
  }
  CsvTable table(const std::string& bundle, const std::string& name) {
    return readCsvTable(folder_.file(bundle) + "/" + name + ".csv");
  }

  Folder folder_;
  std::string path_;
  CohortDatabase database_;
};

TEST_F(Bundles, takeWhoConsentedAndCountTheOthers) {
  const Bundle b = write("out");
  EXPECT_EQ(b.participants, 6U);
  EXPECT_EQ(b.attempts, 11U);
  EXPECT_EQ(b.recruited, 16U);
  EXPECT_EQ(b.smallest, 3U);
  const std::map<std::string, std::uint64_t> left{{"performer", 1}, {"consent", 2}, {"excluded", 1}, {"diverged", 1}};
  EXPECT_EQ(b.leftOut.size(), left.size());
  for (const auto& [reason, attempts] : left) {
    std::uint64_t found = 0;
    for (const FlowRow& row : b.leftOut) found += holdsToken(row.reason, reason) ? row.attempts : 0;
    EXPECT_EQ(found, attempts) << reason;
  }
  EXPECT_EQ(table("out", "participants").rows.size(), 6U);
  EXPECT_EQ(table("out", "attempts").rows.size(), 11U);
  EXPECT_EQ(table("out", "values").rows.size(), 33U);
  EXPECT_EQ(table("out", "ratings").rows.size(), 1U) << "the other rated attempt was excluded";
  EXPECT_EQ(table("out", "questionnaires").rows.size(), 1U) << "the other participant has not consented";
}

TEST_F(Bundles, noByteOfThemNamesAnyone) {
  write("out");
  // Days alone are not searched for: a start may by chance be moved onto one of them (",2025-02-17T05:...").
  std::vector<std::string> originals{
      "SITE-73", "Refuser",  "Leaver",       "Silent",      "Rater",        "Kay",
      "North",   "Theatre",  "West",         "Secret",      "Whisper",      "c.db",
      ".h5",     "18446744", "calibration=", "=2025-02-17", ",2025-02-17,", ",2025-03-04,"};
  for (const AttemptRow& a : database_.listAttempts()) originals.push_back(a.startUtc);
  for (unsigned n = 0; n < 90; ++n) originals.push_back(uuidOf(n));
  std::size_t files = 0, bytes = 0;
  for (const auto& entry : fs::directory_iterator(folder_.file("out"))) {
    ++files;
    const std::string text = entry.path().filename().string() + "\n" + bytesOf(entry.path());
    bytes += text.size();
    for (const std::string& name : originals) {
      // The codebook's own words stand there whoever took part.
      if (entry.path().stem() == "codebook" && (name == "calibration=" || name == ".h5")) continue;
      EXPECT_EQ(text.find(name), std::string::npos) << name << " in " << entry.path();
    }
  }
  EXPECT_EQ(files, 9U);
  EXPECT_GT(bytes, 10000U);
}

TEST_F(Bundles, keepWhatWasMeasuredAndWhatLiesBetweenAttempts) {
  write("out");
  const CsvTable attempts = table("out", "attempts"), values = table("out", "values");
  std::map<std::string, std::string> startOf, personOf;
  for (const CsvRow& row : attempts.rows) {
    startOf[row.cells[attempts.column("attempt")]] = row.cells[attempts.column("start_shifted")];
    personOf[row.cells[attempts.column("attempt")]] = row.cells[attempts.column("participant")];
    EXPECT_EQ(row.cells[attempts.column("comparability_key")], "key 1");
    EXPECT_EQ(row.cells[attempts.column("calibration")], "calibration 1");
  }
  // By its elapsed time each attempt is known again, here: it is n.
  std::map<unsigned, std::string> nameOf;
  for (const CsvRow& row : values.rows) {
    if (row.cells[values.column("checkpoint")] == "elapsed-time")
      nameOf[static_cast<unsigned>(std::stoi(row.cells[values.column("value")]))] = row.cells[values.column("attempt")];
  }
  ASSERT_EQ(nameOf.size(), 11U);
  std::set<std::int64_t> shifts;
  for (unsigned n = 0; n < 6; ++n) {
    const auto original = [&](unsigned number) { return secondsOf(database_.attempt(uuidOf(number))->startUtc); };
    const unsigned first = 10 * n + 1, second = 10 * n + 2;
    if (nameOf.count(first) == 0) continue;
    const std::int64_t shift = secondsOf(startOf[nameOf[first]]) - original(first);
    EXPECT_EQ(secondsOf(startOf[nameOf[second]]) - original(second), shift) << "one shift a participant";
    EXPECT_EQ(personOf[nameOf[first]], personOf[nameOf[second]]);
    EXPECT_GE(std::abs(shift), 30 * 86400);
    EXPECT_LE(std::abs(shift), 365 * 86400);
    shifts.insert(shift);
  }
  EXPECT_EQ(shifts.size(), 5U) << "and each their own";
}

TEST_F(Bundles, haveAManifestOfTheirFiles) {
  const Bundle b = write("out");
  const json manifest = json::parse(bytesOf(folder_.file("out") + "/manifest.json"));
  EXPECT_EQ(manifest.at("watermark"), "");
  EXPECT_NE(manifest.at("recordings").get<std::string>().find("none"), std::string::npos);
  std::set<std::string> listed;
  for (const json& file : manifest.at("files")) {
    const std::string text = bytesOf(folder_.file("out") + "/" + file.at("name").get<std::string>());
    EXPECT_EQ(file.at("sha256"), recorder::sha256Hex(std::as_bytes(std::span(text))));
    EXPECT_EQ(file.at("bytes"), text.size());
    listed.insert(file.at("name").get<std::string>());
  }
  EXPECT_EQ(listed.size() + 1, b.files.size()) << "all but itself";
  // The codebook explains every column of every file.
  const CsvTable codebook = table("out", "codebook");
  std::set<std::pair<std::string, std::string>> explained;
  for (const CsvRow& row : codebook.rows) {
    EXPECT_FALSE(row.cells[codebook.column("title")].empty()) << row.cells[codebook.column("name")];
    explained.emplace(row.cells[codebook.column("table")], row.cells[codebook.column("name")]);
  }
  for (const char* name : {"participants", "experience", "attempts", "values", "ratings", "questionnaires"}) {
    for (const std::string& column : table("out", name).columns)
      EXPECT_EQ(explained.count({name, column}), 1U) << name << "." << column;
  }
}

TEST_F(Bundles, withholdWordsThatFewShareAndDrawNamesAnew) {
  write("out");
  write("again");
  const CsvTable experience = table("out", "experience");
  std::map<std::string, std::set<std::string>> values;
  for (const CsvRow& row : experience.rows) values[row.cells[1]].insert(row.cells[2]);
  EXPECT_EQ(values["laparoscopies"], std::set<std::string>{"120"});
  EXPECT_EQ(values["level"], std::set<std::string>{"attending"});
  EXPECT_EQ(values["school"], std::set<std::string>{"(withheld)"});
  std::set<std::string> names;
  for (const char* bundle : {"out", "again"}) {
    for (const CsvRow& row : table(bundle, "attempts").rows) names.insert(row.cells[0]);
  }
  EXPECT_EQ(names.size(), 22U) << "two bundles cannot be joined by their names";
}

TEST_F(Bundles, areNotedForWithdrawalsAndForSyntheticOnesMarked) {
  BundleOptions all;
  all.includeSynthetic = true;
  AttemptRecord branch = attemptOf(86, "skilled");
  branch.parent = uuidOf(81);
  branch.participant = "Refuser-1";
  database_.storeAttempt(branch, valuesOf(1, 1));
  EXPECT_EQ(write("out", all).attempts, 12U) << "a branch of who has not consented stays out, whoever went on with it";
  EXPECT_EQ(json::parse(bytesOf(folder_.file("out") + "/manifest.json")).at("watermark"), "SYNTHETIC");
  const Withdrawal plan = planWithdrawal(path_, "SITE-7303", WithdrawalScope::all);
  ASSERT_EQ(plan.exports.size(), 1U);
  EXPECT_EQ(plan.exports[0].kind, "bundle");
  withdraw(path_, plan);
  EXPECT_EQ(write("later").participants, 5U);
}

TEST_F(Bundles, areRefusedWhereTheyWouldTell) {
  BundleOptions teaching;
  teaching.scope = "filming";
  expectFault(ErrorKind::refused, "", {"16"}, [&] { write("out", teaching); });
  expectFault(ErrorKind::invalid, "", {"exists"}, [&] { write(""); });
  ParticipantChange change;
  change.arm = "with SITE-7302";
  database_.setParticipant("SITE-7301", change);
  expectFault(ErrorKind::refused, "", {"participants.csv"}, [&] { write("out"); });
  EXPECT_FALSE(fs::exists(folder_.file("out")));
  for (const auto& entry : fs::directory_iterator(fs::path(path_).parent_path()))
    EXPECT_EQ(entry.path().string().find(".part"), std::string::npos) << entry.path();
  EXPECT_TRUE(planWithdrawal(path_, "SITE-7301", WithdrawalScope::all).exports.empty()) << "nothing was handed out";
}

TEST(DateShift, isDrawnEvenly) {
  std::set<std::int64_t> drawn;
  int earlier = 0;
  for (int i = 0; i < 500; ++i) {
    const std::int64_t s = drawShift();
    EXPECT_GE(std::abs(s), 30 * 86400);
    EXPECT_LE(std::abs(s), 365 * 86400);
    earlier += s < 0 ? 1 : 0;
    drawn.insert(s);
  }
  EXPECT_GT(drawn.size(), 480U);
  // 500 fair draws: 6 standard deviations are 67.
  EXPECT_NEAR(earlier, 250, 67);
}

TEST(OriginalNames, areFoundAsCellsAndAsWords) {
  OriginalNames names;
  names.add("P-01", "a pseudonym");
  names.add("OR 3", "a station");
  names.add("2025-02-17", "a calibration");
  names.add("17", "a pseudonym");
  names.add("falcon", "a station");
  const std::set<std::string> vocabulary{"falcon"};
  EXPECT_EQ(names.firstIn("a,P-01,b\n", vocabulary), "a pseudonym");
  EXPECT_EQ(names.firstIn("a,\"see P-01, too\"\n", vocabulary), "a pseudonym");
  EXPECT_EQ(names.firstIn("a,OR 3\n", vocabulary), "a station");
  EXPECT_EQ(names.firstIn("key 2025-02-17 of", vocabulary), "a calibration");
  EXPECT_EQ(names.firstIn("P-011,XP-01,OR,3,17,falcon,2025-02", vocabulary), "");
  EXPECT_EQ(names.firstIn("", vocabulary), "");
  EXPECT_TRUE(names.has("falcon"));
}

}  // namespace
}  // namespace calot::analytics
