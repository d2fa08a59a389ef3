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
#include "analytics/regrade.h"
#include "apps/calot/cohort_exports.h"
#include "apps/calot/cohort_option.h"
#include "apps/calot/commands.h"
#include "apps/calot/hex.h"
#include "apps/calot/regrade_report.h"
#include "apps/calot/results.h"
#include "apps/common/exit_code.h"
#include "recorder/base/errors.h"

namespace calot::apps {
namespace {

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
      throw Error(ErrorKind::refused,
                  fmt::format("{}: {}; nothing of it was merged", o->into, fmt::join(refused, ", ")));
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
