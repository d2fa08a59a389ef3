// SPDX-License-Identifier: GPL-3.0-or-later
// Kept engines on this machine: one program a simulation version (docs/explanation/engines.md).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace calot::recorder {

/// Folders in which programs look for engines.
struct EnginePlaces {
  /// In order: the first that holds an engine of a version gives it. A native engine goes before a module.
  std::vector<std::filesystem::path> folders;
  /// Engine of this program's own version, for decisions in another process; empty: none.
  std::filesystem::path own;
  /// Runs a module: program and arguments that come before the module's path; empty: nothing here does.
  std::vector<std::string> runtime;
};

/// An engine that is there, whether or not it works.
struct KeptEngine {
  std::uint32_t version = 0;
  std::filesystem::path file;        ///< "calot-engine-12" or "engine-12.wasm"
  bool isModule = false;             ///< WebAssembly
  std::vector<std::string> command;  ///< that starts it; empty: a module that nothing here runs
};

/// For all engines that are opened from here on; at first there are none.
void useEngines(EnginePlaces places);
const EnginePlaces& enginePlaces();

/// Every engine in the folders, by version, in the order in which it would be taken.
std::vector<KeptEngine> listEngines();

/// Command that starts an engine's file. @throws Error (damaged) where there is no such file; (failure) where nothing
/// here runs a module
std::vector<std::string> commandOf(const std::filesystem::path& file);

/// Command that starts the engine of a version; empty if there is no such engine.
std::vector<std::string> commandOfEngine(std::uint32_t version);

/// The places of an installed or built program: CALOT_ENGINES (folders, a colon between two) where it is set, else the
/// user's data folder and `<program>/../lib/calot/engines`; then `engines` of the assets. The runtime is the first node
/// in PATH, with `run-engine.mjs` of the assets.
EnginePlaces userEnginePlaces(const std::filesystem::path& programFolder,
                              const std::vector<std::filesystem::path>& assetRoots);

}  // namespace calot::recorder
