// SPDX-License-Identifier: GPL-3.0-or-later
// calot cache: what the user's cache folder holds.

#include "apps/calot/command.h"
#include "recorder/compliance_cache.h"

namespace calot::apps {
namespace {

using recorder::CacheEntry;

struct CacheOptions {
  bool clean = false, all = false, json = false;
};

const char* stateName(CacheEntry::State state) {
  constexpr const char* names[] = {"usable", "other version", "damaged", "foreign", "leftover"};
  return names[static_cast<std::size_t>(state)];
}

std::string megabytes(std::uint64_t bytes) { return fmt::format("{:.1f} MB", static_cast<double>(bytes) / 1e6); }

void cache(const CacheOptions& o) {
  const std::optional<std::filesystem::path> folder = recorder::userCacheFolder();
  std::vector<CacheEntry> entries;
  if (folder) {
    const recorder::ComplianceCache cache(*folder);
    entries = o.clean ? cache.clean(o.all) : cache.list();
  }
  Json rows = Json::array();
  std::uint64_t bytes = 0;
  analytics::ReportTable table = analytics::tableOf("", {"=scene", "simulation", "columns", "size", "="});
  for (const CacheEntry& e : entries) {
    const std::string file = e.file.filename().string();
    rows.push_back({{"file", file},
                    {"state", stateName(e.state)},
                    {"scene", e.scene},
                    {"simulation_version", e.simulationVersion},
                    {"columns", e.columns},
                    {"bytes", e.bytes}});
    const bool known = e.state == CacheEntry::State::usable || e.state == CacheEntry::State::otherVersion;
    table.rows.push_back({known ? e.scene : file, known ? std::to_string(e.simulationVersion) : "-",
                          known ? std::to_string(e.columns) : "-", megabytes(e.bytes), stateName(e.state)});
    bytes += e.bytes;
  }
  const std::string place = folder ? folder->string() : "";
  printResult(o.json, "cache", {{"folder", place}, {"removed", o.clean}, {"entries", rows}}, [&](std::ostream& out) {
    if (!table.rows.empty()) table.print(out);
    out << (folder ? fmt::format("{}: {}{} entries, {}\n", place, o.clean ? "removed " : "", entries.size(),
                                 megabytes(bytes))
                   : "no cache folder: CALOT_CACHE is off, or there is no home\n");
  });
}

}  // namespace

void addCache(CLI::App& app, Run& run) {
  const auto [command, o] = addCommand(
      app, run,
      {"cache", "Show or clean what is kept in the cache folder so that scenes start sooner", "calot cache --clean"},
      cache);
  CLI::Option* const clean =
      command->add_flag("--clean", o->clean, "Remove what this build cannot use: damaged, foreign, of other versions");
  command->add_flag("--all", o->all, "With --clean: everything")->needs(clean);
  command->add_flag("--json", o->json, "Print JSON");
}

}  // namespace calot::apps
