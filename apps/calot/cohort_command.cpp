// SPDX-License-Identifier: GPL-3.0-or-later
// calot cohort: a cohort database as a whole.
#include <fmt/format.h>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "analytics/cohort/check.h"
#include "analytics/cohort/cohort_database.h"
#include "analytics/cohort/merge.h"
#include "analytics/cohort/registers.h"
#include "analytics/cohort/withdraw.h"
#include "analytics/interchange/cohort_bundle.h"
#include "analytics/interchange/cohort_tables.h"
#include "analytics/regrade.h"
#include "apps/calot/command.h"
#include "apps/calot/environment.h"
#include "apps/calot/regrade_command.h"
#include "apps/common/program.h"
#include "recorder/base/errors.h"

namespace calot::apps {
namespace {

/// `calot cohort export` and `bundle`.
void addCohortExports(CLI::App& parent, Run& run);

using Json = nlohmann::ordered_json;

struct CohortExportsOptions {
  std::string cohort, folder;
  analytics::BundleOptions bundle;
  bool json = false, force = false;
};

int exportTables(const CohortExportsOptions& o) {
  const std::vector<analytics::ExportedTable> tables = analytics::exportCohort(o.cohort, o.folder, o.force);
  Json list = Json::array();
  for (const analytics::ExportedTable& t : tables) {
    if (o.json) {
      list.push_back({{"table", t.name}, {"rows", t.rows}});
    } else {
      std::cout << fmt::format("{:<24}{} rows\n", t.name, t.rows);
    }
  }
  if (o.json) printResult("cohort-export", {{"tables", list}});
  return static_cast<int>(ExitCode::yes);
}

int handOut(const CohortExportsOptions& o) {
  const analytics::Bundle b = analytics::writeBundle(o.cohort, o.folder, o.bundle, o.force);
  if (o.json) {
    Json left = Json::array(), files = Json::array();
    for (const auto& row : b.leftOut) left.push_back({{"reason", row.reason}, {"attempts", row.attempts}});
    for (const auto& f : b.files) files.push_back({{"name", f.name}, {"bytes", f.bytes}, {"sha256", f.sha256}});
    const Json all{{"participants", b.participants},
                   {"attempts", b.attempts},
                   {"values", b.values},
                   {"recruited", b.recruited},
                   {"left_out", left},
                   {"smallest_group", b.smallest},
                   {"files", files}};
    printResult("cohort-bundle", all);
    return static_cast<int>(ExitCode::yes);
  }
  std::cout << fmt::format("{}: {} of {} attempts, of {} participants, {} values\n", o.folder, b.attempts, b.recruited,
                           b.participants, b.values);
  for (const auto& row : b.leftOut) std::cout << fmt::format("{} attempts left out: {}\n", row.attempts, row.reason);
  if (b.participants > 0)
    std::cout << fmt::format(
        "The smallest group that shares group, arm and site is of {}: look whether its members "
        "can be known by that and their experience.\n",
        b.smallest);
  return static_cast<int>(ExitCode::yes);
}

CLI::App* addOne(CLI::App& parent, Run& run, const char* name, const char* help,
                 const std::shared_ptr<CohortExportsOptions>& o, int (*work)(const CohortExportsOptions&)) {
  CLI::App* command = parent.add_subcommand(name, help);
  addCohortOption(*command, o->cohort)->required();
  command->add_option("-o,--output", o->folder, "Folder to make")->required();
  command->add_flag("--force", o->force, "Replace a folder of this name that holds no other files");
  command->add_flag("--json", o->json, "Print JSON");
  command->callback([o, work, &run] { run = [o, work] { return work(*o); }; });
  return command;
}

void addCohortExports(CLI::App& parent, Run& run) {
  addOne(parent, run, "export", "Write every table as CSV and JSON, with a codebook; names and dates as they are",
         std::make_shared<CohortExportsOptions>(), exportTables);
  const auto o = std::make_shared<CohortExportsOptions>();
  CLI::App* bundle =
      addOne(parent, run, "bundle", "Write what was measured for others, de-identified, with a manifest", o, handOut);
  bundle->add_option("--scope", o->bundle.scope, "Purpose to which participants have consented; others stay out")
      ->capture_default_str();
  bundle->add_flag("--include-synthetic", o->bundle.includeSynthetic, "Take in what performers made");
}

using nlohmann::ordered_json;

/// Merges one database. @returns what entered; conflicts are reported on stderr.
nlohmann::ordered_json mergeOne(const std::string& into, const std::string& from, bool json) {
  const analytics::CohortMerge m = analytics::mergeCohorts(into, from);
  if (!json && m.conflicts.empty()) {
    std::cout << fmt::format("{}: {}: {} participants, {} attempts, {} extended, {} other rows, {} entries filled{}\n",
                             into, m.changed() ? "merged" : "nothing new", m.participants, m.attempts, m.extended,
                             m.rows, m.filled,
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

void addMerge(CLI::App& parent, Run& run) {
  struct Options {
    std::string into;
    std::vector<std::string> from;
    bool newer = false, json = false;
  };
  const auto o = std::make_shared<Options>();
  CLI::App* command = parent.add_subcommand("merge", "Take everything of other cohort databases into one");
  command->add_option("into", o->into, "Database to add to")->required();
  command->add_option("from", o->from, "Databases to take from; they stay as they are")->required();
  command->add_flag("--newer", o->newer,
                    "Add nothing; of attempts that are in both, take verdict and values where the other database has "
                    "newer ones");
  command->add_flag("--json", o->json, "Print JSON");
  command->callback([o, &run] {
    run = [o] {
      if (o->newer)
        return static_cast<int>(reportRegrade(o->into, analytics::takeNewer(o->into, o->from), "regrade", o->json));
      nlohmann::ordered_json results = nlohmann::ordered_json::array();
      std::vector<std::string> refused;
      for (const std::string& from : o->from) {
        results.push_back(mergeOne(o->into, from, o->json));
        if (!results.back()["merged"])
          refused.push_back(fmt::format("{} conflicts with {}", results.back()["conflicts"].size(), from));
      }
      if (o->json)
        printResult("cohort-merge",
                    results.size() == 1 ? results.front() : nlohmann::ordered_json{{"databases", results}});
      if (refused.empty()) return static_cast<int>(ExitCode::yes);
      throw Error(ErrorKind::refused, fmt::format("{}: {}; nothing was merged{}", o->into, fmt::join(refused, ", "),
                                                  o->from.size() > 1 ? " of these" : ""));
    };
  });
}

void addCheck(CLI::App& parent, Run& run) {
  struct Options {
    std::string cohort;
    bool json = false;
  };
  const auto o = std::make_shared<Options>();
  CLI::App* command = parent.add_subcommand("check", "Look at a whole cohort database for damage");
  addCohortOption(*command, o->cohort)->required();
  command->add_flag("--json", o->json, "Print JSON");
  command->callback([o, &run] {
    run = [o] {
      const analytics::CohortCheck c = analytics::checkCohort(o->cohort);
      if (o->json) {
        printResult("cohort-check", {{"sound", c.faults.empty()},
                                     {"database_schema", c.schema},
                                     {"participants", c.participants},
                                     {"attempts", c.attempts},
                                     {"values", c.values},
                                     {"faults", c.faults}});
      } else if (c.faults.empty()) {
        std::cout << fmt::format("{}: sound; schema {}, {} participants, {} attempts, {} values\n", o->cohort, c.schema,
                                 c.participants, c.attempts, c.values);
      } else {
        for (const std::string& fault : c.faults) std::cout << fault << '\n';
      }
      if (c.faults.empty()) return static_cast<int>(ExitCode::yes);
      throw Error(ErrorKind::damaged,
                  fmt::format("{}: {} faults, the first: {}; restore a copy, or assess the recordings into a new one",
                              o->cohort, c.faults.size(), c.faults.front()));
    };
  });
}

void addScrub(CLI::App& parent, Run& run) {
  const auto cohort = std::make_shared<std::string>();
  CLI::App* command =
      parent.add_subcommand("scrub", "Overwrite what was deleted, empty the log, remove backups of migrations");
  addCohortOption(*command, *cohort)->required();
  command->callback([cohort, &run] {
    run = [cohort] {
      analytics::scrub(*cohort);
      std::cout << *cohort << ": scrubbed\n";
      return static_cast<int>(ExitCode::yes);
    };
  });
}

void addUpgrade(CLI::App& parent, Run& run) {
  const auto cohort = std::make_shared<std::string>();
  CLI::App* command = parent.add_subcommand(
      "upgrade", "Bring a database of an older Calot to the schema of this one; a copy is kept beside it");
  addCohortOption(*command, *cohort)->required();
  command->callback([cohort, &run] {
    run = [cohort] {
      const analytics::CohortDatabase database(*cohort, analytics::CohortDatabase::Access::write);
      std::cout << fmt::format("{}: schema {}\n", *cohort, database.schemaVersion());
      return static_cast<int>(ExitCode::yes);
    };
  });
}

void addNames(CLI::App& parent, Run& run) {
  struct Options {
    std::string name, cohort, site, note, key;
    std::vector<std::string> add, remove;
  };
  const auto command = [&](const char* kind, const char* help, auto more, auto work) {
    const auto o = std::make_shared<Options>();
    CLI::App* c = parent.add_subcommand(kind, help);
    c->add_option("name", o->name, "Its name")->required();
    c->add_option("--cohort", o->cohort, "Cohort database; made where there is none")->required();
    c->add_option("--note", o->note, "A word on it; never about a person");
    more(*c, *o);
    c->callback([c, o, kind, work, &run] {
      const auto given = [c](const char* option) {
        return c->get_option_no_throw(option) != nullptr && c->count(option) > 0;
      };
      std::optional<std::string> note, site;
      if (given("--note")) note = o->note;
      if (given("--site")) site = o->site;
      run = [o, kind, work, note, site] {
        work(*o, note, site);
        std::cout << fmt::format("{}: {} {}\n", o->cohort, kind, o->name);
        return static_cast<int>(ExitCode::yes);
      };
    });
  };
  using Given = std::optional<std::string>;
  const auto nothing = [](CLI::App&, Options&) {};
  command("site", "Name a site", nothing,
          [](const Options& o, const Given& note, const Given&) { analytics::setSite(o.cohort, o.name, note); });
  command("arm", "Name a study arm", nothing,
          [](const Options& o, const Given& note, const Given&) { analytics::setArm(o.cohort, o.name, note); });
  command(
      "station", "Name a station, and the key that it signs with",
      [](CLI::App& c, Options& o) {
        c.add_option("--site", o.site, "Where it stands");
        c.add_option("--public-key", o.key, "64 hexadecimal digits, as `calot station show` prints them");
      },
      [](const Options& o, const Given& note, const Given& site) {
        std::optional<analytics::PublicKey> key;
        if (!o.key.empty()) key = fromHex<32>(o.key, "--public-key");
        analytics::setStation(o.cohort, o.name, site, key, note);
      });
  command(
      "name", "Name a cohort of participants",
      [](CLI::App& c, Options& o) {
        c.add_option("--add", o.add, "Participant who belongs to it; may be repeated")->allow_extra_args(false);
        c.add_option("--remove", o.remove, "Participant who does not any more")->allow_extra_args(false);
      },
      [](const Options& o, const Given& note, const Given&) {
        analytics::setCohort(o.cohort, o.name, note, o.add, o.remove);
      });
}

void addList(CLI::App& parent, Run& run) {
  struct Options {
    std::string cohort;
    bool json = false;
  };
  const auto o = std::make_shared<Options>();
  CLI::App* command = parent.add_subcommand("list", "Sites, arms, stations and cohorts of a database");
  addCohortOption(*command, o->cohort)->required();
  command->add_flag("--json", o->json, "Print JSON");
  command->callback([o, &run] {
    run = [o] {
      const analytics::Registers r = analytics::readRegisters(o->cohort);
      ordered_json out = {{"sites", ordered_json::array()},
                          {"arms", ordered_json::array()},
                          {"stations", ordered_json::array()},
                          {"cohorts", ordered_json::array()}};
      for (const auto& s : r.sites) out["sites"].push_back({{"name", s.name}, {"note", s.note}});
      for (const auto& a : r.arms) out["arms"].push_back({{"name", a.name}, {"note", a.note}});
      for (const auto& s : r.stations) {
        out["stations"].push_back({{"name", s.name},
                                   {"site", s.site},
                                   {"public_key", s.publicKey ? toHex(*s.publicKey) : ""},
                                   {"note", s.note}});
      }
      for (const auto& c : r.cohorts)
        out["cohorts"].push_back({{"name", c.name}, {"participants", c.participants}, {"note", c.note}});
      if (o->json) {
        printResult("cohort-list", out);
        return static_cast<int>(ExitCode::yes);
      }
      for (const char* kind : {"sites", "arms", "stations", "cohorts"}) {
        for (const ordered_json& row : out[kind]) {
          std::string line = fmt::format("{:<10}{}", kind, row["name"].get<std::string>());
          if (row.contains("site") && row["site"] != "") line += ", site " + row["site"].get<std::string>();
          if (row.contains("public_key") && row["public_key"] != "")
            line += ", key " + row["public_key"].get<std::string>();
          for (const auto& p : row.value("participants", std::vector<std::string>())) line += " " + p;
          if (row["note"] != "") line += ": " + row["note"].get<std::string>();
          std::cout << line << '\n';
        }
      }
      return static_cast<int>(ExitCode::yes);
    };
  });
}

}  // namespace

void addCohort(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand("cohort", "Merge, check, name and hand out what is in a cohort database");
  command->require_subcommand(1);
  addMerge(*command, run);
  addCheck(*command, run);
  addUpgrade(*command, run);
  addScrub(*command, run);
  addList(*command, run);
  addNames(*command, run);
  addCohortExports(*command, run);
}

}  // namespace calot::apps
