// SPDX-License-Identifier: GPL-3.0-or-later
// calot cache: what the user's cache folder holds.
#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "analytics/report/report_document.h"
#include "apps/calot/commands.h"
#include "apps/calot/results.h"
#include "recorder/compliance_cache.h"

namespace calot::apps {
namespace {

using nlohmann::ordered_json;
using recorder::CacheEntry;

struct CacheOptions {
  bool clean = false, all = false, json = false;
};

const char* nameOf(CacheEntry::State state) {
  switch (state) {
    case CacheEntry::State::usable:
      return "usable";
    case CacheEntry::State::otherVersion:
      return "other version";
    case CacheEntry::State::damaged:
      return "damaged";
    case CacheEntry::State::foreign:
      return "foreign";
    case CacheEntry::State::leftover:
      return "leftover";
  }
  return "";
}

std::string megabytes(std::uint64_t bytes) { return fmt::format("{:.1f} MB", static_cast<double>(bytes) / 1e6); }

std::uint64_t sum(const std::vector<CacheEntry>& entries) {
  std::uint64_t bytes = 0;
  for (const CacheEntry& entry : entries) bytes += entry.bytes;
  return bytes;
}

void printJson(const std::string& folder, const std::vector<CacheEntry>& entries, bool removed) {
  ordered_json out;
  out["folder"] = folder;
  out["removed"] = removed;
  out["entries"] = ordered_json::array();
  for (const CacheEntry& e : entries) {
    out["entries"].push_back({{"file", e.file.filename().string()},
                              {"state", nameOf(e.state)},
                              {"scene", e.scene},
                              {"simulation_version", e.simulationVersion},
                              {"columns", e.columns},
                              {"bytes", e.bytes}});
  }
  printResult("cache", out);
}

void printTable(const std::vector<CacheEntry>& entries) {
  analytics::ReportTable table = analytics::tableOf("", {"=scene", "simulation", "columns", "size", "="});
  for (const CacheEntry& e : entries) {
    const bool known = e.state == CacheEntry::State::usable || e.state == CacheEntry::State::otherVersion;
    table.rows.push_back({known ? e.scene : e.file.filename().string(),
                          known ? std::to_string(e.simulationVersion) : "-", known ? std::to_string(e.columns) : "-",
                          megabytes(e.bytes), nameOf(e.state)});
  }
  if (!table.rows.empty()) table.print(std::cout);
}

int cache(const CacheOptions& o) {
  const std::optional<std::filesystem::path> folder = recorder::userCacheFolder();
  if (!folder) {
    if (o.json) {
      printJson("", {}, o.clean);
    } else {
      fmt::print("no cache folder: CALOT_CACHE is off, or there is no home\n");
    }
    return 0;
  }
  const recorder::ComplianceCache cache(*folder);
  const std::vector<CacheEntry> entries = o.clean ? cache.clean(o.all) : cache.list();
  if (o.json) {
    printJson(folder->string(), entries, o.clean);
    return 0;
  }
  printTable(entries);
  std::cout << std::flush;
  fmt::print("{}: {}{} entries, {}\n", folder->string(), o.clean ? "removed " : "", entries.size(),
             megabytes(sum(entries)));
  return 0;
}

}  // namespace

void addCache(CLI::App& app, Run& run) {
  const auto o = std::make_shared<CacheOptions>();
  CLI::App* command =
      app.add_subcommand("cache", "Show or clean what is kept in the cache folder so that scenes start sooner");
  CLI::Option* const clean =
      command->add_flag("--clean", o->clean, "Remove what this build cannot use: damaged, foreign, of other versions");
  command->add_flag("--all", o->all, "With --clean: everything")->needs(clean);
  command->add_flag("--json", o->json, "Print JSON");
  command->callback([o, &run] { run = [o] { return cache(*o); }; });
}

}  // namespace calot::apps
