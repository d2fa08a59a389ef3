// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/kept/engine_folders.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <string_view>
#include <system_error>
#include <utility>

#include "recorder/base/errors.h"
#include "recorder/base/files.h"

namespace calot::recorder {

namespace {

EnginePlaces& usedPlaces() {
  static EnginePlaces places;
  return places;
}

std::vector<std::filesystem::path> splitPaths(std::string_view text) {
  std::vector<std::filesystem::path> paths;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(':'), text.size());
    if (end > 0) paths.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return paths;
}

std::filesystem::path findInPath(const char* program) {
  const char* path = std::getenv("PATH");
  for (const std::filesystem::path& folder : splitPaths(path == nullptr ? "/usr/bin:/bin" : path)) {
    if (access((folder / program).c_str(), X_OK) == 0) return folder / program;
  }
  return {};
}

/// The number between two texts that a file's name consists of.
std::optional<std::uint32_t> numberIn(std::string_view name, std::string_view before, std::string_view after) {
  if (name.size() <= before.size() + after.size() || !name.starts_with(before) || !name.ends_with(after))
    return std::nullopt;
  name = name.substr(before.size(), name.size() - before.size() - after.size());
  std::uint32_t number = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
  if (error != std::errc() || end != name.data() + name.size() || name.front() == '0') return std::nullopt;
  return number;
}

}  // namespace

void useEngines(EnginePlaces places) { usedPlaces() = std::move(places); }
const EnginePlaces& enginePlaces() { return usedPlaces(); }

std::vector<KeptEngine> listEngines() {
  std::vector<KeptEngine> engines;
  for (const std::filesystem::path& folder : usedPlaces().folders) {
    std::error_code fault;
    std::vector<KeptEngine> here;
    for (std::filesystem::directory_iterator it(folder, fault), end; !fault && it != end; it.increment(fault)) {
      const std::string name = it->path().filename().string();
      if (const auto native = numberIn(name, "calot-engine-", ""))
        here.push_back({*native, it->path(), false, {it->path().string()}});
      const auto module = numberIn(name, "engine-", ".wasm");
      if (!module) continue;
      const bool runs = !usedPlaces().runtime.empty();
      here.push_back({*module, it->path(), true, runs ? commandOf(it->path()) : std::vector<std::string>{}});
    }
    engines.insert(engines.end(), here.begin(), here.end());
  }
  // Whatever folder: a module is for where nothing native is.
  std::ranges::stable_sort(engines, [](const KeptEngine& a, const KeptEngine& b) {
    return std::pair(a.version, a.isModule) < std::pair(b.version, b.isModule);
  });
  return engines;
}

std::vector<std::string> commandOf(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored))
    throw Error(ErrorKind::damaged, Where{file.string()}, "there is no such engine");
  // A program without a folder in its name would be looked for in PATH.
  const std::string path = std::filesystem::absolute(file).string();
  if (file.extension() != ".wasm") return {path};
  std::vector<std::string> command = usedPlaces().runtime;
  if (command.empty())
    throw Error(ErrorKind::failure, Where{file.string()}, "is a WebAssembly module, and no node is here to run it");
  command.push_back(path);
  return command;
}

std::vector<std::string> commandOfEngine(std::uint32_t version) {
  for (KeptEngine& engine : listEngines()) {
    if (engine.version == version && !engine.command.empty()) return std::move(engine.command);
  }
  return {};
}

EnginePlaces userEnginePlaces(const std::filesystem::path& programFolder,
                              const std::vector<std::filesystem::path>& assetRoots) {
  EnginePlaces places;
  if (const char* named = std::getenv("CALOT_ENGINES"); named != nullptr) {
    places.folders = splitPaths(named);
  } else {
    if (const std::filesystem::path user = userFolder("XDG_DATA_HOME", ".local/share"); !user.empty())
      places.folders.push_back(user / "calot/engines");
    places.folders.push_back(programFolder / "../lib/calot/engines");
  }
  const std::filesystem::path node = findInPath("node");
  for (const std::filesystem::path& root : assetRoots) {
    const std::filesystem::path folder = root / "engines";
    const std::filesystem::path runner = folder / "run-engine.mjs";
    std::error_code ignored;
    places.folders.push_back(folder);
    if (places.runtime.empty() && !node.empty() && std::filesystem::is_regular_file(runner, ignored))
      places.runtime = {node.string(), runner.string()};
  }
  if (access((programFolder / "calot-engine").c_str(), X_OK) == 0) places.own = programFolder / "calot-engine";
  return places;
}

}  // namespace calot::recorder
