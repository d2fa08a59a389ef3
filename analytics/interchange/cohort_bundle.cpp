// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/interchange/cohort_bundle.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <map>
#include <set>
#include <tuple>

#include "analytics/cohort/declared_tables.h"
#include "analytics/cohort/withdraw.h"
#include "analytics/interchange/bundle_manifest.h"
#include "analytics/interchange/bundle_source.h"
#include "analytics/interchange/codebook.h"
#include "analytics/interchange/date_shift.h"
#include "analytics/interchange/new_names.h"
#include "recorder/base/csv_writer.h"
#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"

namespace calot::analytics {
namespace {

constexpr std::uint64_t fewest = 3;  ///< minimum number of participants who share an item of experience

/// Files of a bundle and their columns: name, type, meaning, unit, allowed values, what stands where there is none.
const DeclaredTable& bundleFile(std::string_view name) {
  constexpr const char *text = "TEXT", *integer = "INTEGER", *real = "REAL", *yesNo = "0 no, 1 yes",
                       *utc = "ISO 8601 UTC with Z";
  static const std::vector<DeclaredTable> files{
      {"participants",
       {{"participant", text, "new pseudonym, drawn for this bundle"},
        {"group", text, "study group", {}, "", "", "empty"},
        {"arm", text, "study arm", {}, "", "", "empty"},
        {"site", text, "site, a number without meaning", {}, "", "", "empty"}}},
      {"experience",
       {{"participant", text, "pseudonym in participants"},
        {"criterion", text, "what was asked"},
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
         utc,
         "empty"},
        {"scene", text, "scene, or declared task of imported motion"},
        {"scene_version", integer, "version of the scene that comparison asks for"},
        {"operator", text, "who acted", {}, "", "human, kinematics, performer"},
        {"profile", text, "profile of a performer", {}, "", "", "empty"},
        {"mode", text, "mode", {}, "", "practice, assessment"},
        {"outcome",
         text,
         "how it ended",
         {},
         "",
         "running, completed, time limit, abandoned, stopped, technical failure"},
        {"device", text, "class of device", {}, "", "", "empty"},
        {"calibration", text, "calibration, a number without meaning", {}, "", "", "empty"},
        {"simulation_version", integer, "version of the simulation; 0: motion without a scene"},
        {"comparability_key", text, "attempts are compared within one key only; a number without meaning"},
        {"steps", integer, "number of steps"},
        {"step_seconds", real, "length of a step", {}, "s"},
        {"verdict", text, "what the newest replay said", {}, "", "verified, not checkable here, not checked"},
        {"synthetic", integer, "made by a performer", {}, "", yesNo}}},
      {"values",
       {{"attempt", text, "attempt in attempts"},
        {"checkpoint", text, "checkpoint"},
        {"subject", text, "hand, organ or phase", {}, "", "", "empty: the attempt as a whole"},
        {"version", integer, "version of the checkpoint"},
        {"availability",
         integer,
         "whether there is a value",
         {},
         "",
         "0 value, 1 not applicable, 2 not available, 3 absent hand, 4 too little coverage"},
        {"value", real, "the value, in unit", {}, "", "finite", "empty where availability is not 0"},
        {"reason", text, "why there is no value", {}, "", "", "empty where availability is 0"},
        {"unit", text, "SI unit of the value"},
        {"origin", text, "what it was computed from", {}, "", "re-simulated, observables, samples, external"},
        {"filter", text, "resampling and filter when the value was made"},
        {"coverage",
         real,
         "share of the window that samples cover",
         {},
         "1",
         "0 to 1",
         "empty: not of samples, or not known"}}},
      {"ratings",
       {{"form", text, "form and its version"},
        {"attempt", text, "attempt in attempts"},
        {"rater", text, "new pseudonym of the rater, drawn for this bundle"},
        {"item", text, "key of the item"},
        {"score", integer, "score", {}, "", "whole numbers of the form's scale", "an item left blank has no row"}}},
      {"questionnaires",
       {{"form", text, "form and its version"},
        {"participant", text, "pseudonym in participants"},
        {"item", text, "key of the item"},
        {"score", integer, "score", {}, "", "whole numbers of the form's scale", "an item left blank has no row"}}}};
  const auto at =
      std::find_if(files.begin(), files.end(), [&](const DeclaredTable& file) { return file.name == name; });
  assert(at != files.end());
  return *at;
}

/// An attempt that is handed out, under its new names.
struct Handed {
  const AttemptRow* attempt;
  std::string name, participant, start;
};

std::string uintText(std::uint64_t n) { return fmt::format("{}", n); }

class Writer {
 public:
  Writer(const BundleSource& source, std::vector<const AttemptRow*> taken)
      : source_(source), originals_(originalsOf(source)), vocabulary_(vocabularyOf(source)), names_(originals_) {
    std::map<std::string, std::int64_t> shift;
    for (const AttemptRow* a : taken) {
      const std::string& whose = a->participant.empty() ? a->uuid : a->participant;
      if (shift.count(whose) == 0) shift[whose] = drawShift();
      handed_.push_back(
          {a, names_.random("A", a->uuid), names_.random("P", a->participant), shiftedUtc(a->startUtc, shift[whose])});
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
                       uintText(a.sceneMajor), recorder::wordFor(a.operatorKind), a.profile, recorder::wordFor(a.mode),
                       recorder::wordFor(a.outcome), a.device, names_.numbered("calibration ", a.calibration),
                       uintText(a.simulationVersion), names_.numbered("key ", a.comparabilityKey), uintText(a.steps),
                       fmt::format("{}", a.stepSeconds), nameOf(a.verification.verdict), a.synthetic ? "1" : "0"});
    }
    return text;
  }

  std::string values(Bundle& bundle) {
    std::string text = head("values");
    for (const Handed& h : handed_) {
      const auto list = source_.values.find(h.attempt->uuid);
      if (list == source_.values.end()) continue;
      for (const CheckpointValue& v : list->second) {
        text += fmt::format("{},{},{},{},{},{},{},{},{},{},{}\n", h.name, csvCell(v.name), csvCell(v.subject),
                            v.version, static_cast<int>(v.availability), v.value ? fmt::format("{}", *v.value) : "",
                            csvCell(v.reason), csvCell(v.unit), csvCell(nameOf(v.origin)), csvCell(v.filter),
                            v.coverage ? fmt::format("{}", *v.coverage) : "");
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
  std::vector<std::uint64_t> left(bundleReasons().size());
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
    bundle.leftOut.push_back({bundleReasons()[i], left[i]});
    list += fmt::format("{}{} {}", list.empty() ? ": " : ", ", left[i], bundleReasons()[i]);
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
