// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/interchange/cohort_bundle.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <tuple>
#include <utility>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/cohort/cohort_database.h"
#include "analytics/cohort/registers.h"
#include "analytics/cohort/tables.h"
#include "analytics/cohort/withdraw.h"
#include "analytics/interchange/bundle_names.h"
#include "analytics/interchange/export_tables.h"
#include "recorder/base/csv.h"
#include "recorder/base/dates.h"
#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"
#include "recorder/loop.h"

namespace calot::analytics {
namespace {

constexpr std::uint64_t fewest = 3;  ///< minimum number of participants who share an item of experience

/// A column that stands in the database under this or another name.
/// @param words what is written instead of numbers; null: the number itself
DeclaredColumn asIn(const char* table, const char* column, const char* name, const char* words = nullptr) {
  DeclaredColumn c = *findColumn(table, column);
  c.name = name;
  c.member = {};
  if (words != nullptr) {
    c.type = "TEXT";
    c.allowed = words;
  }
  return c;
}

DeclaredColumn asIn(const char* table, const char* column) { return asIn(table, column, column); }

/// Files of a bundle and their columns. Nothing is handed out that is not named here.
const DeclaredTable& bundleFile(std::string_view name) {
  constexpr const char* text = "TEXT";
  const DeclaredColumn whose{"participant", text, "pseudonym in participants"};
  const DeclaredColumn attempt{"attempt", text, "attempt in attempts"}, form{"form", text, "form and its version"};
  static const std::vector<DeclaredTable> files{
      {"participants",
       {{"participant", text, "new pseudonym, drawn for this bundle"},
        asIn("participant", "study_group", "group"),
        asIn("participant", "arm"),
        {"site", text, "site, a number without meaning", {}, "", "", "empty"}}},
      {"experience",
       {whose,
        asIn("participant_experience", "criterion"),
        {"value",
         text,
         "the answer; a word that fewer than three participants share is withheld",
         {},
         "",
         "",
         "(withheld)"}}},
      {"attempts",
       {{"attempt", text, "new name, drawn for this bundle"},
        {"participant", text, "pseudonym in participants", {}, "", "", "empty: a performer's attempt"},
        {"parent", text, "attempt that it branches from", {}, "", "", "empty: none, or not in the bundle"},
        {"start_shifted",
         text,
         "start, moved by one random length of time a participant: what lies between a participant's attempts is true, "
         "days are not",
         {},
         "",
         "ISO 8601 UTC with Z",
         "empty"},
        asIn("attempt", "scene"),
        asIn("attempt", "scene_major", "scene_version"),
        asIn("attempt", "operator_kind", "operator", "human, kinematics, performer"),
        asIn("attempt", "profile"),
        asIn("attempt", "mode", "mode", "practice, assessment"),
        asIn("attempt", "outcome", "outcome", "running, completed, time limit, abandoned, stopped, technical failure"),
        asIn("attempt", "device"),
        {"calibration", text, "calibration, a number without meaning", {}, "", "", "empty"},
        asIn("attempt", "simulation_version"),
        {"comparability_key", text, "attempts are compared within one key only; a number without meaning"},
        asIn("recording", "steps"),
        asIn("recording", "step_seconds"),
        asIn("verification", "verdict", "verdict", "verified, not checkable here, not checked"),
        asIn("attempt", "synthetic"),
        {"analysed", "INTEGER", "studies take it: the analysis set", {}, "", "0 no, 1 yes"}}},
      {"values",
       {attempt, asIn("checkpoint_value", "name", "checkpoint"), asIn("checkpoint_value", "subject"),
        asIn("checkpoint_value", "version"), asIn("checkpoint_value", "availability"),
        asIn("checkpoint_value", "value"), asIn("checkpoint_value", "reason"), asIn("checkpoint_value", "unit"),
        asIn("checkpoint_value", "origin", "origin", "re-simulated, observables, samples, external"),
        asIn("checkpoint_value", "filter"), asIn("checkpoint_value", "coverage"), asIn("checkpoint_value", "rate"),
        asIn("checkpoint_value", "noise")}},
      {"ratings",
       {form,
        attempt,
        {"rater", text, "new pseudonym of the rater, drawn for this bundle"},
        asIn("rating", "item"),
        asIn("rating", "score")}},
      {"questionnaires", {form, whose, asIn("questionnaire", "item"), asIn("questionnaire", "score")}}};
  return *std::find_if(files.begin(), files.end(), [&](const DeclaredTable& file) { return file.name == name; });
}

/// All data for the bundle, read from the database.
struct BundleSource {
  std::vector<AttemptRow> attempts;
  std::map<std::string, Participant> participants;
  std::map<std::string, std::vector<CheckpointValue>> values;
  std::vector<Rating> ratings;
  Registers registers;
  std::vector<ExternalMetric> metrics;  ///< of external values
};

BundleSource readBundleSource(const std::string& path) {
  const CohortDatabase cohort(path, CohortDatabase::Access::read);
  BundleSource source;
  source.attempts = cohort.listAttempts();
  for (Participant& p : cohort.participants()) source.participants.emplace(p.pseudonym, std::move(p));
  for (AttemptValue& v : cohort.allValues()) source.values[v.attempt].push_back(std::move(v.value));
  source.metrics = cohort.externalMetrics();
  source.ratings = cohort.ratings();
  source.registers = readRegisters(path);
  return source;
}

/// Reasons for which attempts are withheld, in the order in which they are asked.
constexpr std::array bundleReasons{"made by a performer",     "without participant", "withdrawn from research",
                                   "no consent to the scope", "excluded by hand",    "recording diverged or damaged",
                                   "recording incomplete",    "golden recording"};

/// Index of the first reason that applies; their number if the attempt is handed out.
std::size_t whyLeftOut(const AttemptRow& a, const BundleSource& source, const BundleOptions& options) {
  if (a.synthetic && !options.includeSynthetic) return 0;
  // A performer's branch of a person's attempt begins with that person's motion, and bears the pseudonym.
  if (!a.synthetic || !a.parent.empty()) {
    const auto person = source.participants.find(a.participant);
    if (person == source.participants.end()) return 1;
    if (a.withdrawn) return 2;
    if (person->second.consent.count(options.scope) == 0) return 3;
  }
  if (a.excluded) return 4;
  if (a.verification.verdict == Verdict::diverged || a.verification.verdict == Verdict::damaged) return 5;
  if (!a.complete || a.outcome == recorder::Outcome::running) return 6;
  return a.purpose == "golden" ? 7 : bundleReasons.size();
}

/// Names of people, places, times and files.
OriginalNames originalsOf(const BundleSource& source) {
  OriginalNames names;
  for (const AttemptRow& a : source.attempts) {
    names.add(a.uuid, "an attempt's uuid");
    names.add(a.parent, "an attempt's uuid");
    names.add(a.startUtc, "a start");
    names.add(a.station, "a station");
    names.add(a.fileName, "a file");
    names.add(a.calibration, "a calibration");
    names.add(a.comparabilityKey, "a comparability key");
  }
  for (const auto& [pseudonym, p] : source.participants) {
    names.add(pseudonym, "a pseudonym");
    names.add(p.site, "a site");
  }
  for (const Rating& r : source.ratings) names.add(r.rater, "a rater");
  for (const Named& site : source.registers.sites) names.add(site.name, "a site");
  for (const Station& station : source.registers.stations) names.add(station.name, "a station");
  return names;
}

/// Words that this program gave, and that a place or a thing may by chance be called by, too.
std::set<std::string> vocabularyOf(const BundleSource& source) {
  std::set<std::string> words{"human", "kinematics", "performer", "practice", "assessment", "falcon", "gamepad"};
  for (const AttemptRow& a : source.attempts) {
    words.insert({a.device, a.scene, a.profile});
  }
  for (const auto& [attempt, values] : source.values) {
    for (const CheckpointValue& value : values) words.insert({value.name, value.subject, value.unit});
  }
  for (const CheckpointEntry& e : checkpointRegistry()) words.insert(e.definition.name);
  return words;
}

/// manifest.json of a bundle with all of its files but this one.
std::string bundleManifest(const Bundle& bundle, const std::string& scope) {
  using Json = nlohmann::ordered_json;
  Json leftOut = Json::array(), files = Json::array();
  for (const FlowRow& row : bundle.leftOut) leftOut.push_back({{"reason", row.reason}, {"attempts", row.attempts}});
  for (const WrittenFile& f : bundle.files)
    files.push_back({{"name", f.name}, {"bytes", f.bytes}, {"sha256", f.sha256}});
  return Json{{"format", "calot-bundle"},
              {"formatVersion", 1},
              {"made_by", recorder::softwareName()},
              {"scope", scope},
              {"watermark", bundle.synthetic ? "SYNTHETIC" : ""},
              {"participants", bundle.participants},
              {"attempts", bundle.attempts},
              {"values", bundle.values},
              {"recruited", bundle.recruited},
              {"left_out", leftOut},
              {"smallest_group", bundle.smallest},
              {"names",
               "pseudonyms, attempts and raters have random names that were drawn for this bundle and are "
               "kept nowhere; sites, calibrations and comparability keys are numbered"},
              {"dates",
               "starts are moved by one random length of time a participant, 30 to 365 days earlier or "
               "later, kept nowhere; what lies between a participant's attempts is true"},
              {"withheld",
               "stations, keys, seeds, chain heads, file names, notes, tags, reasons of exclusion, audit, "
               "protocols, norms; words of experience that fewer than three participants share"},
              {"recordings",
               "none: they hold pseudonym, start and station under a content chain that a rewritten "
               "copy would no longer have, and motion by which a person may be known again"},
              {"files", files}}
             .dump(2, ' ', false, Json::error_handler_t::replace) +
         "\n";
}

/// An attempt that is handed out, under its new names.
struct Handed {
  const AttemptRow* attempt;
  std::string name, participant, start;
};

class Writer {
 public:
  Writer(const BundleSource& source, std::vector<const AttemptRow*> taken)
      : source_(source), originals_(originalsOf(source)), vocabulary_(vocabularyOf(source)), names_(originals_) {
    std::map<std::string, std::int64_t> shift;
    for (const AttemptRow* a : taken) {
      const std::string& whose = a->participant.empty() ? a->uuid : a->participant;
      if (shift.count(whose) == 0) shift[whose] = drawShift();
      handed_.push_back({a, names_.random("A", a->uuid), names_.random("P", a->participant),
                         recorder::shiftedDate(a->startUtc, shift[whose])});
      nameOfAttempt_[a->uuid] = handed_.back().name;
      if (!a->participant.empty())
        people_[names_.random("P", a->participant)] = &source.participants.at(a->participant);
    }
    std::sort(handed_.begin(), handed_.end(), [](const Handed& a, const Handed& b) {
      return std::tie(a.participant, a.start, a.name) < std::tie(b.participant, b.start, b.name);
    });
  }

  void write(FolderOutput& output, Bundle& bundle, const std::string& scope) {
    put(output, "participants.csv", participants(bundle));
    put(output, "experience.csv", experience());
    put(output, "attempts.csv", attempts());
    put(output, "values.csv", values(bundle));
    put(output, "ratings.csv", ratings());
    put(output, "questionnaires.csv", questionnaires());
    for (CodebookEntry& e : checkpointEntries(source_.metrics)) entries_.push_back(std::move(e));
    output.add("codebook.csv", codebookCsv(entries_));
    output.add("codebook.json", codebookJson(entries_));
    bundle.participants = people_.size();
    bundle.attempts = handed_.size();
    bundle.files = output.files();
    bundle.synthetic =
        std::any_of(handed_.begin(), handed_.end(), [](const Handed& h) { return h.attempt->synthetic; });
    put(output, "manifest.json", bundleManifest(bundle, scope));
  }

 private:
  /// The head of a file, whose columns the codebook then explains.
  std::string head(const char* file) {
    const DeclaredTable& table = bundleFile(file);
    std::vector<std::string> names;
    for (const DeclaredColumn& column : table.columns) names.emplace_back(column.name);
    for (CodebookEntry& e : columnEntries(table)) entries_.push_back(std::move(e));
    return csvLine(names);
  }

  void put(FolderOutput& output, const std::string& name, const std::string& text) {
    if (const std::string kind = originals_.firstIn(text, vocabulary_); !kind.empty()) {
      throw Error(ErrorKind::refused,
                  fmt::format("{} would hold {} as it is in the database; nothing is handed out. Look for "
                              "it among groups, arms, criteria of experience and reasons",
                              name, kind));
    }
    output.add(name, text);
  }

  std::string participants(Bundle& bundle) {
    std::string text = head("participants");
    std::map<std::tuple<std::string, std::string, std::string>, std::uint64_t> alike;
    for (const auto& [name, p] : people_) {
      text += csvLine({name, p->group, p->arm, names_.numbered("site ", p->site)});
      ++alike[{p->group, p->arm, p->site}];
    }
    for (const auto& [what, count] : alike)
      bundle.smallest = bundle.smallest == 0 ? count : std::min(bundle.smallest, count);
    return text;
  }

  std::string experience() {
    std::string text = head("experience");
    std::map<std::pair<std::string, std::string>, std::uint64_t> shared;
    for (const auto& [name, p] : people_) {
      for (const auto& item : p->experience) ++shared[item];
    }
    for (const auto& [name, p] : people_) {
      for (const auto& item : p->experience) {
        std::string fault;
        (void)recorder::readFiniteNumber(item.second, fault);
        const bool known = fault.empty() || shared[item] >= fewest;
        text += csvLine({name, item.first, known ? item.second : "(withheld)"});
      }
    }
    return text;
  }

  std::string attempts() {
    std::string text = head("attempts");
    for (const Handed& h : handed_) {
      const AttemptRow& a = *h.attempt;
      const auto parent = nameOfAttempt_.find(a.parent);
      text += csvLine({h.name, h.participant, parent == nameOfAttempt_.end() ? "" : parent->second, h.start, a.scene,
                       std::to_string(a.sceneMajor), recorder::wordFor(a.operatorKind), a.profile,
                       recorder::wordFor(a.mode), recorder::wordFor(a.outcome), a.device,
                       names_.numbered("calibration ", a.calibration), std::to_string(a.simulationVersion),
                       names_.numbered("key ", a.comparabilityKey), std::to_string(a.steps),
                       fmt::format("{}", a.stepSeconds), nameOf(a.verification.verdict), a.synthetic ? "1" : "0",
                       a.leftOut.empty() ? "1" : "0"});
    }
    return text;
  }

  std::string values(Bundle& bundle) {
    std::string text = head("values");
    for (const Handed& h : handed_) {
      const auto list = source_.values.find(h.attempt->uuid);
      if (list == source_.values.end()) continue;
      for (const CheckpointValue& v : list->second) {
        const auto number = [](const std::optional<double>& n) { return n ? fmt::format("{}", *n) : std::string(); };
        text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}\n", h.name, csvCell(v.name), csvCell(v.subject),
                            v.version, static_cast<int>(v.availability), number(v.value), csvCell(v.reason),
                            csvCell(v.unit), csvCell(nameOf(v.origin)), csvCell(v.filter), number(v.coverage),
                            number(v.rate), number(v.noise));
        ++bundle.values;
      }
    }
    return text;
  }

  std::string ratings() {
    std::string text = head("ratings");
    std::vector<std::vector<std::string>> lines;
    for (const Rating& r : source_.ratings) {
      const auto at = nameOfAttempt_.find(r.attempt);
      if (at == nameOfAttempt_.end()) continue;
      for (const auto& [item, score] : r.answers)
        lines.push_back({formOf(r), at->second, names_.random("R", r.rater), item, fmt::format("{}", score)});
    }
    return text + sorted(std::move(lines));
  }

  std::string questionnaires() {
    std::string text = head("questionnaires");
    std::map<std::string, std::string> nameOfPerson;
    for (const auto& [name, p] : people_) nameOfPerson[p->pseudonym] = name;
    std::vector<std::vector<std::string>> lines;
    for (const Rating& r : source_.ratings) {
      const auto at = nameOfPerson.find(r.participant);
      if (!r.attempt.empty() || at == nameOfPerson.end()) continue;
      for (const auto& [item, score] : r.answers)
        lines.push_back({formOf(r), at->second, item, fmt::format("{}", score)});
    }
    return text + sorted(std::move(lines));
  }

  static std::string formOf(const Rating& r) { return fmt::format("{} {}", r.form, r.formVersion); }

  /// Ordered by new names, since the old order would reveal identities.
  static std::string sorted(std::vector<std::vector<std::string>> lines) {
    std::sort(lines.begin(), lines.end());
    std::string text;
    for (const auto& line : lines) text += csvLine(line);
    return text;
  }

  const BundleSource& source_;
  OriginalNames originals_;
  std::set<std::string> vocabulary_;
  NewNames names_;
  std::vector<Handed> handed_;                        ///< by new names
  std::map<std::string, std::string> nameOfAttempt_;  ///< by uuid
  std::map<std::string, const Participant*> people_;  ///< by new name
  std::vector<CodebookEntry> entries_;
};

}  // namespace

Bundle writeBundle(const std::string& database, const std::string& folder, const BundleOptions& options, bool force) {
  FolderOutput output(folder, force);
  const BundleSource source = readBundleSource(database);
  Bundle bundle;
  bundle.recruited = source.attempts.size();
  std::array<std::uint64_t, bundleReasons.size()> left{};
  std::vector<const AttemptRow*> taken;
  for (const AttemptRow& a : source.attempts) {
    const std::size_t why = whyLeftOut(a, source, options);
    if (why < left.size()) {
      ++left[why];
    } else {
      taken.push_back(&a);
    }
  }
  std::string list;
  for (std::size_t i = 0; i < left.size(); ++i) {
    if (left[i] == 0) continue;
    bundle.leftOut.push_back({bundleReasons[i], left[i]});
    list += fmt::format("{}{} {}", list.empty() ? ": " : ", ", left[i], bundleReasons[i]);
  }
  if (taken.empty())
    throw Error(ErrorKind::refused, Where{database},
                fmt::format("none of {} attempts can be handed out{}", bundle.recruited, list));
  Writer(source, taken).write(output, bundle, options.scope);
  std::vector<std::string> uuids;
  uuids.reserve(taken.size());
  for (const AttemptRow* a : taken) uuids.push_back(a->uuid);
  // If an attempt was withdrawn since it was read, nothing is exported.
  recordExport(database, "bundle", folder, uuids);
  output.finish();
  bundle.files = output.files();
  return bundle;
}

}  // namespace calot::analytics
