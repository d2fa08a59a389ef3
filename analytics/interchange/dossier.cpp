// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/interchange/dossier.h"

#include <fmt/format.h>
#include <cstring>
#include <filesystem>
#include <set>

#include "analytics/assessment/grade.h"
#include "analytics/assessment/norm_decision.h"
#include "analytics/cohort/registers.h"
#include "analytics/cohort/tables.h"
#include "analytics/design/design_report.h"
#include "analytics/report/study_output.h"
#include "analytics/report/study_protocol.h"
#include "recorder/base/files.h"
#include "recorder/base/json_reader.h"
#include "recorder/recording/station_key.h"

namespace calot::analytics {
namespace {

template <class Make>
ValueTree treeOrReason(Make make) {
  try {
    return make();
  } catch (const Error& e) {
    return {{"reason", e.fault()}};
  }
}

ValueTree shareTree(const DecisionShare& share) {
  if (!share.share) return {{"reason", share.share.reason()}};
  return {{"count", share.hits}, {"of", share.of}, {"share", share.share->value}, {"interval", share.share->interval}};
}

ValueTree decisionsTree(const Norm& norm, const NormDecisions& d) {
  return {{"name", norm.name},
          {"version", norm.version},
          {"judged_by", norm.judgedBy},
          {"rule", ruleText(norm)},
          {"use", useOf(norm)},
          {"false_pass", shareTree(d.falsePass)},
          {"false_fail", shareTree(d.falseFail)},
          {"agreement", shareTree(d.agreement)},
          {"kappa", d.kappa.optional()},
          {"graded", d.graded},
          {"passed", d.passed},
          {"within_standard_error", d.near}};
}

/// A table that a query gives: its columns' names, aligned to the left after "=", and its rows.
ReportTable queryTable(SQLite::Database& db, const std::string& title, const std::string& sql) {
  std::vector<std::string> names;
  SQLite::Statement query(db, sql);
  names.reserve(static_cast<std::size_t>(query.getColumnCount()));
  for (int c = 0; c < query.getColumnCount(); ++c) names.emplace_back(query.getColumnName(c));
  ReportTable table = tableOf(title, names);
  while (query.executeStep()) {
    std::vector<std::string>& row = table.rows.emplace_back();
    for (int c = 0; c < query.getColumnCount(); ++c) row.push_back(query.getColumn(c).getString());
  }
  return table;
}

/// An item with its state and what was found.
ValueTree answerOf(SQLite::Database& db, const ValueTree& item, const ValueTree& queries) {
  ValueTree found = ValueTree::array(), missing = ValueTree::array();
  for (const auto& name : item.value("queries", ValueTree::array())) {
    const ValueTree& query = queries.at(name.get<std::string>());
    const std::vector<std::string> sentences = firstTexts(db, query.at("sql").get<std::string>());
    for (const std::string& sentence : sentences) found.push_back(sentence);
    if (sentences.empty()) missing.push_back(query.at("missing"));
  }
  if (item.contains("author")) missing.push_back(item["author"]);
  const char* state = !item.contains("queries") ? "author" : found.empty() ? "no" : missing.empty() ? "yes" : "part";
  return {{"item", item.at("item")}, {"asks", item.at("asks")},
          {"state", state},          {"found", found},
          {"missing", missing},      {"caution", found.empty() ? "" : item.value("caution", "")}};
}

std::string textOfAnswer(const ValueTree& item) {
  std::string text;
  for (const ValueTree& sentence : item["found"]) text += sentence.get<std::string>() + " ";
  text += item["caution"].get<std::string>();
  if (!text.empty() && !item["missing"].empty()) text += " Missing: ";
  for (const ValueTree& sentence : item["missing"]) text += sentence.get<std::string>() + " ";
  return text;
}

}  // namespace

ValueTree dossierFacts(const CohortDatabase& database, const StudyOptions& options, const ValueTree& external) {
  const auto design = [&](Design which, const std::string& against = {}) {
    DesignChoices choices;
    static_cast<StudyChoices&>(choices) = options;
    choices.design = which;
    choices.against = against;
    choices.groups.clear();
    if (!entryOf(which).oneEach) choices.attemptRule.reset();
    return treeOrReason([&] { return makeDesignReport(cohortDesignData(database, options, choices), choices).json; });
  };
  const std::vector<AttemptRow> attempts = database.listAttempts();
  const std::vector<AttemptValue> values = database.allValues();
  const std::vector<Rating> ratings = database.ratings();
  ValueTree norms = ValueTree::array(), correlations = ValueTree::array();
  const std::vector<Norm> all = database.norms();  // by name, version
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i + 1 == all.size() || all[i + 1].name != all[i].name)
      norms.push_back(decisionsTree(all[i], decisionsOf(all[i], attempts, values, ratings)));
  }
  std::set<std::string> forms;
  for (const Rating& rating : ratings) {
    if (!rating.attempt.empty() && forms.insert(rating.form).second)
      correlations.push_back({{"form", rating.form}, {"result", design(Design::correlation, "rating " + rating.form)}});
  }
  const ValueTree study = treeOrReason([&] {
    Study made = options.protocol ? makeProtocolStudy(database, options, false) : makeStudy(database, options);
    if (!options.protocol) addRatings(made, database);
    return studyTree(made);
  });
  return {{"include_synthetic", options.includeSynthetic},
          {"include_practice", options.includePractice},
          {"study", study},
          {"reliability", design(Design::reliability)},
          {"learning", design(Design::learning)},
          {"correlations", correlations},
          {"norms", norms},
          {"external", external}};
}

ValueTree readSignedFigures(const std::vector<std::string>& files, const CohortDatabase& database) {
  constexpr std::size_t maxFile = std::size_t{1} << 22U;
  ValueTree all = ValueTree::array();
  const Registers registers = readRegisters(database.path());
  for (const std::string& file : files) {
    const nlohmann::json json = recorder::parseStrictJson(recorder::readFileBytes(file, file, maxFile), file);
    recorder::PublicKey key{};
    recorder::Signature signature{};
    const auto text = [&](const char* name) {
      return json.contains(name) && json[name].is_string() ? json[name].get<std::string>() : std::string();
    };
    const auto bytes = [&](const char* name, auto& out) {
      return recorder::readHex(text(name), std::as_writable_bytes(std::span(out)));
    };
    ValueTree figures = ValueTree::parse(text("text"), nullptr, false);
    if (!bytes("public_key", key) || !bytes("signature", signature) || !figures.is_object() ||
        !recorder::fits(signature, key, recorder::headOfText(text("text"))))
      throw Error(ErrorKind::damaged, Where{file}, "not signed figures, or changed since they were signed");
    PublicKey signer{};
    std::memcpy(signer.data(), key.data(), key.size());
    const KeyStanding standing = standingOf(registers, text("station"), signer);
    if (standing == KeyStanding::another)
      throw Error(ErrorKind::refused, Where{file},
                  fmt::format("is not signed with the key that station \"{}\" has here", text("station")));
    figures["station"] = text("station");
    figures["registered"] = standing == KeyStanding::known;
    all.push_back(std::move(figures));
  }
  return all;
}

Dossier makeDossier(const std::string& path, const ValueTree& questions, const ValueTree& facts) {
  const CohortConnection cohort(path, CohortDatabase::Access::read);
  return cohort.read([&](SQLite::Database& db) {
    execute(db, "CREATE TEMP TABLE facts AS SELECT ? AS json", {facts.dump()});
    for (const auto& view : questions.at("views").items())
      db.exec(fmt::format("CREATE TEMP VIEW {} AS {}", view.key(), view.value().get<std::string>()));
    Dossier dossier;
    ReportDocument& document = dossier.document;
    document.title = fmt::format("{}: {}", questions.at("title").get<std::string>(),
                                 std::filesystem::path(path).filename().string());
    document.synthetic = firstNumber(db, questions.at("synthetic").get<std::string>()) > 0;
    for (const auto& line : questions.at("about")) document.add(line);
    ReportTable counts = tableOf("What this cohort answers", {"=", "yes", "part", "no", "author"});
    std::vector<ReportTable> tables;
    for (const auto& asked : questions.at("sections")) {
      ReportTable& table = tables.emplace_back(
          tableOf(asked.at("title").get<std::string>(), {"=item", "=asks", "=", "=in this cohort"}));
      ValueTree items = ValueTree::array();
      std::map<std::string, int> number;
      for (const auto& item : asked.at("items")) {
        items.push_back(answerOf(db, item, questions.at("queries")));
        const ValueTree& answer = items.back();
        ++number[plain(answer["state"])];
        table.rows.push_back(
            {plain(answer["item"]), plain(answer["asks"]), plain(answer["state"]), textOfAnswer(answer)});
      }
      std::vector<std::string>& row = counts.rows.emplace_back(std::vector<std::string>{table.title});
      for (const char* state : {"yes", "part", "no", "author"}) row.push_back(fmt::format("{}", number[state]));
      dossier.json["sections"].push_back({{"title", table.title}, {"items", items}});
    }
    document.parts.emplace_back(std::move(counts));
    document.add(questions.at("counts_note"));
    for (const auto& asked : questions.at("tables")) {
      ReportTable table = queryTable(db, asked.at("title"), asked.at("sql"));
      if (table.rows.empty()) continue;
      document.parts.emplace_back(std::move(table));
      document.add(asked.at("note"));
    }
    for (std::size_t i = 0; i < tables.size(); ++i) {
      document.parts.emplace_back(std::move(tables[i]));
      if (const auto& note = questions["sections"][i]; note.contains("note")) document.add(note["note"]);
    }
    dossier.json["synthetic"] = document.synthetic;
    dossier.json["about"] = questions.at("about");
    dossier.json["facts"] = facts;
    return dossier;
  });
}

}  // namespace calot::analytics
