// SPDX-License-Identifier: GPL-3.0-or-later
// calot rate: what people judge, by forms.
#include <fmt/format.h>

#include <iostream>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "analytics/assessment/rating_form.h"
#include "analytics/cohort/assessment_database.h"
#include "analytics/report/rating_tables.h"
#include "apps/calot/cohort_option.h"
#include "apps/calot/commands.h"
#include "apps/calot/environment.h"
#include "apps/calot/rate_files.h"
#include "apps/calot/results.h"
#include "apps/calot/terminal_text.h"
#include "apps/common/exit_code.h"
#include "recorder/base/errors.h"
#include "recorder/base/file_bytes.h"
#include "recorder/base/json_reader.h"
#include "recorder/base/text_words.h"

namespace calot::apps {
namespace {

using Access = analytics::CohortDatabase::Access;
using Json = nlohmann::ordered_json;
using Given = std::vector<std::pair<std::string, std::string>>;

struct RateOptions {
  std::string database, form, attempt, rater, participant, answersFile, manifest, taken;
  std::vector<std::string> answers;
  bool forms = false, json = false, force = false;
};

[[noreturn]] void fail(const std::string& what) { throw Error(ErrorKind::invalid, "rate: " + what); }

int listForms(const RateOptions& o) {
  Json rows = Json::array();
  for (const std::filesystem::path& file : listAssets("forms")) {
    const analytics::RatingForm form = analytics::readRatingForm(file);
    if (!o.json) {
      const std::string text = fmt::format("{} version {}: {} ({}, {} to {})", form.name, form.version, form.title,
                                           form.ofAttempts ? "of attempts" : "of the simulator", form.least, form.most);
      std::cout << wrappedText(text, terminalColumns(), 4) << '\n';
    }
    Json items = Json::array();
    for (const analytics::FormItem& item : form.items()) {
      items.push_back({{"item", item.key}, {"text", item.text}});
      if (!o.json) std::cout << fmt::format("  {}  {}\n", item.key, item.text);
    }
    rows.push_back({{"form", form.name},
                    {"version", form.version},
                    {"title", form.title},
                    {"source", form.source},
                    {"about", form.ofAttempts ? "attempt" : "simulator"},
                    {"least", form.least},
                    {"most", form.most},
                    {"items", items}});
  }
  if (o.json) printResult("forms", {{"forms", rows}});
  return static_cast<int>(ExitCode::yes);
}

/// A JSON object of items and scores; null where an item was left blank.
Given readAnswers(const std::string& file) {
  const std::filesystem::path path(file);
  const std::string name = path.filename().string();
  const nlohmann::json json =
      recorder::parseStrictJson(recorder::readFileBytes(path, name, std::size_t{1} << 20U), name);
  if (!json.is_object()) throw Error(ErrorKind::damaged, Where{name}, "/: an object of items and scores is wanted");
  Given given;
  for (const auto& item : json.items()) {
    if (!item.value().is_null() && !item.value().is_number_integer())
      throw Error(ErrorKind::damaged, Where{name}, "an item's score is a whole number, or null");
    given.emplace_back(item.key(), item.value().is_null() ? "-" : item.value().dump());
  }
  return given;
}

Given readAnswers(const std::vector<std::string>& items) {
  Given given;
  for (const std::string& item : items) {
    const std::size_t at = item.find('=');
    if (at == std::string::npos || at == 0 || at + 1 == item.size())
      fail(fmt::format("--answer {}: ITEM=SCORE is wanted", recorder::shown(item)));
    given.emplace_back(item.substr(0, at), item.substr(at + 1));
  }
  return given;
}

int store(const RateOptions& o) {
  const analytics::RatingForm form = analytics::readRatingForm(findAsset(o.form, "forms", "form"));
  if (form.ofAttempts && (o.attempt.empty() || o.rater.empty() || !o.participant.empty()))
    fail(fmt::format("form {} is about an attempt: name --attempt and --rater", form.name));
  if (!form.ofAttempts && (o.participant.empty() || !o.attempt.empty() || !o.rater.empty()))
    fail(fmt::format("form {} is filled in by a participant: name --participant alone", form.name));
  if (o.answersFile.empty() == o.answers.empty()) fail("give the answers by --answer or by --answers");
  analytics::Rating rating;
  rating.attempt = o.attempt;
  rating.rater = o.rater;
  rating.participant = o.participant;
  rating.answers =
      analytics::answersOf(form, o.answersFile.empty() ? readAnswers(o.answers) : readAnswers(o.answersFile));
  analytics::AssessmentDatabase database(o.database, Access::write);
  database.storeRating({form.name, form.version, form.sha256, form.text}, rating, o.force);
  std::cout << fmt::format("{}: {} version {} of {}, {} of {} items answered\n", o.database, form.name, form.version,
                           form.ofAttempts ? "attempt " + o.attempt : "participant " + o.participant,
                           rating.answers.size(), form.items().size());
  return static_cast<int>(ExitCode::yes);
}

int show(const RateOptions& o) {
  const analytics::CohortDatabase cohort(o.database, Access::read);
  const analytics::AssessmentDatabase database(o.database, Access::read);
  std::map<std::string, std::string> groupOf;
  std::set<std::string> groups;
  for (const analytics::Participant& p : cohort.participants()) groupOf[p.pseudonym] = p.group;
  std::map<std::string, analytics::AttemptOf> attemptOf;
  for (const analytics::AttemptRow& a : cohort.listAttempts()) {
    groupOf[a.uuid] = a.group;
    attemptOf[a.uuid] = {a.participant, a.startUtc};
  }
  for (const analytics::Rating& r : database.ratings()) {
    const auto at = groupOf.find(r.attempt.empty() ? r.participant : r.attempt);
    if (at != groupOf.end()) groups.insert(at->second);
  }
  const std::vector<analytics::FormReport> reports =
      analytics::reportForms(database, groupOf, {groups.begin(), groups.end()}, attemptOf);
  if (o.json) {
    printResult("ratings", {{"forms", analytics::ratingsTree(reports)}});
    return static_cast<int>(ExitCode::yes);
  }
  if (reports.empty()) std::cout << "no ratings\n";
  for (const analytics::FormReport& report : reports) {
    for (const analytics::ReportTable& table : analytics::ratingTables(report)) analytics::printTable(table, std::cout);
    for (const std::string& note : analytics::ratingNotes(report)) analytics::printWrapped(note, std::cout);
    if (report.filled > 0) std::cout << '\n';
  }
  return static_cast<int>(ExitCode::yes);
}

}  // namespace

void addRate(CLI::App& app, Run& run) {
  const auto o = std::make_shared<RateOptions>();
  CLI::App* command = app.add_subcommand("rate", "Store and summarise what raters and participants judge, by forms");
  addCohortOption(*command, o->database);
  command->add_flag("--forms", o->forms, "List the forms that come with the program");
  command->add_option("--form", o->form, "The form that was filled in: its name (calot rate --forms), or a JSON file");
  command->add_option("--attempt", o->attempt, "Uuid of the attempt that was rated");
  command->add_option("--rater", o->rater, "Pseudonym of who rated it");
  command->add_option("--participant", o->participant, "Pseudonym of the participant who filled in a questionnaire");
  command
      ->add_option("--answer", o->answers,
                   "ITEM=SCORE for each item, - where it was left blank: A=4,B=- or one option each")
      ->delimiter(',')
      ->allow_extra_args(false);
  command->add_option("--answers", o->answersFile, "The same as a JSON object of items and scores, null for blank");
  command->add_option("--manifest", o->manifest,
                      "A CSV table of completed forms: attempt, file or participant, rater, and one column an item");
  command->add_option("--take", o->taken, "The answers to a pack as the rater's page saved them");
  command->add_flag("--force", o->force, "Replace what the same rater or participant has given before");
  command->add_flag("--json", o->json, "Print JSON");
  const CLI::App* pack = addRatePack(*command, run);
  command->callback([o, pack, &run] {
    if (pack->parsed()) return;
    run = [o] {
      if (o->forms) return listForms(*o);
      if (o->database.empty()) fail("name a cohort database, or ask for --forms");
      const bool one = !(o->attempt + o->rater + o->participant + o->answersFile).empty() || !o->answers.empty();
      if (!o->manifest.empty() || !o->taken.empty()) {
        if (one || (!o->manifest.empty() && !o->taken.empty()) || (!o->taken.empty() && !o->form.empty()))
          fail("--manifest and --take say themselves what was rated, by whom and how");
        return o->manifest.empty() ? takePackAnswers(o->database, o->taken, o->force)
                                   : storeRatingManifest(o->database, o->manifest, o->form, o->force, o->json);
      }
      if (!o->form.empty()) return store(*o);
      if (one) fail("name the form that was filled in with --form");
      return show(*o);
    };
  });
}

}  // namespace calot::apps
