// SPDX-License-Identifier: GPL-3.0-or-later
// calot cohort: a cohort database as a whole.

#include "analytics/cohort/cohort_database.h"
#include "analytics/cohort/registers.h"
#include "analytics/cohort/withdraw.h"
#include "analytics/interchange/cohort_bundle.h"
#include "analytics/interchange/export_tables.h"
#include "apps/calot/command.h"
#include "apps/calot/replay_report.h"
#include "recorder/base/counted.h"
#include "recorder/base/files.h"

namespace calot::apps {
namespace {

struct CohortExport {
  std::string cohort, folder;
  analytics::BundleOptions bundle;
  bool json = false, force = false;
};

void exportTables(const CohortExport& o) {
  Json list = Json::array();
  std::string text;
  Progress progress("Exporting", o.json);
  for (const analytics::ExportedTable& t : analytics::exportCohort(o.cohort, o.folder, o.force)) {
    list.push_back({{"table", t.name}, {"rows", t.rows}});
    text += fmt::format("{:<24}{}\n", t.name, recorder::counted(t.rows, "row"));
  }
  printResult(o.json, "cohort-export", {{"tables", list}}, text);
}

void handOut(const CohortExport& o) {
  Progress progress("Writing the bundle", o.json);
  const analytics::Bundle b = analytics::writeBundle(o.cohort, o.folder, o.bundle, o.force);
  Json left = Json::array(), files = Json::array();
  std::string text =
      fmt::format("{}: {} of {}, of {}, {}\n", o.folder, b.attempts, recorder::counted(b.recruited, "attempt"),
                  recorder::counted(b.participants, "participant"), recorder::counted(b.values, "value"));
  for (const auto& row : b.leftOut) {
    left.push_back({{"reason", row.reason}, {"attempts", row.attempts}});
    text += fmt::format("{} left out: {}\n", recorder::counted(row.attempts, "attempt"), row.reason);
  }
  if (b.participants > 0)
    text += fmt::format(
        "The smallest group that shares group, arm and site is of {}: look whether its members "
        "can be known by that and their experience.\n",
        b.smallest);
  for (const auto& f : b.files) files.push_back({{"name", f.name}, {"bytes", f.bytes}, {"sha256", f.sha256}});
  const Json all{{"participants", b.participants},
                 {"attempts", b.attempts},
                 {"values", b.values},
                 {"recruited", b.recruited},
                 {"left_out", left},
                 {"smallest_group", b.smallest},
                 {"files", files}};
  printResult(o.json, "cohort-bundle", all, text);
}

/// Merges one database. @returns what entered; conflicts are reported on stderr.
Json mergeOne(const std::string& into, const std::string& from, bool json) {
  const analytics::CohortMerge m = analytics::mergeCohorts(into, from);
  Progress::erase();
  if (!json && m.conflicts.empty()) {
    fmt::print("{}: {}: {}, {}, {} extended, {}, {} filled{}\n", into, m.changed() ? "merged" : "nothing new",
               recorder::counted(m.participants, "participant"), recorder::counted(m.attempts, "attempt"), m.extended,
               recorder::counted(m.rows, "other row"), recorder::counted(m.filled, "entry", "entries"),
               m.withdrawn > 0 ? fmt::format("; {} withdrawn attempts stay out", m.withdrawn) : "");
  }
  for (const std::string& conflict : m.conflicts) fmt::print(stderr, "calot: conflict: {}\n", conflict);
  return {{"merged", m.conflicts.empty()},
          {"participants", m.participants},
          {"attempts", m.attempts},
          {"extended", m.extended},
          {"other_rows", m.rows},
          {"audit_rows", m.audit},
          {"filled", m.filled},
          {"withdrawn", m.withdrawn},
          {"conflicts", m.conflicts}};
}

struct MergeOptions {
  std::string into;
  std::vector<std::string> from;
  bool newer = false, json = false;
};

ExitCode merge(const MergeOptions& o) {
  Progress progress("Merging", o.json);
  if (o.newer) return reportRegrade(o.into, analytics::takeNewer(o.into, o.from), o.json);
  Json results = Json::array();
  std::vector<std::string> refused;
  for (const std::string& from : o.from) {
    results.push_back(mergeOne(o.into, from, o.json));
    if (!results.back()["merged"])
      refused.push_back(fmt::format("{} conflicts with {}", results.back()["conflicts"].size(), from));
  }
  if (o.json) printResult("cohort-merge", results.size() == 1 ? results.front() : Json{{"databases", results}});
  if (refused.empty()) return ExitCode::yes;
  throw Error(ErrorKind::refused, fmt::format("{}: {}; nothing was merged{}", o.into, fmt::join(refused, ", "),
                                              o.from.size() > 1 ? " of these" : ""));
}

struct CohortOptions {
  std::string cohort;
  bool json = false;
};

void checkDatabase(const CohortOptions& o) {
  Progress progress("Checking the cohort", o.json);
  const analytics::CohortCheck c = analytics::checkCohort(o.cohort);
  const Json all{{"sound", c.faults.empty()}, {"database_schema", c.schema}, {"participants", c.participants},
                 {"attempts", c.attempts},    {"values", c.values},          {"faults", c.faults}};
  printResult(o.json, "cohort-check", all,
              c.faults.empty()
                  ? fmt::format("{}: sound; schema {}, {}, {}, {}\n", o.cohort, c.schema,
                                recorder::counted(c.participants, "participant"),
                                recorder::counted(c.attempts, "attempt"), recorder::counted(c.values, "value"))
                  : fmt::format("{}\n", fmt::join(c.faults, "\n")));
  if (c.faults.empty()) return;
  throw Error(ErrorKind::damaged,
              fmt::format("{}: {}, the first: {}; restore a copy, or assess the recordings into a new one", o.cohort,
                          recorder::counted(c.faults.size(), "fault"), c.faults.front()));
}

void scrub(const CohortOptions& o) {
  Progress progress("Scrubbing");
  analytics::scrub(o.cohort);
  Progress::erase();
  std::cout << o.cohort << ": scrubbed\n";
}

void upgrade(const CohortOptions& o) {
  const analytics::CohortDatabase database(o.cohort, analytics::CohortDatabase::Access::write);
  fmt::print("{}: schema {}\n", o.cohort, database.schemaVersion());
}

void listRegisters(const CohortOptions& o) {
  const analytics::Registers r = analytics::readRegisters(o.cohort);
  Json out = {
      {"sites", Json::array()}, {"arms", Json::array()}, {"stations", Json::array()}, {"cohorts", Json::array()}};
  for (const auto& s : r.sites) out["sites"].push_back({{"name", s.name}, {"note", s.note}});
  for (const auto& a : r.arms) out["arms"].push_back({{"name", a.name}, {"note", a.note}});
  for (const auto& s : r.stations) {
    const std::string key = s.publicKey ? recorder::hexOf(*s.publicKey) : "";
    out["stations"].push_back({{"name", s.name}, {"site", s.site}, {"public_key", key}, {"note", s.note}});
  }
  for (const auto& c : r.cohorts)
    out["cohorts"].push_back({{"name", c.name}, {"participants", c.participants}, {"note", c.note}});
  std::string text;
  for (const auto& [kind, rows] : out.items()) {
    for (const Json& row : rows) {
      const auto part = [&row](const char* before, const char* member) {
        const std::string word = row.value(member, "");
        return word.empty() ? word : before + word;
      };
      text +=
          fmt::format("{:<10}{}{}{}", kind, part("", "name"), part(", site ", "site"), part(", key ", "public_key"));
      for (const std::string& p : row.value("participants", std::vector<std::string>())) text += " " + p;
      text += part(": ", "note") + "\n";
    }
  }
  printResult(o.json, "cohort-list", out, text);
}

struct NameOptions {
  const CLI::App* command = nullptr;
  void (*store)(const NameOptions&) = nullptr;
  std::string name, cohort, site, note, key;
  std::vector<std::string> add, remove;

  [[nodiscard]] std::optional<std::string> noteGiven() const { return givenOf(*command, "--note", note); }
};

void nameStation(const NameOptions& o) {
  std::optional<analytics::PublicKey> key;
  if (!o.key.empty()) key = keyOf(o.key, "--public-key");
  analytics::setStation(o.cohort, o.name, givenOf(*o.command, "--site", o.site), key, o.noteGiven());
}

void enterName(const NameOptions& o) {
  o.store(o);
  fmt::print("{}: {} {}\n", o.cohort, o.command->get_name(), o.name);
}

}  // namespace

void addCohort(CLI::App& app, Run& run) {
  CLI::App& cohort = addGroup(
      app, {"cohort", "Merge, check, name and hand out what is in a cohort database", "calot cohort list c.db"});

  const auto [merged, m] = addCommand(
      cohort, run,
      {"merge", "Take everything of other cohort databases into one", "calot cohort merge all.db site2.db"}, merge);
  merged->add_option("into", m->into, "Database to add to")->required();
  merged->add_option("from", m->from, "Databases to take from; they stay as they are")->required();
  merged->add_flag("--newer", m->newer,
                   "Add nothing; of attempts that are in both, take verdict and values where the other database has "
                   "newer ones");
  merged->add_flag("--json", m->json, "Print JSON");

  const auto addOne = [&](const CommandText& text, void (*work)(const CohortOptions&), bool asJson) {
    const auto [command, o] = addCommand(cohort, run, text, work);
    addCohortOption(*command, o->cohort)->required();
    if (asJson) command->add_flag("--json", o->json, "Print JSON");
  };
  addOne({"check", "Look at a whole cohort database for damage", "calot cohort check c.db"}, checkDatabase, true);
  addOne({"upgrade", "Bring a database of an older Calot to the schema of this one; a copy is kept beside it",
          "calot cohort upgrade c.db"},
         upgrade, false);
  addOne({"scrub", "Overwrite what was deleted, remove backups of migrations", "calot cohort scrub c.db"}, scrub,
         false);
  addOne({"list", "Sites, arms, stations and cohorts of a database", "calot cohort list c.db"}, listRegisters, true);

  const auto addName = [&](const CommandText& text, void (*work)(const NameOptions&)) {
    const auto [command, o] = addCommand(cohort, run, text, enterName);
    o->command = command;
    o->store = work;
    command->add_option("name", o->name, "Its name")->required();
    command->add_option("--cohort", o->cohort, "Cohort database; made where there is none")->required();
    command->add_option("--note", o->note, "A word on it; never about a person");
    return std::pair{command, o};
  };
  addName({"site", "Name a site", "calot cohort site north --cohort c.db"},
          [](const NameOptions& o) { analytics::setNamed(o.cohort, "site", o.name, o.noteGiven()); });
  addName({"arm", "Name a study arm", "calot cohort arm simulator-first --cohort c.db"},
          [](const NameOptions& o) { analytics::setNamed(o.cohort, "arm", o.name, o.noteGiven()); });
  const auto [station, s] = addName({"station", "Name a station, and the key that it signs with",
                                     "calot cohort station trainer-1 --cohort c.db --site north"},
                                    nameStation);
  station->add_option("--site", s->site, "Site at which it stands");
  station->add_option("--public-key", s->key, "64 hexadecimal digits, as `calot station show` prints them");
  const auto [name, n] = addName(
      {"name", "Name a cohort of participants", "calot cohort name second-years --cohort c.db --add P1 --add P2"},
      [](const NameOptions& o) { analytics::setCohort(o.cohort, o.name, o.noteGiven(), o.add, o.remove); });
  name->add_option("--add", n->add, "Participant who belongs to it; may be repeated")->allow_extra_args(false);
  name->add_option("--remove", n->remove, "Participant who does not any more")->allow_extra_args(false);

  const auto addExport = [&](const CommandText& text, void (*work)(const CohortExport&)) {
    const auto [command, o] = addCommand(cohort, run, text, work);
    addCohortOption(*command, o->cohort)->required();
    command->add_option("-o,--output", o->folder, "Folder to make")->required();
    command->add_flag("--force", o->force, "Replace a folder of this name that holds no other files");
    command->add_flag("--json", o->json, "Print JSON");
    return std::pair{command, o};
  };
  addExport({"export", "Write every table as CSV and JSON, with a codebook; names and dates as they are",
             "calot cohort export c.db -o tables"},
            exportTables);
  const auto [bundle, b] = addExport({"bundle", "Write what was measured for others, de-identified, with a manifest",
                                      "calot cohort bundle c.db -o bundle"},
                                     handOut);
  bundle->add_option("--scope", b->bundle.scope, "Purpose to which participants have consented; others stay out")
      ->capture_default_str();
  bundle->add_flag("--include-synthetic", b->bundle.includeSynthetic, "Take in what performers made");
}

}  // namespace calot::apps
